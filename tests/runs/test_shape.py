"""Shapes of JSON: what fits is taken, and what does not is named with its place."""

import pytest

from neuralgaits.runs.shape import (
    COUNT,
    FLAG,
    NUMBER,
    TEXT,
    complaint,
    list_of,
    may,
    one_of,
    same_length,
    table_of,
    whole,
)

SHAPE = {
    "name": TEXT,
    "loss": may(NUMBER),
    "hidden": may(list_of(whole(1, 64), 1, 2)),
    "rows": table_of({"fell": FLAG, "verdict": one_of("proved", "refuted")}),
    "seed?": COUNT,
}
WHOLE = {
    "name": "gait",
    "loss": 0.5,
    "hidden": [32, 32],
    "rows": {"why?": {"fell": True, "verdict": "proved"}},
    "another": [],
}


def test_what_its_writer_puts_there_fits() -> None:
    assert complaint(WHOLE, SHAPE) is None
    assert complaint(WHOLE | {"loss": None, "hidden": None, "rows": {}, "seed": 0}, SHAPE) is None


@pytest.mark.parametrize(
    ("changed", "told"),
    [
        ({"name": 3}, "in name: expected text, found '3'"),
        ({"loss": True}, "in loss: expected a number, found 'True'"),
        ({"loss": "0.5"}, "in loss"),
        ({"hidden": [32, 32, 32]}, "in hidden: expected a list of 1 or 2"),
        ({"hidden": [32, 65]}, "in hidden: in entry 2: expected a whole number from 1 to 64"),
        ({"hidden": [32.0]}, "in hidden: in entry 1"),
        ({"rows": [1]}, "in rows: expected an object"),
        ({"rows": {"a": {"fell": 1, "verdict": "proved"}}}, "in rows: in a: in fell"),
        ({"rows": {"a": {"fell": True}}}, "in rows: in a: there is no verdict"),
        ({"rows": {"a": {"fell": True, "verdict": "Proved"}}}, "one of proved, refuted"),
        ({"seed": -1}, "in seed"),
    ],
)
def test_what_does_not_fit_is_named(changed: dict, told: str) -> None:
    found = complaint(WHOLE | changed, SHAPE)
    assert found is not None and told in found


def test_lists_about_the_same_things_are_of_one_length() -> None:
    shape = same_length({"fell": list_of(FLAG), "steps": list_of(COUNT)}, "fell", "steps")
    assert complaint({"fell": [True], "steps": [3]}, shape) is None
    assert complaint({"fell": [True], "steps": []}, shape) == "fell, steps have 1, 0 entries"
    assert complaint({"fell": [True]}, shape) == "there is no steps"


def test_no_object_at_all_does_not_fit() -> None:
    assert complaint([], SHAPE) == "expected an object, found '[]'"
