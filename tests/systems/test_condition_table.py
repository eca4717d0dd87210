"""Conditions of a family as data: which proof files are about them, and what these state."""

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import pytest

from neuralgaits.certificate.chart import Axis, Chart
from neuralgaits.systems.condition_table import ConditionTable

LEFT, RIGHT = ((0.0, 0.0), (0.5, 1.0)), ((0.5, 0.0), (1.0, 1.0))
TABLE = ConditionTable(
    Chart(state=(Axis("a", 0.0, 1.0), Axis("b", 0.0, 1.0))),
    {"halves": (LEFT, RIGHT), "left": (LEFT,)},
    {"push": "halves", "pull": "left"},
)


def statement(box, **bounds):
    return SimpleNamespace(low=box[0], high=box[1], conditions=tuple(bounds), bounds=bounds)


def claims(*statements, table=TABLE) -> Any:
    conditions = {n: SimpleNamespace(region=region) for n, region in table.conditions.items()}
    asked = SimpleNamespace(regions=table.regions, conditions=conditions)
    return SimpleNamespace(outline=asked, chart=table.chart, statements=statements)


def test_a_condition_is_stated_on_all_boxes_of_its_region_or_not():
    left, right = statement(LEFT, push=0.2, pull=0.3), statement(RIGHT, push=0.1)
    assert TABLE.stated_bounds(claims(left, right)) == {"push": 0.1, "pull": 0.3}
    assert TABLE.stated_bounds(claims(left)) == {"pull": 0.3}
    # A statement about another box is about no region.
    assert TABLE.stated_bounds(claims(statement(((0.0, 0.0), (0.4, 1.0)), pull=0.3))) == {}


@pytest.mark.parametrize(
    "change",
    [
        {"conditions": {"push": "left", "pull": "left"}},
        {"regions": {"halves": (LEFT,), "left": (LEFT,)}},
        {"chart": Chart(state=(Axis("a", 0.0, 1.0), Axis("c", 0.0, 1.0)))},
    ],
)
def test_a_file_of_another_table_is_not_about_it(change):
    assert TABLE.is_that_of(claims())
    assert not TABLE.is_that_of(claims(table=replace(TABLE, **change)))


def test_the_model_has_every_corner_exactly():
    entries = TABLE.model_entries()
    assert entries["regions"]["left"] == [
        {"low": ["0x0.0p+0", "0x0.0p+0"], "high": ["0x1.0000000000000p-1", "0x1.0000000000000p+0"]}
    ]
    assert entries["conditions"]["push"] == {"kind": "Margin", "region": "halves", "scale": 1.0}
