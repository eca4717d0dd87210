"""The nominal posture treats knees that bend either way alike."""

import dataclasses
from pathlib import Path

import numpy as np
import pytest

from neuralgaits.gait import walking_posture
from neuralgaits.gait.posture import KNEE_RANGE, KNEE_SLACK, hip_indices
from neuralgaits.robots import load_robot

KNEES = [0, 3]
ZOO = Path(__file__).parents[2] / "examples" / "robots"


@pytest.mark.parametrize("stop", [1.2, 2.0])
def test_bounds_of_knees_are_mirrored_with_their_ranges(stop):
    robot = load_robot("amber3m")
    lower, upper = robot.joint_lower.copy(), robot.joint_upper.copy()
    lower[KNEES], upper[KNEES] = 0.0, stop
    human = dataclasses.replace(robot, joint_lower=lower, joint_upper=upper)
    lower, upper = lower.copy(), upper.copy()
    lower[KNEES], upper[KNEES] = -stop, 0.0
    bird = dataclasses.replace(robot, joint_lower=lower, joint_upper=upper)
    forward, backward = walking_posture(human), walking_posture(bird)
    np.testing.assert_array_equal(forward.lower[KNEES], KNEE_SLACK)
    np.testing.assert_array_equal(forward.upper[KNEES], min(stop, KNEE_RANGE))
    np.testing.assert_array_equal(backward.lower[KNEES], -forward.upper[KNEES])
    np.testing.assert_array_equal(backward.upper[KNEES], -forward.lower[KNEES])
    for name in ("guard_outputs", "guard_slopes", "bend"):
        there, here = getattr(forward, name), getattr(backward, name)
        np.testing.assert_array_equal(here[KNEES], -there[KNEES])


def test_hips_that_turn_back_alone_have_the_torso_lean_back():
    """Gymnasium's Walker2d: its thighs do not swing ahead of the torso."""
    walker = load_robot(ZOO / "walker2d-point-feet.xml")
    posture, hips = walking_posture(walker), list(hip_indices(walker))
    assert np.all(walker.joint_lower[hips] == 0.0)
    assert np.all(posture.guard_outputs[hips] >= 0.1 - 1e-12)
    assert np.all((posture.lower < posture.guard_outputs) & (posture.guard_outputs < posture.upper))
    assert 0.4 < posture.lean < 0.8
    assert walking_posture(load_robot("amber3m")).lean == 0.0
