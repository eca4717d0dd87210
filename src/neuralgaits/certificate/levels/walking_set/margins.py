"""Margins of the walking set: a tube of the hybrid zero dynamics is invariant (level 2).

T = {-start_strip <= phase <= 1 + guard_strip, 0 <= level <= 1}. The flow moves forward through
it, cannot cross its fences, meets the guard once, in the strip around phase 1, and is reset
between the fences, into the strip around phase 0. Each margin here belongs to a root box that
`theorem.walking_premises` names; docs/walking_set.md says what follows from them. Safety and valid
contact are the spec's own conditions, carried over to the strips.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import jax
import jax.numpy as jnp

from neuralgaits._types import Array, Float, Scalar, ZeroState
from neuralgaits.barriers import Barrier, Gait, GaitSpec
from neuralgaits.barriers.functions import transversal_inertia
from neuralgaits.certificate.chart import PLANE
from neuralgaits.certificate.levels.walking_set.theorem import WalkingSetConstants
from neuralgaits.gait import AbstractPolicy, HybridInvariantPolicy, Point, ZeroDynamics
from neuralgaits.gait.policies.step_ends import END_POINT_MARGIN
from neuralgaits.gait.zero_coordinates import momentum_of, position_of


def margins(
    spec: GaitSpec,
    gait: Gait,
    zd: ZeroDynamics,
    constants: WalkingSetConstants,
    u: Float[Array, " n"],
) -> dict[str, Float[Array, "..."]]:
    """Return margins of the walking set at one chart point, by output name.

    Margins that depend on dz are evaluated at every corner of the disturbance's box: they are
    linear in dz, or a quotient of such, so a corner is the worst.
    """
    z = gait.z(u[:PLANE])
    point = zd.point(z)
    pushed = [moved.point(z) for moved in disturbed(zd, constants.disturbance)]
    falls = jnp.stack([p.foot_lift_rate for p in pushed])
    inward = [gait.inward(p.z, p.dz) for p in pushed]
    low, high = jnp.sqrt(2.0 * gait.tube.fences(u[0]))
    margins_by_name = {
        # C1.
        "set/forward": jnp.stack([position_of(p.dz) for p in pushed]) / gait.stride,
        "set/inertia": transversal_inertia(point),
        # C2.
        "set/fence-lower": jnp.stack([side[0] for side in inward]),
        "set/fence-upper": jnp.stack([side[1] for side in inward]),
        "set/width": 2.0 * (high - low) / (high + low),
        # C3 and C4.
        "set/foot-above": point.foot_above_ground,
        "set/foot-below": -point.foot_above_ground,
        "set/foot-rises": falls,
        "set/foot-falls": -falls,
    }
    # C5.
    margins_by_name |= _inlet(gait, point, u[0]) if constants.told else _reset(gait, point)
    # C6.
    for barrier in barriers(spec):
        if not constants.told:
            margins_by_name[f"set/after {barrier.name}"] = barrier.function(point.after)
        margins_by_name[f"set/value {barrier.name}"] = barrier.function(point)
        if any(constants.disturbance):
            margins_by_name[f"set/rate {barrier.name}"] = _pushed_rates(barrier, zd, z, pushed)
    return margins_by_name


def _reset(gait: Gait, point: Point) -> dict[str, Float[Array, "..."]]:
    """Return margins of the place where the reset lands, in the same tube."""
    phase = gait.phase(position_of(point.z_after))
    level = gait.level(point.z_after)
    return {
        "set/reset-phase": jnp.stack([phase, -phase]),
        # The level does not tell forward from backward: z2 must keep its sign as well.
        "set/reset-level": jnp.stack([level, 1.0 - level, _kept_momentum(point)]),
    }


def _kept_momentum(point: Point) -> Scalar:
    """Return the momentum after the impact per momentum before."""
    return momentum_of(point.z_after) / momentum_of(point.z)


def _inlet(gait: Gait, point: Point, phase: Scalar) -> dict[str, Float[Array, "..."]]:
    """Return margins of a reset into the next step's tube, independent of its command."""
    then = gait.steady_next
    ahead = position_of(point.z_after) - then.span[0]
    low, high = then.tube.fences(0.0)
    momentum = momentum_of(point.z_after)
    level = (0.5 * momentum * momentum - low) / (high - low)
    first, last = gait.tube.fences(0.0)
    steep = gait.tube.fence_slopes(phase) / (last - first)
    return {
        "set/reset-place": jnp.stack([ahead, -ahead]),
        "set/inlet": jnp.stack([level, 1.0 - level, _kept_momentum(point)]),
        "set/stride": jnp.asarray(gait.stride),
        "set/steepness": jnp.concatenate([steep, -steep]),
        "set/within-bounds": _within_bounds(gait.policy),
    }


def _within_bounds(policy: AbstractPolicy) -> Float[Array, "..."]:
    """Return how far both ends of a step are inside the clipping bounds of outputs [rad]."""
    assert isinstance(policy, HybridInvariantPolicy)
    margin = END_POINT_MARGIN * (policy.upper - policy.lower)
    parts = [
        part
        for end in (policy.start_outputs, policy.guard_outputs)
        for part in (end - policy.lower - margin, policy.upper - margin - end)
    ]
    return jnp.concatenate(parts)


def barriers(spec: GaitSpec) -> Iterator[Barrier]:
    """Yield the spec's barrier conditions in their order."""
    for condition in spec.conditions:
        if isinstance(condition, Barrier):
            yield condition


def disturbed(zd: ZeroDynamics, bound: tuple[float, float]) -> list[ZeroDynamics]:
    """Return the zero dynamics at each corner of |d| <= bound in dz; itself for a bound of zero."""
    if not any(bound):
        return [zd]
    corners = [(a, b) for a in (-1.0, 1.0) for b in (-1.0, 1.0)]
    pushes = [_DisturbedPoint(zd.residual, bound, corner) for corner in corners]
    return [ZeroDynamics(zd.robot, zd.policy, push, zd.reset_residual) for push in pushes]


@dataclass(frozen=True)
class _DisturbedPoint:
    """A residual with a corner of the disturbance's box added."""

    residual: object
    bound: tuple[float, float]
    corner: tuple[float, float]

    def __call__(self, z: ZeroState) -> ZeroState:
        constant = jnp.array(self.bound) * jnp.array(self.corner)
        return constant if self.residual is None else constant + self.residual(z)  # pyright: ignore[reportCallIssue]


def _pushed_rates(
    barrier: Barrier, zd: ZeroDynamics, z: ZeroState, pushed: Sequence[Point]
) -> Float[Array, "..."]:
    """Return dh/dt + alpha(h) along every flow, in the form of margins.

    h reads quantities of the undisturbed flow at z, functions of z alone, so that its rate is
    linear in dz. A velocity of the disturbed flow would jump with the push.
    """

    def h(z: ZeroState) -> Float[Array, "..."]:
        return barrier.function(zd.point(z))

    value, slopes = h(z), jax.jacfwd(h)(z)
    return jnp.stack([barrier.bent(value, slopes @ point.dz) for point in pushed])
