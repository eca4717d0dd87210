"""Errors of the outputs' acceleration under control laws whose torques are held between ticks.

A law u(z, eta) gives ddy = -w^2 y - 2 w dy + e_L(z, eta). A torque that is off by M e, M being the
inertia that the outputs feel, gives e more. While it is held, e grows, and at an impact it jumps.
Source: docs/level5_proof.md.
"""

from collections.abc import Callable
from typing import NamedTuple, Protocol, runtime_checkable

import jax
import jax.numpy as jnp

from neuralgaits._types import Actuated, Array, Float, ZeroState
from neuralgaits.gait.full_order import FullPoint, held_jerk
from neuralgaits.gait.gaits import Gait
from neuralgaits.gait.scheduled_gains import ScheduledGains
from neuralgaits.gait.zero_coordinates import position_of
from neuralgaits.robots.linear import solve

Chart = Float[Array, "2"]
"""Phase and level."""


@runtime_checkable
class OutputLaw(Protocol):
    """A control law of the outputs. Points are those of exact linearisation."""

    def error(self, point: FullPoint, u: Chart) -> Actuated:
        """Return e_L, what ddy is off by under the law's own torque [rad/s^2]. [m]."""
        ...

    def growth(self, point: FullPoint, u: Chart, e: Actuated) -> Actuated:
        """Return de/dt while a torque that is off by M e is held [rad/s^3]. [m]."""
        ...

    def after_impact(self, point: FullPoint, u: Chart, e: Actuated) -> Actuated:
        """Return e right after an impact under the torque from before it, off by M e. [m]."""
        ...


class ExactLinearisation:
    """The torque of exact input-output linearisation: `control.fblin`."""

    def error(self, point: FullPoint, u: Chart) -> Actuated:
        """Return zeros: exact torques make no error of their own."""
        del u
        return jnp.zeros_like(point.output)

    def growth(self, point: FullPoint, u: Chart, e: Actuated) -> Actuated:
        """Differentiate e = ddy + w^2 y + 2 w dy."""
        del u
        moved = _with_accelerations(point, point.output_acceleration + e)
        w, ddy = point.bandwidth, moved.output_acceleration
        return held_jerk(moved) + (w * w) * point.output_rate + (2.0 * w) * ddy

    def after_impact(self, point: FullPoint, u: Chart, e: Actuated) -> Actuated:
        """Compare the torque from before with that of the new step."""
        del u
        after = state_after_impact(point)
        held = _renamed(point, point.torque + inertia(point) @ e)
        return solve(inertia(after), held - after.torque)


class ScheduledLaw(NamedTuple):
    """The torque u0 - M' (w^2 y + 2 w dy), u0 and M' of phase and level: `control.scheduled_pd`.

    Attributes:
        gains: u0 and M' as polynomials.
        gait: policy and tube, which define phase and level.
    """

    gains: ScheduledGains
    gait: Gait

    def torque(self, point: FullPoint, u: Chart) -> Actuated:
        """Return the law's torque at a point whose phase and level are u [N m]. [m]."""
        return self.gains.torque_at(u) - self.gains.inertia_at(u) @ _pull(point)

    def error(self, point: FullPoint, u: Chart) -> Actuated:
        """Compare its torque with that of exact linearisation.

        M (w^2 y + 2 w dy) is in both, so only M - M' is multiplied by it: bounds know that then.
        """
        mass = inertia(point)
        exact = _with_accelerations(point, jnp.zeros_like(point.output)).torque
        lack = self.gains.torque_at(u) - exact
        return solve(mass, lack + (mass - self.gains.inertia_at(u)) @ _pull(point))

    def growth(self, point: FullPoint, u: Chart, e: Actuated) -> Actuated:
        """Differentiate M e = (torque that is held) - (law's torque)."""
        z, y, dy, w = point.z, point.output, point.output_rate, point.bandwidth
        ddy = point.output_acceleration + self.error(point, u) + e
        pulled = (w * w) * dy + (2.0 * w) * ddy
        chart_rate = jax.jvp(self.chart, (z,), (point.dz,))[1]
        torque = jax.jvp(self.gains.torque_at, (u,), (chart_rate,))[1]
        schedule = jax.jvp(self.gains.inertia_at, (u,), (chart_rate,))[1]

        def inertial_torque(z: ZeroState, y: Actuated) -> Actuated:
            eta = jnp.concatenate([y, dy])
            return inertia(FullPoint(point.robot, point.policy, z, eta, point.bandwidth)) @ e

        mass, inertial_rate = inertia(point), jax.jvp(inertial_torque, (z, y), (point.dz, dy))[1]
        # M' = M - (M - M'): nearly all of it needs no solve.
        correction = (mass - self.gains.inertia_at(u)) @ pulled
        return pulled - solve(mass, torque - schedule @ _pull(point) + inertial_rate + correction)

    def after_impact(self, point: FullPoint, u: Chart, e: Actuated) -> Actuated:
        """Compare the torque from before with the law's in the new step."""
        after = state_after_impact(point)
        held = _renamed(point, self.torque(point, u) + inertia(point) @ e)
        return solve(inertia(after), held - self.torque(after, self.chart(after.z)))

    def chart(self, z: ZeroState) -> Chart:
        """Return phase and level of a state."""
        return jnp.stack([self.gait.phase(position_of(z)), self.gait.level(z)])


def _pull(point: FullPoint) -> Actuated:
    """Return w^2 y + 2 w dy [rad/s^2]. [m]."""
    w = point.bandwidth
    return (w * w) * point.output + (2.0 * w) * point.output_rate


def inertia(point: FullPoint) -> Float[Array, "m m"]:
    """Return M = du/d(ddy), a function of z and y [kg m^2]."""
    ddy = point.output_acceleration
    torque: Callable[[Actuated], Actuated] = lambda ddy: _with_accelerations(point, ddy).torque  # noqa: E731
    rows = jnp.eye(len(ddy), dtype=ddy.dtype)
    return jnp.stack([jax.jvp(torque, (ddy,), (row,))[1] for row in rows], axis=1)


def _with_accelerations(point: FullPoint, ddy: Actuated) -> FullPoint:
    """Return the same state with other accelerations of the outputs."""
    eta = jnp.concatenate([point.output, point.output_rate])
    return FullPoint(point.robot, point.policy, point.z, eta, point.bandwidth, ddy)


def state_after_impact(point: FullPoint) -> FullPoint:
    """Return the state right after an impact, in the new step."""
    policy = point.policy.steady_next
    return FullPoint(point.robot, policy, point.z_after, point.eta_after, point.bandwidth)


def _renamed(point: FullPoint, torque: Actuated) -> Actuated:
    """Return motors' torques in the order of the new step's joints: a permutation of joints."""
    return point.robot.relabel[1:, 1:] @ torque
