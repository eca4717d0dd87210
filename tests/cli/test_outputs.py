"""Verbs refuse, before they compute, to write onto what is no regular file."""

import os
import shutil
import stat
from pathlib import Path

import pytest

from neuralgaits.cli.main import main
from neuralgaits.records.certified import PROOF
from support.shipped_run import SHIPPED

REFUSED = {
    "simulate": "simulate run --log FIFO --steps 2",
    "simulate, second log": "simulate run --log log.csv --steps 2 --episodes 2",
    "simulate, summary": "simulate run --steps 2",
    "report": "report run --out FIFO",
    "report, figures": "report run",
    "certify": "certify run",
    "certify, boxes": "certify run",
    "certify, packed proof": "certify run",
    "fit": "fit run none.csv",
    "train": "train amber3m --out FIFO",
    "optimise": "optimise amber3m --speed 0.6 --out FIFO",
    "episodes": "episodes amber3m --plant amber3m --out FIFO",
    "sweep": "sweep amber3m --seeds 0:1 --out FIFO",
    "export": "export run --out FIFO",
    "robots": "robots amber3m --out FIFO",
    "inspect": "inspect amber3m --planarise FIFO",
}
WITHIN = {
    "simulate, second log": "log-1.csv",
    "simulate, summary": "run/simulation/summary.json",
    "report, figures": "run/figures/loss.png",
    "certify": f"run/{PROOF}",
    "certify, boxes": "run/certificate/boxes-3.safetensors",
    "certify, packed proof": f"run/{PROOF}.gz",
    "fit": "run/residual/residual.safetensors",
}


@pytest.mark.parametrize("case", REFUSED)
def test_a_fifo_is_refused_in_a_line_and_stays(
    case: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    if case == "optimise":
        pytest.importorskip("casadi")
    monkeypatch.chdir(tmp_path)
    shutil.copytree(SHIPPED, "run")
    fifo = Path(WITHIN.get(case, "out"))
    fifo.parent.mkdir(parents=True, exist_ok=True)
    fifo.unlink(missing_ok=True)
    os.mkfifo(fifo)
    before = sorted(tmp_path.rglob("*"))
    assert main(REFUSED[case].replace("FIFO", "out").split()) == 2
    err = capfd.readouterr().err.splitlines()
    assert len(err) == 1
    assert "found a f" in err[0].lower() or "is there" in err[0]
    own = str(fifo).startswith("run/")
    assert err[0].endswith(": move it away") is own, "no option of the verb names that file"
    assert stat.S_ISFIFO(fifo.lstat().st_mode)
    # What is looked at before drawing may be kept: the walk, and the data of the figures.
    kept = [path for path in sorted(tmp_path.rglob("*")) if "report" not in str(path)]
    assert [path for path in kept if path.suffix != ".safetensors"] == [
        path for path in before if path.suffix != ".safetensors"
    ]


@pytest.mark.parametrize("there", [True, False])
def test_a_log_goes_where_its_link_leads(
    there: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    shutil.copytree(SHIPPED, "run")
    if there:
        Path("target.csv").write_text("old")
    Path("log.csv").symlink_to("target.csv")
    assert main(["simulate", "run", "--log", "log.csv", "--steps", "1"]) == 0
    assert os.readlink("log.csv") == "target.csv"
    assert Path("target.csv").read_text().startswith("t[s],")


def test_a_log_to_a_stream_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    shutil.copytree(SHIPPED, "run")
    for name in ("/dev/null", "/dev/stdout"):
        if not Path(name).exists():
            continue
        before = Path(name).lstat()
        # A regular file would be made beside it: nothing may be written into /dev.
        monkeypatch.setattr(os, "replace", None)
        assert main(["simulate", "run", "--log", name, "--steps", "1"]) == 2
        assert f" at {name}: name a regular file" in capfd.readouterr().err
        assert Path(name).lstat().st_ino == before.st_ino
