"""The nominal posture treats knees that bend either way alike."""

import dataclasses

import numpy as np
import pytest

from neuralgaits.gait import walking_posture
from neuralgaits.gait.posture import KNEE_RANGE, KNEE_SLACK
from neuralgaits.robots import load_robot

KNEES = [0, 3]


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
