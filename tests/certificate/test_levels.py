"""A level is one entry: what a new one takes, with a level that says next to nothing."""

from dataclasses import dataclass

import numpy as np
import pytest

from neuralgaits.certificate.chart import Axis, Chart
from neuralgaits.certificate.level import Level
from neuralgaits.certificate.levels import levels
from neuralgaits.certificate.levels.level_search import LEVEL_SEARCHES
from neuralgaits.certificate.proof_file import check, consistency, coverage, theorem_tables
from neuralgaits.certificate.proof_file.theorem_tables import Theorems
from neuralgaits.programs import Constant, Input, Operation, Output, Program
from neuralgaits.records.certified import Conclusion
from neuralgaits.records.level_words import WORDS
from support import small_proof

BOX = (0.0, 0.0), (1.0, 1.0)


@dataclass(frozen=True)
class Hovering:
    """Parameters of a level that is not there."""

    height: float
    curve: tuple[float, ...]


class HoveringLevel(Level):
    """A level that says next to nothing."""

    number, part, parameters = 9, "hover", Hovering

    def premises(self, parameters, boxes):
        return iter([("hovering", "hover/up", *BOX)])

    def conclude(self, parameters, boxes, bounds):
        proved = bounds.get(("hover/up", *BOX), -1.0) > parameters[9].height
        return Conclusion(9, "proved" if proved else "undecided", None if proved else "low", (), {})


@pytest.fixture
def taller(monkeypatch):
    """The package with one more level: its entry in the tuple, and nothing else."""
    monkeypatch.setattr(levels, "LEVELS", (*levels.LEVELS, HoveringLevel()))
    monkeypatch.setattr(theorem_tables, "LEVELS", levels.LEVELS)
    by_number = {level.number: level for level in levels.LEVELS}
    for module in (theorem_tables, check, consistency):
        monkeypatch.setattr(module, "LEVELS_BY_NUMBER", by_number)


def test_an_entry_is_all_that_a_proof_file_and_its_check_need(taller):
    del taller
    theorems = Theorems.of(Hovering(1.0, (0.5, 0.25)), claimed=(9,))
    assert Theorems.read(theorems.tables()) == theorems
    assert coverage.premise_names(theorems) == {"hover/up"}
    (high,) = levels.conclude(theorems.parameters, [], {("hover/up", *BOX): 2.0})
    (low,) = levels.conclude(theorems.parameters, [], {("hover/up", *BOX): 0.5})
    assert (high.verdict, low.verdict, low.reason) == ("proved", "undecided", "low")


def test_a_theorem_holds_for_each_fixed_value_of_further_axes(taller, tmp_path):
    """A proof file of the new level, in three axes, through reader and checker."""
    del taller
    chart = Chart((Axis("speed", 0.25, 0.5),))
    about = Program(
        (Input("u", (3,)),),
        (Constant(None, np.array([2.0])), Constant("hover.curve", np.array([0.5, 0.25]))),
        (Operation("inner", (0, 0), 1), Operation("add", (1, 3), 1)),
        (Output("bowl", (), 4), Output("hover/up", (), 4)),
    )
    box = chart.whole(*BOX)
    bowl, up = (small_proof.statement(about, {name: 2.0}, box=box) for name in ("bowl", "hover/up"))
    up |= {"region": "hovering", "scales": {"hover/up": 1.0}}
    theorems = Theorems.of(Hovering(0.5, (0.5, 0.25)), claimed=(9,))
    table = small_proof.with_program(small_proof.proof(), about) | {
        "chart": chart.table(),
        "statements": [bowl, up],
        "theorems": list(theorems.tables()),
    }
    found = small_proof.checked(tmp_path, table)
    assert found.verdict == "consistent", found.reason
    (level,) = found.levels
    assert level.words == (
        "this holds for each fixed speed in [0.25, 0.5]; of one that changes it says nothing",
    )


def test_without_its_entry_it_is_refused():
    tables = [{"level": 9, "claimed": True, "parameters": {"height": (1.0).hex(), "curve": []}}]
    with pytest.raises(ValueError, match="a theorem of level 9"):
        Theorems.read(tables)


def test_every_level_is_sought_read_and_told_of():
    numbers = [level.number for level in levels.LEVELS]
    assert list(LEVEL_SEARCHES) == numbers
    assert list(WORDS) == [1, *numbers]


def test_numbers_rise_and_what_a_level_rests_on_stands_before_it():
    numbers = [level.number for level in levels.LEVELS]
    assert numbers == sorted(set(numbers))
    for level in levels.LEVELS:
        assert all(below in numbers and below < level.number for below in level.rests_on)
