"""Walks of the rigid model under exact input-output linearisation, in continuous time.

Outputs are known in closed form at every time, eta(t) = exp(A t) eta(0), so only z is integrated;
the phase takes the place of time, so that a batch reaches the guard together. No sampled control,
no compliant contact: this is the system that the full-order theorem speaks of.
"""

from collections.abc import Callable
from typing import NamedTuple

import equinox as eqx
import jax
import jax.numpy as jnp

from neuralgaits._types import Array, Float, Scalar, ZeroState
from neuralgaits.barriers import Gait
from neuralgaits.gait.full_order import FullPoint
from neuralgaits.gait.runge_kutta import RK4, step
from neuralgaits.robots import PlanarBiped

NODES = 80
"""Fourth-order steps from the start of a step to near the guard: z2 is then right to 1e-8."""
LAST_PHASE = 0.97
"""Phase from which the guard is looked for."""
SECANTS = 8
"""Secant steps to the guard: the foot is then within rounding of the ground."""

Observe = Callable[[FullPoint], Float[Array, " k"]]
"""Numbers of which the least along a walk is kept."""


class ExactWalk(NamedTuple):
    """What a walk came to."""

    least: Float[Array, " k"]
    """Least of each observed number along the walk. [k]"""
    z: ZeroState
    """After the last impact (m, kg m^2/s). [2]"""
    eta: Float[Array, " two_m"]
    """After the last impact (rad, rad/s). [2m]"""
    foot: Scalar
    """Largest |foot height| at which an impact was found [m]."""
    duration: Scalar
    """Of the walk [s]."""


class ExactOutputs(eqx.Module):
    """A gait under exact input-output linearisation.

    Attributes:
        robot: the rigid model.
        gait: policy, and the tube whose phase is used.
        bandwidth: double pole of the outputs [rad/s].
    """

    robot: PlanarBiped
    gait: Gait
    bandwidth: float = eqx.field(static=True)

    def point(self, z: ZeroState, eta: Float[Array, " two_m"]) -> FullPoint:
        """The robot in a state."""
        return FullPoint(self.robot, self.gait.policy, z, eta, self.bandwidth)

    def outputs(self, eta: Float[Array, " two_m"], time: Scalar) -> Float[Array, " two_m"]:
        """exp(A t) eta (rad, rad/s). [2m]."""
        y, dy = jnp.split(eta, 2)
        w = self.bandwidth
        pull = dy + w * y
        fade = jnp.exp(-w * time)
        return jnp.concatenate([fade * (y + pull * time), fade * (dy - w * pull * time)])

    def advance(self, state: "_Swing", to: Scalar) -> "_Swing":
        """Integrate to a phase by one step of the classical fourth-order method."""

        def slope(y):
            phase, z2, time = y
            point = self.point(jnp.stack([self._z1(phase), z2]), self.outputs(state.eta, time))
            start, guard = self.gait.span
            pace = point.dz[0] / (guard - start)
            return jnp.stack([jnp.ones(()), point.dz[1] / pace, 1.0 / pace])

        y = jnp.stack([state.phase, state.z2, state.time])
        _, z2, time = step(RK4, slope, y, to - state.phase)
        return _Swing(to, z2, time, state.eta)

    def state(self, at: "_Swing") -> tuple[ZeroState, Float[Array, " two_m"]]:
        """Both z and eta at a moment of the swing."""
        z = jnp.stack([self._z1(at.phase), at.z2])
        return z, self.outputs(at.eta, at.time)

    def at(self, moment: "_Swing") -> FullPoint:
        """The robot at a moment of the swing."""
        return self.point(*self.state(moment))

    def _z1(self, phase: Scalar) -> Scalar:
        start, guard = self.gait.span
        return start + phase * (guard - start)


class _Swing(NamedTuple):
    """A moment of a swing: time and eta are those since its start and at its start."""

    phase: Scalar
    z2: Scalar
    time: Scalar
    eta: Float[Array, " two_m"]


def walk_exactly(
    system: ExactOutputs,
    observe: Observe,
    z: ZeroState,
    eta: Float[Array, " two_m"],
    steps: int,
) -> ExactWalk:
    """Walk from a state in mid-step through some impacts. Use `jax.vmap` for batches."""

    def step(carry, _):
        z, eta, least, foot, duration = carry
        swing = _Swing(system.gait.phase(z[0]), z[1], jnp.zeros(()), eta)
        last, nodes = _to_last_phase(system, swing)
        guard = _to_guard(system, last)
        point = system.at(guard)
        after = point.z_after, point.eta_after
        moments = [jax.vmap(system.state)(nodes), system.state(guard), after]
        states = jax.tree.map(
            lambda *part: jnp.concatenate([part[0], jnp.stack(part[1:])]), *moments
        )
        # One after the other: what is observed is compiled once.
        seen = jax.lax.map(lambda state: observe(system.point(*state)), states)
        least = jnp.minimum(least, jnp.min(seen, axis=0))
        foot = jnp.maximum(foot, jnp.abs(point.foot[1]))
        return (*after, least, foot, duration + guard.time), None

    zero = jnp.zeros(())
    count = jax.eval_shape(lambda: observe(system.point(z, eta))).shape
    first = (z, eta, jnp.full(count, jnp.inf), zero, zero)
    (z, eta, least, foot, duration), _ = jax.lax.scan(step, first, None, length=steps)
    return ExactWalk(least, z, eta, foot, duration)


def _to_last_phase(system: ExactOutputs, swing: _Swing) -> tuple[_Swing, _Swing]:
    """Integrate to `LAST_PHASE`; stay where that is behind. Returns: the end, all before it."""
    h = (jnp.maximum(swing.phase, LAST_PHASE) - swing.phase) / NODES

    def node(swing, _):
        return system.advance(swing, swing.phase + h), swing

    return jax.lax.scan(node, swing, None, length=NODES)


def _to_guard(system: ExactOutputs, swing: _Swing) -> _Swing:
    """Integrate to where the swing foot is on the ground: secants in the phase."""

    def foot(phase):
        return system.at(system.advance(swing, phase)).foot[1]

    def secant(carry, _):
        before, height_before, here = carry
        height = foot(here)
        rise = height - height_before
        # At the root both heights are the same: stay there.
        move = jnp.where(rise == 0.0, 0.0, height * (here - before) / jnp.where(rise == 0, 1, rise))
        return (here, height, here - move), None

    first = (swing.phase, system.at(swing).foot[1], jnp.ones(()))
    (_, _, guard), _ = jax.lax.scan(secant, first, None, length=SECANTS)
    return system.advance(swing, guard)
