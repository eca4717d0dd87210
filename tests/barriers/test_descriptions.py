"""What specs say of themselves is enough to build the same quantities again."""

import json
from dataclasses import dataclass, fields

import jax
import numpy as np
import pytest

from neuralgaits.barriers import Pointwise, specs
from neuralgaits.barriers import functions as f
from neuralgaits.barriers.description import describe_quantity
from neuralgaits.barriers.quantities import AtLeast
from neuralgaits.robots import load_robot
from support.quantities import WITH_SETTINGS


def built_again(data):
    """The quantity that a description speaks of."""
    data = dict(data)
    thing = getattr(f, data.pop("function"))
    if not data:
        return thing
    if "of" in data:
        data["function"] = built_again(data.pop("of"))
    arrays = {k: np.array(v) if k == "bound" else v for k, v in data.items()}
    return thing(**arrays)


def quantities():
    """Every kind of quantity that has numbers, once."""
    extra = {
        "torque_reserve": f.torque_reserve("upper", 0.9),
        "knee_bend": f.knee_bend((0, 3), (1.0, -1.0), 0.05),
        "foot_above_arc": f.foot_above_arc(0.02),
        "squared_mismatch": f.squared_mismatch,
        "nested": f.at_most(f.after_reset(f.at_least(f.hip_height, 0.7)), 0.2),
    }
    return WITH_SETTINGS | extra


def test_descriptions_determine_quantities(amber, gait, zd):
    described = {
        name: json.loads(json.dumps(describe_quantity(q))) for name, q in quantities().items()
    }
    again = {name: built_again(data) for name, data in described.items()}

    def both(u):
        p = zd.point(gait.z(u))
        return [(quantities()[name](p), again[name](p)) for name in again]

    for name, (one, other) in zip(again, jax.jit(both)(np.array([0.4, 0.7])), strict=True):
        np.testing.assert_allclose(one, other, rtol=1e-15, err_msg=name)


@pytest.mark.parametrize("name", specs.BUILT_IN)
def test_built_in_specs_hide_nothing(amber, name):
    """No condition is left to a function's name alone, and no number is left out."""
    spec = specs.load(name, load_robot("amber3m-feet") if "flat" in name else amber)
    described = json.loads(json.dumps(spec.describe()["conditions"]))
    assert "user" not in json.dumps(described)
    for data, condition in zip(described, spec.conditions, strict=True):
        assert data["kind"] == type(condition).__name__
        assert len(data) == len(fields(condition)) + 1
        if "quantity" in data:
            built_again(data["quantity"])


def test_other_numbers_are_another_description(amber):
    """What a closure would have hidden."""
    low, high = (
        specs.walking(amber).with_conditions(
            Pointwise("hip", "tube", 0.1, f.at_least(f.hip_height, b))
        )
        for b in (0.7, 0.8)
    )
    assert low.describe() != high.describe()


def test_users_functions_are_known_by_name_alone(amber):
    """Also where they take the name or the class of a built-in one."""

    def torso_angle(p):
        return p.theta[0]

    @dataclass(frozen=True, eq=False)
    class Mine(AtLeast):
        def __call__(self, p):
            return self.function(p) + 1.0

    @dataclass(frozen=True)
    class Lenient(Pointwise):
        def margins(self, point, gait):
            return 1.0 + super().margins(point, gait)

    assert set(describe_quantity(torso_angle)) == {"user"}
    assert set(describe_quantity(Mine(f.torso_angle, 1.0))) == {"user"}
    assert describe_quantity(f.at_least(torso_angle, 1.0))["of"].keys() == {"user"}
    spec = specs.walking(amber).with_conditions(Lenient("lenient", "tube", 1.0, f.hip_height))
    described = spec.describe()["conditions"][-1]
    assert "kind" not in described and described["user"].endswith("Lenient")
