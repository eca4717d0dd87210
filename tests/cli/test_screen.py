"""Tables show what the result holds."""

import pytest

from neuralgaits.cli import screen
from neuralgaits.cli.usage import condense


def test_a_fall_is_counted(capsys: pytest.CaptureFixture[str]) -> None:
    result = {
        "steps_walked": [50, 7],
        "fell": [False, True],
        "speed_m_s": 0.65432,
        "poincare": {"multiplier": None},
    }
    screen.show_walks(result)
    out = capsys.readouterr().out
    assert "falls: 1 of 2 episodes stayed up, 7 to 50 steps" in out
    assert "0.6543 m/s" in out
    assert "multiplier" not in out  # None: nothing to show.


def test_why_it_fell_and_what_was_changed(capsys: pytest.CaptureFixture[str]) -> None:
    disturb = {"friction": 0.2, "mass_scale": 1.0, "delay_ms": 0.0}
    result = {
        "steps_walked": [1, 2, 50],
        "fell": [True, True, False],
        "fall_reasons": ["hip too low", "hip too low", None],
        "disturb": disturb,
        "poincare": {"multiplier": 0.7},
    }
    screen.show_walks(result)
    lines = [line.split() for line in capsys.readouterr().out.splitlines()]
    assert ["hip", "too", "low", "2"] in lines
    assert ["disturb", "friction=0.2"] in lines
    assert ["Poincaré", "multiplier,", "model", "0.7"] in lines


def test_every_broken_condition_is_listed(capsys: pytest.CaptureFixture[str]) -> None:
    conditions = {
        "torso-upper": {"mean_violation": 0.0, "max_violation": 1.5e-7},
        "step-length": {"mean_violation": 0.0, "max_violation": 0.0},
    }
    screen.show_training({"run": "runs/a", "loss": 0.0, "conditions": conditions})
    out = capsys.readouterr().out
    assert "1 of 2 conditions fail" in out
    assert "torso-upper" in out
    assert "step-length" not in out
    assert "1.5e-07" in out
    assert "neuralgaits simulate runs/a" in out


def test_conditions_that_hold_are_one_line(capsys: pytest.CaptureFixture[str]) -> None:
    conditions = {name: {"mean_violation": 0.0, "max_violation": 0.0} for name in "ab"}
    timed = {"wall_s": 23.2, "compile_s": 18.04}
    screen.show_training({"run": "runs/a", "conditions": conditions} | timed)
    out = capsys.readouterr().out
    assert out.startswith("trained: all 2 conditions hold on fresh samples")
    assert "23 s, 18 s compiling" in out


def test_names_are_not_read_as_markup(capsys: pytest.CaptureFixture[str]) -> None:
    names = [{"name": "[red]robot[/red]", "about": "x"}]
    screen.show_names({"robots": names, "specs": []})
    assert "[red]robot[/red]" in capsys.readouterr().out


def test_a_box_becomes_a_line() -> None:
    box = (
        "╭─ Invalid choice ──────╮\n│ invalid choice 'a'    │\n│ for '--b'.            │\n"
        "│ ───────────────────── │\n│ For full helptext,    │\n│ run x --help          │\n"
        "╰───────────────────────╯\n"
    )
    assert condense(box) == "invalid choice 'a' for '--b'; see x --help"
    assert condense("no box\n") == "no box"
