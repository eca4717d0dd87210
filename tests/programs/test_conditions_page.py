"""The claims of docs/conditions.md; its code runs in tests/docs."""

import re
from pathlib import Path

import jax
import numpy as np
import pytest

from neuralgaits.barriers import functions, quantities, specs
from neuralgaits.errors import SpecError
from neuralgaits.gait import ZeroDynamics
from neuralgaits.gait.gaits import Gait
from neuralgaits.programs import ops
from neuralgaits.programs.tracing.tracer import trace
from neuralgaits.robots import load_robot

PAGE = (Path(__file__).parents[2] / "docs" / "conditions.md").read_text(encoding="utf-8")

QUANTITIES = {
    "at_least": functions.at_least(functions.hip_height, 0.7),
    "at_most": functions.at_most(functions.joint_angles, np.ones(4)),
    "friction_forward": functions.friction_forward(0.6),
    "friction_backward": functions.friction_backward(0.6),
    "foot_on_circle": functions.foot_on_circle((0.05, -0.65), 0.7),
    "parabolic_clearance": functions.parabolic_clearance(0.02, 0.17),
    "orbital_energy": functions.orbital_energy(0.9, tilt=0.32),
    "impulse_cone_forward": functions.impulse_cone_forward(0.5),
    "impulse_cone_backward": functions.impulse_cone_backward(0.5),
    "after_reset": functions.after_reset(functions.torso_angle),
    "torque_reserve": functions.torque_reserve("upper", 0.9),
    "knee_bend": functions.knee_bend((0, 3), (1.0, 1.0), 0.05),
    "foot_above_arc": functions.foot_above_arc(0.02),
} | {
    name: getattr(functions, name)
    for name in (
        "torso_angle joint_angles joint_rates torques normal_force foot_height foot_forward"
        " foot_vertical_velocity hip_height hip_forward hip_speed forward_rate transversal_inertia"
        " hip_state momentum reset_hip_sum reset_hip output_mismatch rate_mismatch state_mismatch"
        " impulse normal_impulse old_foot_lift squared_mismatch"
    ).split()
}


@pytest.fixture(scope="module")
def robot():
    """The default robot."""
    return load_robot("amber3m")


@pytest.fixture(scope="module")
def gait(robot):
    """An untrained gait of the default spec."""
    return specs.walking(robot).new_gait(jax.random.key(0), "posture", None)


def test_every_quantity_can_be_traced(agree, robot, gait):
    """All together: compiling is most of the time."""
    zd = ZeroDynamics(robot, gait.policy)

    def values(u):
        point = zd.point(gait.z(u))
        return {name: function(point) for name, function in QUANTITIES.items()}

    agree(values, u=(2,), low=0.0)


def test_no_quantity_is_forgotten():
    """A new function belongs into the table above."""
    public = {
        name
        for name, value in vars(functions).items()
        if callable(value)
        and not name.startswith("_")
        and getattr(value, "__module__", "") in (functions.__name__, quantities.__name__)
    }
    assert public == set(QUANTITIES)


@pytest.mark.parametrize("name", ["paper", "authors"])
def test_specs_with_relu_are_not_provable(robot, name):
    """They say so, and where."""
    spec = specs.load(name, robot)
    gait = spec.new_gait(jax.random.key(0), "random", (8, 8))
    assert isinstance(gait, Gait)
    zd = ZeroDynamics(robot, gait.policy)
    with pytest.raises(SpecError, match=r"activations\.py.*cannot be proved"):
        trace(lambda u: spec.margins(gait, zd, u), {"u": (2,)})


def test_the_list_of_operations():
    """The page names the seventeen."""
    for kind in ops.KINDS:
        assert re.search(rf"\b{kind}\b", PAGE)
