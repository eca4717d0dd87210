"""Records are what `--json` prints, and nothing else becomes one."""

import json
import subprocess
import sys
from dataclasses import replace

import pytest

from neuralgaits.errors import RunError
from neuralgaits.records.certified import CertificateRecord, Conclusion, ConditionVerdict
from neuralgaits.records.level_words import HIGHEST
from neuralgaits.records.record import build, shape_of
from neuralgaits.records.simulated import ModelOrbit, SimulationSummary
from neuralgaits.records.trained import TrainingSummary, Violations
from neuralgaits.runs import to_json
from neuralgaits.runs.shape import complaint

WALKED = {
    "run": "runs/a",
    "plant": "amber3m",
    "controller": "pd",
    "start": "centre",
    "seed": 0,
    "episodes": 2,
    "disturb": {"slope_deg": 2.0, "friction": None},
    "steps_walked": [3, 50],
    "fell": [True, False],
    "fall_reasons": ["hip too low", None],
    "poincare": {"multiplier": 0.7, "period_s": 0.4, "step_length_m": 0.3},
    "link": {"law": "pd", "mode": "lock-step"},
}


def _verdict(verdict: str, margin: float | None = None) -> ConditionVerdict:
    return ConditionVerdict(verdict, 1.0, 10, margin, None, 0)  # type: ignore[arg-type]


def _certified(conditions: dict, levels: dict[int, str]) -> CertificateRecord:
    found = (Conclusion(level, word, None) for level, word in levels.items())  # type: ignore[arg-type]
    return CertificateRecord(
        verdict="undecided", level=3, conditions=conditions, levels=tuple(found), boxes=9, wall_s=1
    )


def test_what_is_printed_becomes_the_same_record_again() -> None:
    done = SimulationSummary.of(WALKED)
    assert done.steps_walked == (3, 50) and done.stayed == 1
    assert done.poincare is not None and done.poincare.step_length_m == 0.3
    again = SimulationSummary.of(json.loads(to_json(done)))
    assert again == done and to_json(again) == to_json(done)
    assert replace(done, seed=1) != done
    for name, value in WALKED.items():
        assert name == "link" or done[name] == value


def test_a_field_without_a_meaning_is_not_printed() -> None:
    alone = replace(SimulationSummary.of(WALKED), link=None)
    assert "link" in SimulationSummary.of(WALKED) and "link" not in alone
    with pytest.raises(KeyError):
        alone["link"]
    assert "result" not in ModelOrbit(multiplier=0.7, period_s=0.4, step_length_m=0.3)
    assert ModelOrbit(multiplier=None, step_length_m=None, result="left")["result"] == "left"


@pytest.mark.parametrize(
    ("changed", "words"),
    [
        ({"seed": -1}, "in seed: expected a whole number"),
        ({"seed": True}, "in seed: expected a whole number"),
        ({"plant": None}, "in plant: expected text"),
        ({"fell": [True, 0]}, "in fell: in entry 2: expected true or false"),
        ({"fell": [True]}, "have 2, 1, 2 entries"),
        ({"disturb": {"friction": "low"}}, "in disturb: in friction: expected a number"),
        ({"poincare": {"multiplier": 0.7}}, "in poincare: there is no step_length_m"),
        ({"link": {"law": "pd", "mode": 3}}, "in link: in mode: expected text"),
    ],
)
def test_data_of_another_shape_are_refused_in_one_line(tmp_path, changed, words) -> None:
    with pytest.raises(ValueError, match=words):
        SimulationSummary.of(WALKED | changed)
    file = tmp_path / "summary.json"
    file.write_text(json.dumps(WALKED | changed))
    with pytest.raises(RunError, match=f"summary.json is damaged .*{words}"):
        SimulationSummary.read(file)


def test_a_field_that_is_gone_is_named_and_one_more_is_left_aside() -> None:
    less = {name: value for name, value in WALKED.items() if name != "plant"}
    with pytest.raises(ValueError, match="there is no plant"):
        SimulationSummary.of(less)
    assert SimulationSummary.of(WALKED | {"of a later version": 1}) == SimulationSummary.of(WALKED)


def test_a_proof_goes_as_far_as_all_below_it_is_proved() -> None:
    proved = {"knee": _verdict("proved", 0.3), "torso": _verdict("proved", 0.2)}
    assert _certified(proved, {2: "proved", 3: "proved"}).proved_level == 3
    assert _certified(proved, {2: "undecided", 3: "proved"}).proved_level == 1
    assert _certified(proved, {3: "proved"}).proved_level == 1
    assert _certified(proved, {2: "proved"}).verdict_of_all == "proved"
    assert _certified(proved, {2: "proved", 3: "undecided"}).verdict_of_all == "undecided"
    assert _certified(proved, {}).least_margin == 0.2
    left = _certified(proved | {"foot": _verdict("undecided")}, {2: "proved"})
    assert (left.proved_level, left.least_margin) == (0, None)
    assert left.verdict_of_conditions == "undecided"
    assert left.named("undecided") == ["foot"]
    broken = _certified(proved | {"foot": _verdict("refuted")}, {})
    assert (broken.verdict_of_conditions, _certified({}, {}).proved_level) == ("refuted", 0)


def test_a_condition_is_broken_if_some_sample_breaks_it() -> None:
    conditions = {"a": Violations(0.0, 0.0, 0.1, 1.0), "b": Violations(1e-9, 1e-6, -1e-6, 1.0)}
    done = TrainingSummary(steps=1, loss=None, conditions=conditions, wall_s=1.0)
    assert list(done.broken) == ["b"] and done.proved


def test_records_are_read_without_jax() -> None:
    rooms = (
        "training_config trained certified checked simulated fitted episode_records exported "
        "inspected report_walk"
    )
    lines = [f"import neuralgaits.records.{name}" for name in rooms.split()]
    code = "; ".join([*lines, "import sys; assert 'jax' not in sys.modules"])
    subprocess.run([sys.executable, "-c", code], check=True)


def test_a_summary_of_every_level_is_read_again():
    """What `certify` can be asked is what a report can read."""
    for level in range(1, HIGHEST + 1):
        found = _certified(
            {"a": _verdict("proved", 0.1)}, dict.fromkeys(range(2, level + 1), "proved")
        )
        found = replace(found, level=level)
        assert complaint(json.loads(to_json(found)), shape_of(CertificateRecord)) is None
        assert build(CertificateRecord, json.loads(to_json(found))).proved_level == level
