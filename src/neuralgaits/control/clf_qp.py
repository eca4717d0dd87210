"""Input-output linearisation, and a quadratic program in place of clipping its torques.

Where motors or the floor cannot give the linearising torques, the program finds the nearest
torques that they can, and with which a control Lyapunov function falls. It is the one of the
full-order theorem, docs/full_order.md: V = |xi|^2 with xi = (dy/w, 2 (y + dy/w)), whose square root
falls at 3w/4 or faster under linearised outputs, so rapidly exponentially stabilising with
epsilon = 1/w. Sources: Ames, Galloway, Sreenath, Grizzle (2014), section IV; torque limits and
friction as in Galloway, Sreenath, Ames, Grizzle (2015).
"""

from dataclasses import replace
from typing import NamedTuple

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from typing_extensions import override

from neuralgaits._types import Actuated, Array, Coordinates, Float, Planar, Scalar
from neuralgaits.control.driven_mechanism import DrivenMechanism
from neuralgaits.control.fblin import Fblin
from neuralgaits.control.interior_point import QuadraticProgram, minimise
from neuralgaits.control.law import (
    AbstractLaw,
    CompiledLaw,
    Demand,
    Desired,
    LimitedTorque,
    MeasuredState,
    Outputs,
    errors,
)
from neuralgaits.robots.linear import solve


class ClfQp(AbstractLaw):
    """The torques nearest to those of `Fblin` with which V falls, within limits and friction.

    Minimises, over torques u, delta and sigma,

        |u - u_fblin|^2/2 + price delta^2/2 + contact_price sigma^2/2

    with |u| <= limits, d sqrt V/dt <= -3w/4 sqrt V + delta, normal force >= (least_normal - sigma)
    weights and |tangential| <= friction normal + sigma weights, forces and rates being those of the
    model's pinned foot, which are affine in u. There always is a solution; delta and sigma measure
    the violations that it needs.

    Attributes:
        bandwidth: w, as in `Fblin` [rad/s].
        price: price of a slower decrease [(N m)^2 / (rad/s)^2].
        contact_price: price of forces that no floor gives [(N m)^2 / weight^2].
        least_normal: force on the stance foot [weights].
        hold_ticks: control ticks between two evaluations of the policy.
    """

    bandwidth: float = eqx.field(default=30.0, static=True)
    price: float = eqx.field(default=10.0, static=True)
    contact_price: float = eqx.field(default=1e6, static=True)
    least_normal: float = eqx.field(default=0.1, static=True)
    hold_ticks: int = eqx.field(default=1, static=True)

    @property
    def linearising(self) -> Fblin:
        """The linearising law whose torques the program follows within limits."""
        return Fblin(bandwidth=self.bandwidth, hold_ticks=self.hold_ticks)

    @override
    def at_bandwidth(self, bandwidth: float) -> "ClfQp":
        return replace(self, bandwidth=bandwidth)

    def in_c(self) -> CompiledLaw:
        """Return the law as compiled walks have it, which add the program in place of clipping."""
        return CompiledLaw("", model=True, bandwidth=self.bandwidth, exported=False)

    def desired(self, robot: DrivenMechanism, outputs: Outputs, reading: MeasuredState) -> Desired:
        """Return desired outputs, rates, and the terms of their accelerations, a `Desired`."""
        return self.linearising.desired(robot, outputs, reading)

    def torque(self, robot: DrivenMechanism, reading: MeasuredState, desired: Desired) -> Actuated:
        """Return the linearising torques. [m] (N m)."""
        return self.linearising.torque(robot, reading, desired)

    def apply_limits(self, robot: DrivenMechanism, demand: Demand) -> LimitedTorque:
        """Find the torques within all limits that lose least of the decrease."""
        torque, limit = demand.torque, demand.limit
        m, unit = robot.n - 1, jnp.max(limit)
        solution = minimise(self.program(robot, demand))
        # Error of the forces beyond the friction cone, as a share of the weight.
        outside_cone = 1e-3
        # Excess of d sqrt V/dt over its bound from which a tick counts as relaxed [rad/s].
        slower = 1e-3
        given_up = solution.x[m:] > np.array([slower, outside_cone])
        # A program without a solution in numbers: motors without torque.
        within = jnp.where(solution.converged, unit * solution.x[:m], torque)
        within = jnp.clip(within, -limit, limit)
        tolerance = 1e-6  # Share of a torque limit within which a torque counts as at it.
        at_limit = jnp.any(jnp.abs(within) >= (1.0 - tolerance) * limit)
        return LimitedTorque(within, at_limit, given_up | ~solution.converged)

    def program(self, robot: DrivenMechanism, demand: Demand) -> QuadraticProgram:
        """The program of one state. Torques are in units of the largest limit.

        Returns: `QuadraticProgram` of x = (u/unit, delta, sigma).
        """
        reading, desired, torque, limit = demand
        m, unit = robot.n - 1, jnp.max(limit)
        free = accelerations(robot, reading)
        slope, rest = self._decrease(robot, reading, desired, free)
        still, by_acceleration = ground_force(robot, reading.q, reading.dq)
        across, normal = unit * (by_acceleration @ free.by_torque)
        across0, normal0 = still + by_acceleration @ free.without
        cone, cone0 = robot.friction * normal, robot.friction * normal0
        rows = jnp.stack([unit * slope, -normal, across - cone, -across - cone])
        bound = jnp.stack([rest, normal0 - self.least_normal, cone0 - across0, cone0 + across0])
        given_up = jnp.array([[-1.0, 0.0], *([[0.0, -1.0]] * 3)])
        box = jnp.eye(m, m + 2)
        prices = jnp.array([self.price, self.contact_price]) / unit**2
        return QuadraticProgram(
            weight=jnp.concatenate([jnp.ones(m), prices]),
            cost=jnp.concatenate([-torque / unit, jnp.zeros(2)]),
            rows=jnp.concatenate([box, -box, jnp.concatenate([rows, given_up], axis=1)]),
            bound=jnp.concatenate([limit / unit, limit / unit, bound]),
        )

    def _decrease(
        self,
        robot: DrivenMechanism,
        reading: MeasuredState,
        desired: Desired,
        free: "Accelerations",
    ) -> tuple[Actuated, Scalar]:
        """Return the row of V: slope @ u <= rest means that sqrt V falls fast enough."""
        w = self.bandwidth
        y, dy = errors(reading, desired)
        one, two = dy / w, 2.0 * (y + dy / w)
        size = jnp.sqrt(one @ one + two @ two)
        # sqrt V below which outputs count as zero [rad].
        divisor = jnp.maximum(size, 1e-9)
        lead = (one + 2.0 * two) / (w * divisor)
        gradient = robot.position_rows[0]
        along = desired.slope
        by_torque = free.by_torque[1:] - along[:, None] * (gradient @ free.by_torque)[None, :]
        without = free.without[1:] - along * (gradient @ free.without) - desired.drift
        decay = 0.75  # Rate at which sqrt V falls under linearised outputs, in units of w.
        rest = -decay * w * size - lead @ without - 2.0 * two @ dy / divisor
        return lead @ by_torque, rest


class Accelerations(NamedTuple):
    """Accelerations of the coordinates, affine in the torques."""

    without: Coordinates
    """Without torques [rad/s^2]. [n]"""
    by_torque: Float[Array, "n m"]
    """Change by each torque [rad/s^2 / N m]. [n, m]"""


def accelerations(robot: DrivenMechanism, reading: MeasuredState) -> Accelerations:
    """Accelerations of the robot pinned at its stance foot."""
    mass, bias = robot.mass_matrix(reading.q), robot.bias(reading.q, reading.dq)
    if reading.ankle is not None:
        at_ankle = reading.ankle - robot.damping[0] * reading.dq[0]
        bias = bias + at_ankle * jnp.eye(robot.n)[0]
    columns = jnp.concatenate([-bias[None], jnp.eye(robot.n)[1:]])
    responses = jax.vmap(lambda column: solve(mass, column))(columns)
    return Accelerations(responses[0], responses[1:].T)


def ground_force(
    robot: DrivenMechanism, q: Coordinates, dq: Coordinates
) -> tuple[Planar, Float[Array, "2 n"]]:
    """Force of the floor on the stance foot, affine in the accelerations.

    Returns: without any (weights) [2], and by each (weights s^2/rad) [2, n]; (tangential, normal).
    """
    weight = robot.weight()

    def force(ddq: Coordinates) -> Planar:
        return robot.ground_reaction_force(q, dq, ddq) / weight

    still, push = jax.linearize(force, jnp.zeros(robot.n))
    return still, jnp.stack([push(unit) for unit in jnp.eye(robot.n)], axis=1)
