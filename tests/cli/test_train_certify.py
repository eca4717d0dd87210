"""The verb train with --certify: exit codes and lines of progress."""

import json
from pathlib import Path

import pytest

from neuralgaits.cli.main import main
from support import small_spec

SMALL = small_spec.__file__

WORDS = ["train", "amber3m", "--spec", f"{SMALL}:small", "--hidden", "4", "--steps", "1"]


@pytest.mark.parametrize(("budget", "code"), [([], 0), (["--budget", "0.001"], 3)])
def test_the_exit_code_says_whether_the_proof_stands(
    budget: list[str],
    code: int,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capfd: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    assert main([*WORDS, "--certify", *budget, "--out", "run"]) == code
    out, err = capfd.readouterr()
    found = json.loads((tmp_path / "run" / "summary.json").read_text())["certificate"]
    assert f"{found['verdict']} at level 1" in out
    assert found["verdict"] == {0: "proved", 3: "undecided"}[code]
    lines = [line for line in err.splitlines() if line.startswith("certificate after")]
    assert len(lines) == found["repairs"] + 1
    assert ("smallest margin" in lines[-1]) == (code == 0)
    assert ("boxes open" in lines[0]) and found["verdict"] in lines[-1]
