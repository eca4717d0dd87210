"""Files of a run that are too large to be what they should be are refused by their size."""

import os
import shutil
from collections.abc import Callable
from pathlib import Path

import pytest

from neuralgaits.analysis.run import open_run
from neuralgaits.certificate.run_certificate.verified_summary import read_certificate
from neuralgaits.errors import RunError
from neuralgaits.runs import RunFolder
from neuralgaits.workflows.check_proof import check_proof
from support.shipped_run import SHIPPED


def _metrics(run: Path) -> object:
    return RunFolder.open(run).read_metrics()


def _summary(run: Path) -> object:
    return RunFolder.open(run).summary


def _compared(run: Path) -> object:
    return check_proof(SHIPPED / "certificate" / "proof.json", run=run)


@pytest.fixture
def run(tmp_path: Path) -> Path:
    return shutil.copytree(SHIPPED, tmp_path / "run")


def _grow(file: Path) -> None:
    """Make a file of gigabytes that takes no place on the disk."""
    os.truncate(file, 12 * 2**30)


@pytest.mark.parametrize(
    ("file", "read"),
    [
        ("config.json", open_run),
        ("robot.xml", open_run),
        ("policy.safetensors", open_run),
        ("policy.safetensors", _compared),
        ("summary.json", _summary),
        ("metrics.csv", _metrics),
    ],
)
def test_a_file_of_gigabytes_is_refused(
    run: Path, file: str, read: Callable[[Path], object]
) -> None:
    _grow(run / file)
    with pytest.raises(RunError, match=rf"at most \d+ bytes, found \d+ at \S+{file}: restore it"):
        read(run)


def test_a_summary_of_gigabytes_is_no_certificate(run: Path) -> None:
    _grow(run / "certificate" / "summary.json")
    found = read_certificate(RunFolder.open(run))
    assert found.summary is None
    assert "expected a file of at most" in str(found.reason)


@pytest.mark.parametrize("cell", ["1_0", "\u0661"])
def test_a_number_of_the_table_has_plain_digits(run: Path, cell: str) -> None:
    """Python reads 1_0 as 10."""
    lines = (run / "metrics.csv").read_text().splitlines()
    lines[1] = ",".join([cell, *lines[1].split(",")[1:]])
    (run / "metrics.csv").write_text("\n".join(lines))
    with pytest.raises(RunError, match="line 2 has another content"):
        _metrics(run)
