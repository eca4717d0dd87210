"""Tables show what the result holds."""

import pytest

from neuralgaits.cli import screen
from neuralgaits.cli.progress import TrainingProgress
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
    assert "0.6543" in out
    assert "poincare.multiplier" in out


def test_every_condition_is_listed(capsys: pytest.CaptureFixture[str]) -> None:
    conditions = {"torso_upper": {"mean_violation": 0.0, "max_violation": 1.5e-7}}
    screen.show_training({"run": "runs/a", "loss": 0.0, "conditions": conditions})
    out = capsys.readouterr().out
    assert "torso_upper" in out
    assert "1.5e-07" in out
    assert "runs/a" in out


def test_names_are_not_read_as_markup(capsys: pytest.CaptureFixture[str]) -> None:
    names = [{"name": "[red]robot[/red]", "about": "x"}]
    screen.show_names({"robots": names, "specs": []})
    assert "[red]robot[/red]" in capsys.readouterr().out


def test_progress_without_a_terminal_is_a_few_lines(capsys: pytest.CaptureFixture[str]) -> None:
    with TrainingProgress() as progress:
        for step in range(1, 1001):
            progress(step, 1000, 1.0 / step)
    out, err = capsys.readouterr()
    assert out == ""
    lines = err.splitlines()
    assert 10 <= len(lines) <= 12
    assert lines[-1].startswith("step 1000/1000  loss 0.001  ETA 0 s")


def test_a_box_becomes_a_line() -> None:
    box = (
        "╭─ Invalid choice ──────╮\n│ invalid choice 'a'    │\n│ for '--b'.            │\n"
        "│ ───────────────────── │\n│ For full helptext,    │\n│ run x --help          │\n"
        "╰───────────────────────╯\n"
    )
    assert condense(box) == "invalid choice 'a' for '--b'; see x --help"
    assert condense("no box\n") == "no box"
