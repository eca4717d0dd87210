"""A quantity is added in one place: its formula, with its words and unit."""

from dataclasses import dataclass

import pytest

from neuralgaits.barriers import Pointwise, specs
from neuralgaits.barriers import functions as f
from neuralgaits.barriers.description import describe_condition, describe_quantity
from neuralgaits.barriers.quantity_words import QUANTITIES, quantity
from neuralgaits.gait import Point
from neuralgaits.report.page import phrases
from neuralgaits.robots import load_robot


def power(p: Point):
    return p.torque @ p.dq[1:]


@pytest.fixture
def added():
    """A quantity of the package, as if it stood in `functions`."""

    def made(p: Point):
        return power(p)

    made.__module__, made.__name__ = f.__name__, "motor_power"
    quantity("power of all motors", "W", gist="motors that stay cool")(made)
    yield made
    del QUANTITIES["motor_power"]


def test_a_new_quantity_of_the_package_is_described_and_has_words(added):
    condition = Pointwise("power", "tube", 50.0, f.at_most(added, 90.0))
    described = describe_condition(condition)
    assert described["quantity"]["of"] == {"function": "motor_power"}
    assert phrases.condition(described) == "power of all motors ≤ 90 W"
    assert phrases.scale(described, 50.0) == "50 W"
    assert phrases.gist([described]) == ["motors that stay cool"]


def test_a_users_quantity_has_the_users_words_and_is_never_one_of_the_package():
    @quantity("power of all motors", "W")
    def normal_force(p: Point):
        return power(p)

    @quantity("power of the knees", "W")
    @dataclass(frozen=True)
    class Knees:
        share: float

        def __call__(self, p: Point):
            return self.share * power(p)

    before = QUANTITIES["normal_force"].formula
    assert before is f.normal_force
    described = describe_quantity(f.at_most(normal_force, 90.0))
    assert described["of"].keys() == {"user", "what", "unit"}
    said = phrases.quantity(described)
    assert said.startswith("power of all motors (") and "written by the user) ≤ 90 W" in said
    assert describe_quantity(Knees(0.5))["what"] == "power of the knees"
    # Words that are none, of a damaged or forged run, are not shown.
    for words in ("x" * 81, 3, None, ["a"]):
        shown = phrases.quantity(described | {"of": described["of"] | {"what": words}})
        assert str(words) not in shown.replace("normal_force", "")


def test_words_do_not_change_what_a_spec_is():
    """The mark leaves formula and description of the package's own as they are."""
    conditions = specs.load("walking", load_robot("amber3m")).describe()["conditions"]
    named = {row["quantity"]["function"] for row in conditions if "quantity" in row}
    assert named <= set(QUANTITIES) | {"at_least", "at_most"}
    assert all("what" not in str(row) for row in conditions)
    assert f.knee_bend.__name__ == "KneeBend" and "knee_bend" in QUANTITIES
