"""A level is one entry: what a new one takes, with a level that says next to nothing."""

from dataclasses import dataclass

import pytest

from neuralgaits.certificate.levels import ladder
from neuralgaits.certificate.levels.level import Level
from neuralgaits.certificate.proof_file import coverage, theorem_tables
from neuralgaits.certificate.proof_file.theorem_tables import Theorems
from neuralgaits.records.certified import Conclusion

BOX = (0.0, 0.0), (1.0, 1.0)


@dataclass(frozen=True)
class Hovering:
    """Parameters of a level that is not there."""

    height: float
    curve: tuple[float, ...]


def _conclude(known, boxes, bounds):
    del boxes
    proved = bounds.get(("hover/up", *BOX), -1.0) > known[5].height
    return Conclusion(5, "proved" if proved else "undecided", None if proved else "low", (), {})


DUMMY = Level(
    5,
    "hover",
    Hovering,
    lambda part: {"curve": part.curve},
    lambda known, boxes: iter([("hovering", "hover/up", *BOX)]),
    _conclude,
)


@pytest.fixture
def taller(monkeypatch):
    """The package with a fifth level: its entry in the tuple, and nothing else."""
    monkeypatch.setattr(ladder, "LEVELS", (*ladder.LEVELS, DUMMY))
    monkeypatch.setattr(theorem_tables, "LEVELS", ladder.LEVELS)
    by_number = {level.number: level for level in ladder.LEVELS}
    monkeypatch.setattr(theorem_tables, "BY_NUMBER", by_number)


def test_an_entry_is_all_that_a_proof_file_and_its_check_need(taller):
    del taller
    theorems = Theorems.of(Hovering(1.0, (0.5, 0.25)), claimed=(5,))
    assert Theorems.read(theorems.tables()) == theorems
    assert coverage.premise_names(theorems) == {"hover/up"}
    (high,) = ladder.conclude(theorems.parameters, [], {("hover/up", *BOX): 2.0})
    (low,) = ladder.conclude(theorems.parameters, [], {("hover/up", *BOX): 0.5})
    assert (high.verdict, low.verdict, low.reason) == ("proved", "undecided", "low")


def test_without_its_entry_it_is_refused():
    tables = [{"level": 5, "claimed": True, "parameters": {"height": (1.0).hex(), "curve": []}}]
    with pytest.raises(ValueError, match="a theorem of level 5"):
        Theorems.read(tables)


def test_numbers_rise_and_what_a_level_rests_on_stands_before_it():
    numbers = [level.number for level in ladder.LEVELS]
    assert numbers == sorted(set(numbers))
    for level in ladder.LEVELS:
        assert all(below in numbers and below < level.number for below in level.rests_on)
