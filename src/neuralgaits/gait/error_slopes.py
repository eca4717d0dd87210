"""Effect of errors of the measured state on torques of exact linearisation, to first order.

Let F(x, u) = ddy + w^2 y + 2 w dy in the state x = (q, dq) under the torque u: the error e that u
makes. Its slopes in x at a constant u say how fast e moves with the state that u is computed from.
Source: docs/level5_sensing.md.
"""

from typing import NamedTuple

import jax
import jax.numpy as jnp

from neuralgaits._types import Actuated, Array, Float, ZeroState
from neuralgaits.gait.full_order import FullPoint
from neuralgaits.gait.output_laws import inertia
from neuralgaits.gait.third_order import ThirdOrderPolicy
from neuralgaits.gait.zero_dynamics import ZeroDynamics
from neuralgaits.robots.linear import solve


class StateSlopes(NamedTuple):
    """Slopes of coordinates (z, y, dy) of a full state in x = (q, dq).

    Attributes:
        z: [2, 2n] (m, kg m^2/s per rad, rad/s)
        output: of y. [m, 2n]
        output_rate: of dy. [m, 2n]
    """

    z: Float[Array, "2 two_n"]
    output: Float[Array, "m two_n"]
    output_rate: Float[Array, "m two_n"]


def state_slopes(point: FullPoint) -> StateSlopes:
    """Return the slopes of a state's coordinates in its angles and rates."""
    dynamics = ZeroDynamics(point.robot, ThirdOrderPolicy.of(point.policy, point.z))
    x = jnp.concatenate([point.q, point.dq])
    eta, z = jax.jacfwd(dynamics.phi)(x)
    m = len(point.output)
    return StateSlopes(z, eta[:m], eta[m:])


def error_slopes(point: FullPoint, e: Actuated) -> Float[Array, "m two_n"]:
    """Return dF/dx at a constant torque that is off by M e, M the outputs' inertia. [m, 2n].

    With u = U(z, y, dy, ddy) of the inverse dynamics, M d(ddy) = -dU at a constant ddy. The part
    w^2 y + 2 w dy is added as it is. Units: rad/s^2 per rad and per rad/s.
    """
    policy = ThirdOrderPolicy.of(point.policy, point.z)
    ddy = point.output_acceleration + e

    def torque(z: ZeroState, y: Actuated, dy: Actuated) -> Actuated:
        eta = jnp.concatenate([y, dy])
        return FullPoint(point.robot, policy, z, eta, point.bandwidth, ddy).torque

    state = point.z, point.output, point.output_rate
    slopes, by = state_slopes(point), jax.jacfwd(torque, argnums=(0, 1, 2))(*state)
    needed = sum(own @ moved for own, moved in zip(by, slopes, strict=True))
    mass = inertia(point)
    moved = jnp.stack([solve(mass, column) for column in jnp.transpose(needed)], axis=1)
    w = point.bandwidth
    return (w * w) * slopes.output + (2.0 * w) * slopes.output_rate - moved
