"""What the default spec asks of robots that are not like AMBER-3M."""

from pathlib import Path

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from neuralgaits.barriers import specs
from neuralgaits.barriers.conditions import Barrier
from neuralgaits.gait import HybridInvariantPolicy, ZeroDynamics, walking_posture
from neuralgaits.robots import load_robot

ZOO = Path(__file__).parents[2] / "examples" / "robots"


def conditions(robot):
    return {condition.name: condition for condition in specs.walking(robot).conditions}


def test_the_torso_may_lean_as_far_as_hips_that_turn_one_way_need():
    robot = load_robot(ZOO / "walker2d-point-feet.xml")
    lean, asked = walking_posture(robot).lean, conditions(robot)
    lower, upper = asked["torso-lower"], asked["torso-upper"]
    assert isinstance(lower, Barrier) and isinstance(upper, Barrier)
    policy = HybridInvariantPolicy.init(robot, key=jax.random.key(0))
    point = ZeroDynamics(robot, policy).point(jnp.array([0.0, 20.0]))
    angle = float(point.theta[robot.torso])
    assert lean > 0.4
    assert float(lower.function(point)) == pytest.approx(angle - (lean - 0.25))
    assert float(upper.function(point)) == pytest.approx(lean + 0.08 - angle)


@pytest.mark.parametrize(
    ("name", "share"),
    [("amber3m", 1.0), ("rabbit", 1.0), ("amber3m-paper", 2.5), ("walker2d", 2.5)],
)
def test_joints_without_heavy_rotors_may_be_faster(name, share):
    """By the square root of size in place of AMBER-3M's 4 rad/s."""
    file = ZOO / f"{name}-point-feet.xml"
    robot = load_robot(file if file.is_file() else name)
    pace = np.sqrt(0.8731 / robot.leg_length * float(robot.gravity) / 9.81)
    assert conditions(robot)["rate-upper"].scale == pytest.approx(share * 4.0 * pace, rel=1e-4)
