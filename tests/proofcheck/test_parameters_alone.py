"""A theorem with another parameter than was proved: no conclusion of it is drawn, up or down."""

import copy
import json
from collections.abc import Iterator
from typing import Any

import pytest

from support.shipped_run import SHIPPED

PROOF = json.loads((SHIPPED / "certificate" / "proof.json").read_text())
FACTORS = (0.0, 0.9, 1.1, 1.4)


def _numbers(part: Any, place: tuple = ()) -> Iterator[tuple]:
    for key, value in part.items() if isinstance(part, dict) else enumerate(part):
        if isinstance(value, dict | list):
            yield from _numbers(value, (*place, key))
        elif "0x" in str(value):
            yield (*place, key)


PLACES = [
    (number, *place)
    for number, theorem in enumerate(PROOF["theorems"])
    for place in _numbers(theorem["parameters"])
]


@pytest.mark.parametrize("place", PLACES, ids=lambda place: "-".join(map(str, place)))
def test_no_other_parameter_is_taken(asked, place):
    for factor in FACTORS:
        table = copy.deepcopy(PROOF)
        number, *steps, last = place
        part = table["theorems"][number]["parameters"]
        for step in steps:
            part = part[step]
        value = float.fromhex(part[last])
        part[last] = (value * factor if value else 0.01 + factor).hex()
        if value or factor:
            answer = asked(table)
            assert answer.returncode == 1, (factor, answer.stdout[-300:])
