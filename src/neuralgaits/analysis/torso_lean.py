"""How far the torso's centre of mass is ahead of the file's, from the joint angles of a walk.

No torque, force or rate is needed. About the stance foot, z2' = M g x_com, whatever the motors do.
With the torso's centre of mass shifted by s, z2 = z + s w and x_com = x + s c to first order, where
z, x, w and c follow from the file. Multiplied by a function phi that vanishes at both ends of a
window, and integrated by parts, that is

    s = -(int phi' z dt + M g int phi x dt) / (int phi' w dt + M g int phi c dt),

and z dt = row(q) . dq needs no rate. Here phi = t^2 (L - t)^2 over a window of length L.
"""

from functools import partial
from itertools import pairwise

import jax
import jax.numpy as jnp
import numpy as np

from neuralgaits._blocks import in_blocks
from neuralgaits._quick_jit import quick_filter_jit
from neuralgaits._types import Array, Bool, Coordinates, Float, Scalar
from neuralgaits.robots import PlanarBiped
from neuralgaits.robots.dynamics import (
    angular_momentum,
    centre_of_mass,
    centre_of_mass_velocity,
)
from neuralgaits.robots.mjcf.parameters import RobotFamily

SETTLING_S = 0.015
"""Time after a touchdown that a window leaves out: the foot settles [s]."""
_TOGETHER = 256
"""Ticks that are evaluated at once."""


def leans_of(
    robot: PlanarBiped,
    time: Float[np.ndarray, " T"],
    q: Float[np.ndarray, "T n"],
    touchdown: Bool[np.ndarray, " T"],
) -> Float[np.ndarray, " S"] | None:
    """Return the lean that each whole step of a walk shows (m), positive forward.

    Args:
        robot: the model, on point feet and with a torso.
        time: times of the ticks (s).
        q: measured coordinates, standing on the leg of the tick (rad).
        touchdown: ticks at which a step begins.

    Returns: a number for each step between two touchdowns; None for another kind of robot.
    """
    if robot.torso is None or robot.feet is not None:
        return None
    family = RobotFamily.of(robot, ("com",))
    middles, changes = 0.5 * (q[1:] + q[:-1]), np.diff(q, axis=0)
    rates = partial(_with_derivative, family)
    (z, w), (x, c) = in_blocks(rates, _TOGETHER, middles, changes)
    weight = float(robot.mass * robot.gravity)
    at, passed = 0.5 * (time[1:] + time[:-1]), np.diff(time)
    starts = np.flatnonzero(touchdown)
    found = []
    for first, last in pairwise(starts):
        # The tick of the next touchdown has the coordinates of the other leg.
        ticks = np.arange(first, last - 1)
        ticks = ticks[time[ticks] >= time[first] + SETTLING_S]
        begin, end = time[ticks[0]], time[ticks[-1] + 1]
        since, left = at[ticks] - begin, end - at[ticks]
        slope = 2.0 * since * left * (left - since)
        share = weight * (since * left) ** 2 * passed[ticks]
        known = slope @ z[ticks] + share @ x[ticks]
        found.append(-known / (slope @ w[ticks] + share @ c[ticks]))
    return np.array(found)


@quick_filter_jit
def _with_derivative(
    family: RobotFamily, q: Float[Array, "B n"], change: Float[Array, "B n"]
) -> tuple[tuple[Array, Array], tuple[Array, Array]]:
    """Return momentum times time, and centre of mass, each with its derivative by the lean."""
    torso = family.nominal.torso
    assert torso is not None
    across = 2 * family.link[torso] + 1

    def quantities(lean: Array) -> tuple[Array, Array]:
        robot = family.at(jnp.zeros(family.size).at[across].set(-lean))
        momentum = jax.vmap(partial(_momentum_about_contact, robot))(q, change)
        return momentum, jax.vmap(lambda a: centre_of_mass(robot, a)[0])(q)

    (z, x), (w, c) = jax.jvp(quantities, (jnp.zeros(()),), (jnp.ones(()),))
    return (z, w), (x, c)


def _momentum_about_contact(robot: PlanarBiped, q: Coordinates, dq: Coordinates) -> Scalar:
    """Return the angular momentum about the place where the foot's sphere, rolling, touches."""
    radius, rolled = robot.foot_radius, -robot.foot_radius * dq[0]
    ahead = centre_of_mass_velocity(robot, q, dq)[0]
    height = centre_of_mass(robot, q)[1] + radius
    about_centre = angular_momentum(robot, q, dq)
    return about_centre + robot.mass * (radius * ahead + height * rolled)
