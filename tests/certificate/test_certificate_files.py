"""A certificate that cannot be written, or whose command is killed, leaves the old one or none."""

import json
import os
import shutil
from pathlib import Path

import pytest

from neuralgaits.certificate.run_certificate.certificate_files import hashes_with, write_certificate
from neuralgaits.certificate.run_certificate.verified_summary import read_certificate
from neuralgaits.records.certified import PROOF, SUMMARY
from neuralgaits.runs import RunFolder
from neuralgaits.runs.names import MAP, MAP_FIGURE
from support.shipped_run import SHIPPED

NAMES = (PROOF, MAP, MAP_FIGURE, SUMMARY)


@pytest.fixture
def run(tmp_path: Path) -> Path:
    shutil.copytree(SHIPPED, tmp_path / "run")
    (tmp_path / "run" / MAP_FIGURE).write_bytes(b"old picture")
    return tmp_path / "run"


def _contents(run: Path) -> dict[str, bytes]:
    return {name: (run / name).read_bytes() for name in NAMES}


def _new(run: Path) -> tuple[dict[str, bytes], bytes]:
    """A certificate that says the same in other bytes."""
    files = {PROOF: (run / PROOF).read_bytes() + b" ", MAP: b"new map", MAP_FIGURE: b"new"}
    summary = json.loads((run / SUMMARY).read_bytes())
    summary["sha256"] = hashes_with(run, files)
    return files, json.dumps(summary).encode()


def _written(run: Path) -> None:
    write_certificate(run, *_new(run))


def test_the_new_one_is_read(run: Path) -> None:
    old = _contents(run)
    _written(run)
    found = read_certificate(RunFolder.open(run))
    assert found.summary is not None and found.map_fits
    assert all(old[name] != content for name, content in _contents(run).items())


@pytest.mark.parametrize("moment", range(len(NAMES)))
def test_a_full_disk_leaves_the_old_one(
    run: Path, monkeypatch: pytest.MonkeyPatch, moment: int
) -> None:
    old, synced = _contents(run), []

    def full_disk(handle: int) -> None:
        synced.append(handle)
        if len(synced) == moment + 1:
            raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "fsync", full_disk)
    with pytest.raises(OSError, match="No space"):
        _written(run)
    assert _contents(run) == old
    assert read_certificate(RunFolder.open(run)).summary is not None
    assert not [name for name in os.listdir(run / "certificate") if name.endswith(".tmp")]


@pytest.mark.parametrize("moment", range(len(NAMES) + 1))
def test_a_kill_leaves_the_old_one_the_new_one_or_none(
    run: Path, monkeypatch: pytest.MonkeyPatch, moment: int
) -> None:
    moved, replace = [], os.replace

    def killed(source: Path, target: Path) -> None:
        if len(moved) == moment:
            raise KeyboardInterrupt
        moved.append(target)
        replace(source, target)

    monkeypatch.setattr(os, "replace", killed)
    ended = False
    try:
        _written(run)
        ended = True
    except KeyboardInterrupt:
        pass
    found = read_certificate(RunFolder.open(run))
    assert (found.summary is not None) == (moment == 0 or ended)
    assert found.summary is not None or "certificate/proof.json is damaged" in str(found.reason)


def test_what_an_older_one_had_goes(run: Path) -> None:
    (run / f"{PROOF}.gz").write_bytes(b"older still")
    summary = json.loads((run / SUMMARY).read_bytes())
    summary["sha256"] = hashes_with(run, {})
    write_certificate(run, {}, json.dumps(summary).encode())
    assert os.listdir(run / "certificate") == ["summary.json"]
