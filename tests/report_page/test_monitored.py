"""What a page says about the monitor: only of the proof that the run has."""

from types import SimpleNamespace
from typing import Any

import pytest

from neuralgaits.records.monitored import LevelOccupancy, MonitorFigures, TickOutside
from neuralgaits.report.page.monitor_table import monitored, share

PROOF = "a" * 64
WALKING = LevelOccupancy(0.9996, -0.25, "level-lower", TickOutside(2, 24.983, "phase-end", -0.01))
FULL = LevelOccupancy(1.0, 0.031, "knee-clears")
SEEN = MonitorFigures(1000, {"2": WALKING, "4": FULL, "5": FULL}, 0.75, 1.0, PROOF)


def page(seen: MonitorFigures | None, *, level: int = 3, proof: str = PROOF) -> str:
    saved: Any = SimpleNamespace(
        confirmed_level=level, hashes={"certificate/proof.json": proof}, name="runs/one"
    )
    done: Any = SimpleNamespace(monitor=seen)
    return str(monitored(saved, done))


def test_each_set_has_a_row_with_what_was_outside_last():
    said = page(SEEN)
    for cell in (
        *("<td>level 2</td>", "99.9 %", "−0.25, slow edge"),
        *("walk 2, 24.983 s: −0.01, end of the step",),
        *("<td>levels 4 and 5</td>", "100.0 %", "0.031, knee clears", "<td>none</td>"),
    ):
        assert cell in said, cell
    assert "At 75.0 % of the ticks the commands were those of the proof." in said
    assert "100.0 % of the ticks came within the hold that level 5 allows." in said
    assert "safe" not in said


@pytest.mark.parametrize("level", [0, 1])
def test_without_a_proved_set_there_is_nothing(level):
    assert page(SEEN, level=level) == page(None, level=level) == ""


def test_figures_of_another_proof_are_not_shown():
    for said in (page(SEEN, proof="b" * 64), page(None)):
        assert "99.9" not in said and "simulate runs/one --monitor" in said
    assert "those of another proof" in page(SEEN, proof="b" * 64)


@pytest.mark.parametrize(("value", "words"), [(1.0, "100.0"), (0.99999, "99.9"), (0.0, "0.0")])
def test_a_share_is_rounded_down(value, words):
    assert share(value) == words
