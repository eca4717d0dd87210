"""Robots whose torso's centre of mass is further ahead than the file says: the torso leans.

The lean is one number that a controller may be told and that can be traced. The closed form's
constants are quadratics of it, so such a robot is the file's with three arrays a constant.
"""

from functools import lru_cache
from typing import NamedTuple

import equinox as eqx
import jax.numpy as jnp
import numpy as np

from neuralgaits._types import Array, Float, Scalar
from neuralgaits.errors import InputError
from neuralgaits.robots.biped import PlanarBiped
from neuralgaits.robots.mjcf.loader import robot_from_text
from neuralgaits.robots.mjcf.parameters import Robot, RobotFamily


class LeanSeries(NamedTuple):
    """Constants of a robot's closed form by powers of the lean (1, m, m^2)."""

    coupling: Float[np.ndarray, "3 n n"]
    """Re C [kg m^2]."""
    coupling_across: Float[np.ndarray, "3 n n"]
    """Im C [kg m^2]."""
    mass_moment: Float[np.ndarray, "3 n"]
    """Re b [kg m]."""
    moment_across: Float[np.ndarray, "3 n"]
    """Im b [kg m]."""


def leaning_robot(robot: Robot, lean: Scalar | float | None) -> Robot:
    """Return the robot with its torso's centre of mass moved across the torso.

    Args:
        robot: planar biped of a file, whose torso has the masses of the file.
        lean: how far ahead of the file's the centre of mass is when the torso is upright (m);
            None for the robot as it is.

    Raises: InputError if the robot has no torso.
    """
    if lean is None:
        return robot
    if not isinstance(robot, PlanarBiped) or robot.torso is None:
        raise InputError(f"expected a robot with a torso to lean, found {robot.name}")
    dtype = jnp.result_type(robot.mass)
    lean = jnp.asarray(lean, dtype)
    series = lean_series(robot.layout.xml, robot.name)

    def at(powers: Float[np.ndarray, "3 ..."]) -> Array:
        plain, first, second = powers.astype(dtype)
        return plain + lean * (first + lean * second)

    re_c, im_c, re_b, im_b = map(at, series)
    return eqx.tree_at(
        lambda r: (
            *(r.coupling, r.coupling_across, r.coupling_phase),
            *(r.mass_moment, r.moment_across, r.mass_moment_phase),
        ),
        robot,
        (re_c, im_c, None, re_b, im_b, None),
        is_leaf=lambda leaf: leaf is None,
    )


@lru_cache(maxsize=16)
def lean_series(xml: str, name: str) -> LeanSeries:
    """Return how the constants of a robot file with a torso depend on the lean."""
    robot = robot_from_text(xml, name)
    assert robot.torso is not None
    family = RobotFamily.of(robot, ("com",))
    count, torso = len(family.masses), family.link[robot.torso]
    parts = np.zeros((3, 4, count))
    parts[0, 0] = family.masses
    # Across is counter-clockwise from the up-angle, which is to the back.
    parts[1, 2, torso] = -family.masses[torso]
    parts[2, 3, torso] = family.masses[torso]
    features = parts.reshape(3, -1)
    return LeanSeries(
        *(np.moveaxis(np.asarray(table) @ features.T, -1, 0) for table in family.tables)
    )
