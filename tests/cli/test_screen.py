"""Tables show what the result holds."""

import json
import re
import shutil
from pathlib import Path

import pytest

from neuralgaits.cli import brief, robot_screen, screen, sweep_verb
from neuralgaits.cli.usage import condense
from neuralgaits.records.installed import BuiltIn, CatalogueEntry
from neuralgaits.records.reported import ReportRecord
from neuralgaits.records.simulated import SimulationSummary
from neuralgaits.records.swept import SweepSummary
from neuralgaits.records.trained import TrainingSummary, Violations
from neuralgaits.records.training_config import Range
from support.shipped_run import SHIPPED

ASKED = {"plant": "amber3m", "controller": "pd", "start": "centre", "seed": 0, "episodes": 2}
HOLDS = Violations(mean_violation=0.0, max_violation=0.0, min_margin=0.5, scale=2.0)


def test_a_fall_is_counted(capsys: pytest.CaptureFixture[str]) -> None:
    result = ASKED | {
        "steps_walked": [50, 7],
        "fell": [False, True],
        "fall_reasons": [None, "hip too low"],
        "speed_m_s": 0.65432,
        "poincare": {"multiplier": None, "step_length_m": None},
    }
    brief.brief_walks(SimulationSummary.of(result))
    screen.show_walks(SimulationSummary.of(result))
    out = capsys.readouterr().out
    assert "falls: 1 of 2 episodes stayed up, 7 to 50 steps" in out
    assert "0.6543 m/s" in out
    assert "multiplier" not in out  # None: nothing to show.


@pytest.mark.parametrize(("share", "told"), [(0.723, "72 % of ticks"), (0.003, None)])
def test_torque_that_is_short_is_said(capsys: pytest.CaptureFixture[str], share, told) -> None:
    result = ASKED | {"steps_walked": [50], "fell": [False], "fall_reasons": [None]}
    result |= {"saturated_fraction": share, "poincare": None}
    screen.show_walks(SimulationSummary.of(result))
    out = capsys.readouterr().out
    assert (told or "") in out
    assert ("no torque in" in out) is (told is not None)


def test_what_a_quadratic_program_gave_up_is_said(capsys: pytest.CaptureFixture[str]) -> None:
    result = ASKED | {"steps_walked": [50], "fell": [False], "fall_reasons": [None]}
    result |= {"poincare": None, "relaxed": {"decrease": 0.0123, "contact": 0.5}}
    shown = SimulationSummary.of(result)
    assert shown.relaxed is not None and shown.relaxed.contact == 0.5
    screen.show_walks(shown)
    out = " ".join(capsys.readouterr().out.split())
    assert "slower than commanded at 1.23 % of ticks" in out and "does not give at 50.00 %" in out


def test_why_it_fell_and_what_was_changed(capsys: pytest.CaptureFixture[str]) -> None:
    disturb = {"friction": 0.2, "mass_scale": 1.0, "delay_ms": 0.0}
    result = ASKED | {
        "steps_walked": [1, 2, 50],
        "fell": [True, True, False],
        "fall_reasons": ["hip too low", "hip too low", None],
        "disturb": disturb,
        "poincare": {"multiplier": 0.7, "step_length_m": None},
    }
    screen.show_walks(SimulationSummary.of(result))
    lines = [line.split() for line in capsys.readouterr().out.splitlines()]
    assert ["hip", "too", "low", "2"] in lines
    assert ["disturb", "friction=0.2"] in lines
    assert ["Poincaré", "multiplier,", "model", "0.7"] in lines


def test_what_a_walk_met_is_on_its_first_line(capsys: pytest.CaptureFixture[str]) -> None:
    met = {"push": 10.0, "disturb": {"mass_scale": 1.2, "friction": None}, "plant": "rabbit"}
    walks = {"fell": [False], "steps_walked": [50], "controller": "pd", "plant_given": "rabbit"}
    walks |= {"episodes": 1, "start": "centre", "seed": 0, "fall_reasons": [None]}
    brief.brief_walks(SimulationSummary.of(walks | met))
    (first, *_) = " ".join(capsys.readouterr().out.split()).split("speed")
    assert "under pd in MuJoCo, plant rabbit, push 10 N s, mass_scale=1.2" in first


@pytest.mark.parametrize(
    ("settings", "said"),
    [
        ({"command": {"speed": 0.8}}, "under pd in MuJoCo, speed=0.8"),
        ({"command": {"slope": 0.05}}, "under pd in MuJoCo, slope=2.86"),
        ({"commands": "walk.csv"}, "under pd in MuJoCo, commands walk.csv"),
        ({}, "under pd in MuJoCo"),
    ],
)
def test_the_first_line_says_what_was_commanded(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, settings, said
) -> None:
    monkeypatch.setenv("COLUMNS", "400")
    walks = ASKED | {"steps_walked": [50], "fell": [False], "fall_reasons": [None]}
    brief.brief_walks(SimulationSummary.of(walks | {"episodes": 1} | settings))
    first, *_ = capsys.readouterr().out.splitlines()
    assert said in first and (settings or first.endswith(said))


def test_a_missed_command_has_a_unit_and_says_of_what(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("COLUMNS", "400")
    errors = {
        "speed": {"mean": 0.01682, "worst": 0.02},
        "step_height": {"mean": 0.003, "worst": 0.004},
    }
    walks = ASKED | {"steps_walked": [50], "fell": [False], "fall_reasons": [None]}
    walks |= {"episodes": 1, "speed_m_s": 0.78318, "command_error": errors}
    brief.brief_walks(SimulationSummary.of(walks | {"command": {"speed": 0.8}}))
    told = capsys.readouterr().out
    assert "numbers  speed 0.7832 m/s where 0.8 was commanded, step_height off" in told
    assert "step_height off its command by 0.003 m on average" in told
    brief.brief_walks(SimulationSummary.of(walks | {"commands": "random"}))
    told = capsys.readouterr().out
    assert "speed 0.7832 m/s, speed off its command by 0.01682 m/s on average" in told


@pytest.mark.parametrize(
    ("fell", "said"), [([True], "after the push"), ([True, False], "1 of 2 walks after the push")]
)
def test_falls_after_a_push_are_counted_among_walks(
    capsys: pytest.CaptureFixture[str], fell, said
) -> None:
    steps = [7 if one else 50 for one in fell]
    walks = ASKED | {"steps_walked": steps, "fell": fell, "push": 60.0, "steps": 50}
    walks |= {"fall_reasons": ["torso tipped over" if one else None for one in fell]}
    brief.brief_walks(SimulationSummary.of(walks | {"episodes": len(fell)}))
    out = " ".join(capsys.readouterr().out.split())
    assert f"fell torso tipped over, {said} of 60 N s" in out


@pytest.mark.parametrize(
    ("engine", "workers", "said"), [("processes", 2, "2 processes"), ("ray", 3, "3 (ray)")]
)
def test_a_sweep_counts_its_workers(capsys: pytest.CaptureFixture[str], engine, workers, said):
    table = {"sweep": "a", "rows": 2, "failed": 0, "lost": 0, "before": 0, "table": "a/table.csv"}
    table |= {"page": "a/page.html", "engine": engine, "workers": workers, "wall_s": 3.0}
    sweep_verb.show_sweep(SweepSummary.of(table))
    lines = capsys.readouterr().out.splitlines()
    assert lines[0] == "done: 2 of 2 rows"
    assert lines[1].split(maxsplit=1) == ["workers", said]


@pytest.mark.parametrize(
    ("damaged", "said"),
    [
        ({"a.json": "a.json is damaged: mend it"}, "a.json is damaged: mend it"),
        ({"a.json": "expected a table: mend it"}, "a.json: expected a table: mend it"),
        ({"a.json": "no", "b.json": "no"}, "a.json, b.json; -v prints more"),
    ],
)
def test_the_reason_of_one_damaged_file_is_on_the_short_screen(
    capsys: pytest.CaptureFixture[str], damaged, said
) -> None:
    table = {"run": "runs/a", "report": "a.html", "bytes": 9, "figures": [], "missing": []}
    brief.brief_report(ReportRecord.of(table | {"damaged": damaged}))
    (line,) = [one for one in capsys.readouterr().out.splitlines() if one.startswith("damaged")]
    assert line.split(maxsplit=1)[1] == said


def test_tables_that_follow_each_other_are_apart(capsys: pytest.CaptureFixture[str]) -> None:
    entry = CatalogueEntry(name="a", about="b")
    robot_screen.show_names(BuiltIn(robots=(entry,), specs=(entry,)))
    assert capsys.readouterr().out.splitlines()[2].strip() == ""


def test_every_broken_condition_is_listed(capsys: pytest.CaptureFixture[str]) -> None:
    conditions = {"torso-upper": Violations(0.0, 1.5e-7, -1.5e-7, 2.0), "step-length": HOLDS}
    screen.show_training(
        TrainingSummary(run="runs/a", steps=9, loss=0.0, conditions=conditions, wall_s=1.0)
    )
    out = capsys.readouterr().out
    assert "the gait failed: 1 of 2 conditions does not hold on fresh samples" in out
    assert "torso-upper" in out
    assert "step-length" not in out
    assert "1.5e-07" in out
    assert "neuralgaits simulate" not in out
    assert 'without("torso-upper") in a spec of your own' in out


def test_a_run_that_fails_says_how_to_train_it_again(
    small_run, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("COLUMNS", "400")
    broken = {"torso-upper": Violations(0.0, 1.5e-7, -1.5e-7, 2.0)}
    screen.show_training(
        TrainingSummary(run=str(small_run.path), steps=2, loss=0.0, conditions=broken, wall_s=1.0)
    )
    out = capsys.readouterr().out
    # Not twice the two steps that it had: its spec asks for more.
    recipe = small_run.config.recipe_steps
    # The last lines say in words how it ended, and the command to give next. Each is there once.
    result, following, seed, loosen = out.splitlines()[-4:]
    assert "the gait failed: 1 of 1 condition does not hold" in result
    assert recipe > 4 and re.match(rf"next +neuralgaits train .*--steps {recipe} ", following)
    assert re.match("or a seed +neuralgaits train .*--seed 1$", seed)
    assert loosen.startswith("or loosen ")
    assert len(re.findall("fail(?!s )|not hold", out)) == 2  # Both in one line.
    assert out.count(f"--steps {recipe} ") == 1


def test_of_a_gait_that_was_given_no_spec_is_to_be_loosened(
    tmp_path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """`refine` takes no spec."""
    monkeypatch.setenv("COLUMNS", "400")
    run = Path(shutil.copytree(SHIPPED, tmp_path / "run"))
    config = json.loads((run / "config.json").read_text())
    given = {"by": "optimise", "degree": 5, "speed": 0.7}
    (run / "config.json").write_text(json.dumps(config | {"given": given}))
    broken = {"rate-match": Violations(0.0, 0.08, -0.08, 2.0)}
    screen.show_training(
        TrainingSummary(run=str(run), steps=2, loss=0.0, conditions=broken, wall_s=1.0)
    )
    out = capsys.readouterr().out
    assert "or a network" in out and "neuralgaits train amber3m\n" in out
    assert "or loosen" not in out


def test_conditions_that_hold_are_one_line(capsys: pytest.CaptureFixture[str]) -> None:
    conditions = dict.fromkeys("ab", HOLDS)
    brief.brief_training(
        TrainingSummary(
            run="runs/a", steps=9, loss=0.0, conditions=conditions, wall_s=23.2, compile_s=18.04
        )
    )
    out = capsys.readouterr().out
    assert out.startswith("trained: all 2 conditions hold on fresh samples")
    assert "23 s, 18 s of it compiling" in out


def trained_for_speeds(*orbits: float) -> TrainingSummary:
    """Return the result of a training for 0.6 to 0.8 m/s with these orbits at both ends."""
    return TrainingSummary(
        run="runs/a",
        steps=9,
        loss=0.0,
        conditions={"a": HOLDS},
        wall_s=1.0,
        commands={"speed": Range(0.6, 0.8)},
        orbit_speeds_m_s=(orbits[0], orbits[1]),
    )


def test_a_range_of_speeds_that_is_not_reached_says_what_to_train(
    capsys: pytest.CaptureFixture[str],
) -> None:
    brief.brief_training(trained_for_speeds(0.601, 0.772))
    out = capsys.readouterr().out
    assert "slower  by 0.028 m/s than requested at the upper end: train --speed 0.6:0.856" in out
    brief.brief_training(trained_for_speeds(0.601, 0.795))
    assert "slower" not in capsys.readouterr().out


def test_names_are_not_read_as_markup(capsys: pytest.CaptureFixture[str]) -> None:
    robot_screen.show_names(BuiltIn((CatalogueEntry("[red]robot[/red]", "x"),), ()))
    assert "[red]robot[/red]" in capsys.readouterr().out


def test_a_box_becomes_a_line() -> None:
    box = (
        "╭─ Invalid choice ──────╮\n│ invalid choice 'a'    │\n│ for '--b'.            │\n"
        "│ ───────────────────── │\n│ For full helptext,    │\n│ run x --help          │\n"
        "╰───────────────────────╯\n"
    )
    assert condense(box) == "invalid choice 'a' for '--b'; see x --help"
    assert condense("no box\n") == "no box"
