"""The verb certify: exit codes, one JSON object, a table."""

import json
import shutil

import numpy as np
import pytest

from neuralgaits.certificate.run_certificate import run_proof
from neuralgaits.cli import proof_screen
from neuralgaits.cli.main import main
from neuralgaits.cli.progress import ProofProgress
from neuralgaits.records.certified import (
    HIGHEST,
    CertificateRecord,
    Conclusion,
    ConditionVerdict,
    Counterexample,
)

Captured = pytest.CaptureFixture[str]


@pytest.fixture(scope="module", params=["small", "relu"])
def run(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory):
    """A run of two steps: it breaks conditions, or cannot be proved at all."""
    made = request.getfixturevalue(f"{request.param}_run")
    return request.param, shutil.copytree(made.path, tmp_path_factory.mktemp("run") / "run")


def test_the_exit_code_is_the_verdict(run, capfd: Captured) -> None:
    name, path = run
    code, verdict = {"small": (1, "refuted"), "relu": (3, "undecided")}[name]
    assert main(["certify", str(path), "--json"]) == code
    out, err = capfd.readouterr()
    result = json.loads(out)
    assert result["verdict"] == verdict
    assert json.loads((path / "certificate" / "summary.json").read_text()) == result
    assert err == ""
    assert main(["certify", str(path), "--budget", "3600"]) == code
    out, err = capfd.readouterr()
    assert ("proved" in err) == (name == "small")
    # A condition is refuted, whatever level was asked for.
    level = "level 1, level 3 was requested" if verdict == "refuted" else "level 3"
    assert f"{verdict} at {level}" in out


@pytest.mark.parametrize("run", ["small"], indirect=True)
def test_ctrl_c_is_130_and_says_how_to_go_on(run, capfd: Captured, monkeypatch) -> None:
    _, path = run

    def ctrl_c(*_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(ProofProgress, "__call__", ctrl_c)
    assert main(["certify", str(path)]) == 130
    out, err = capfd.readouterr()
    assert out == ""
    assert "--resume" in err
    summary = json.loads((path / "certificate" / "summary.json").read_text())
    assert "interrupted" in summary["reason"]
    monkeypatch.undo()
    assert main(["certify", str(path), "--resume"]) == 1


@pytest.mark.parametrize("run", ["small"], indirect=True)
def test_ctrl_c_after_the_search_goes_on_from_its_boxes(run, capfd: Captured, monkeypatch) -> None:
    _, path = run

    def ctrl_c(*_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(run_proof, "_conclusions", ctrl_c)
    assert main(["certify", str(path)]) == 130
    last = capfd.readouterr().err.splitlines()[-1]
    assert "--resume" in last and "nothing is kept" not in last
    monkeypatch.undo()
    assert main(["certify", str(path), "--resume"]) == 1


@pytest.mark.parametrize(
    ("words", "found"),
    [
        (["--level", "7"], "level 1"),
        (["--budget", "-1"], "budget"),
        (["--disturbance", "1"], "A,B"),
        (["--disturbance", "1,-2"], ">= 0"),
        (["--state-error", "1mrad"], "0.005mrad,0.25mrad/s"),
        (["--state-error", "1mrad,5"], "mrad/s"),
        (["--state-error", "1mrad,5mrad"], "mrad/s"),
        (["--state-error", "1mrad,5mrad/s"], "level 5"),
        (["--model-error", "mass"], "--model-error: expected NAME=SIZE"),
        (["--model-error", "mas=1%"], "did you mean mass"),
        (["--model-error", "mass=70%", "--level", "5"], "at most 50 %"),
        (["--model-error", "lean=3mm", "--level", "5"], "mass, com or inertia"),
        (["--model-error", "mass=0.2%"], "level 5"),
        (
            ["--model-error", "mass=0.2%", "--level", "5", "--controller", "scheduled-pd"],
            "leave --controller out",
        ),
        (["--within", "speed"], "NAME=LOW:HIGH"),
        (["--within", "speed=0.7:nan"], "NAME=LOW:HIGH"),
        (["--within", "speed=0.7:0.8,speed=0.7:0.9"], "each name once"),
        ([], "run folder"),
    ],
)
def test_bad_input_is_one_line_and_2(words: list[str], found: str, capfd: Captured) -> None:
    assert main(["certify", "no-such-run", *words]) == 2
    out, err = capfd.readouterr()
    assert out == ""
    assert err.count("\n") == 1
    assert found in err


def test_the_help_names_every_level(capfd: Captured) -> None:
    assert main(["certify", "--help"]) == 0
    words = " ".join(capfd.readouterr().out.replace("│", " ").split())
    told = words.partition("--level")[2].partition("--disturbance")[0]
    assert [level for level in range(1, 9) if f"{level}: " in told] == list(range(1, HIGHEST + 1))


def test_almost_proved_does_not_read_as_proved(capsys: Captured) -> None:
    point = Counterexample(u=(0.5, 0.5), z=(0.01, 17.5), margin=-0.25)
    result = CertificateRecord(
        verdict="refuted",
        level=2,
        levels=(Conclusion(2, "undecided", "no strip"),),
        boxes=9,
        wall_s=1.5,
        conditions={
            "open": ConditionVerdict("undecided", 0.99999, 7, None, None, 3),
            "broken": ConditionVerdict("refuted", 0.99999, 7, None, point, 0),
        },
    )
    proof_screen.show_proof(result)
    out = capsys.readouterr().out
    assert "99.99 %" in out
    assert "100 %" not in out
    assert "3 boxes left" in out
    assert "level 2 undecided: no strip" in out
    assert "-0.25 at z = (0.01, 17.5)" in " ".join(out.split())


def test_what_is_proved_in_a_part_is_said_and_stands_last(capsys: Captured) -> None:
    whole = {f"whole{k}": ConditionVerdict("undecided", 1.0, 7, None, None, 0) for k in range(20)}
    almost = ConditionVerdict("undecided", float(np.nextafter(1.0, 0.0)), 7, None, None, 0)
    result = CertificateRecord(
        verdict="undecided",
        level=1,
        levels=(),
        boxes=9,
        wall_s=1.5,
        conditions=whole | {"almost": almost},
    )
    proof_screen.show_proof(result)
    first, *others = [line for line in capsys.readouterr().out.splitlines() if "%" in line]
    assert "almost" in first
    assert "0 boxes left" in first
    assert len(others) == 11
    assert all("proved in this part" in line for line in others)


def test_of_a_part_what_is_left_out_of_the_table_is_called_proved_in_it(capsys: Captured) -> None:
    entry = ConditionVerdict("undecided", 1.0, 7, None, None, 0)
    conditions = {f"whole{k}": entry for k in range(20)}
    result = CertificateRecord(
        verdict="undecided", level=1, levels=(), boxes=9, wall_s=1.5, conditions=conditions
    )
    proof_screen.show_proof(result)
    assert "and 8 more, proved in this part; --json has all" in capsys.readouterr().out
