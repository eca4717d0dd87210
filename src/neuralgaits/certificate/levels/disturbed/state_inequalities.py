"""Inequalities of level 5 about a measured state, in balls: those of docs/level5_sensing.md.

Needs no JAX.
"""

from flint import arb

from neuralgaits.certificate.levels.disturbed.theorem import DisturbedConstants
from neuralgaits.certificate.levels.full_order.inequalities import Inequality
from neuralgaits.certificate.levels.full_order.theorem import FullOrderConstants, joints_of


def state_inequalities(full: FullOrderConstants, disturbed: DisturbedConstants) -> list[Inequality]:
    """Return every inequality about a measured state; none where torques are of the true one."""
    if not disturbed.measured:
        return []
    zero, one = arb(0), arb(1)
    joints = joints_of(full.weights)
    if not joints or len(disturbed.state_axes) != 2 * (joints + 1) or disturbed.scheduled:
        claim = "a measured state has an axis for each angle and rate, under exact linearisation"
        return [Inequality(claim, one, zero)]
    phase, _, xi = map(arb, disturbed.state_moves)
    steepest = (arb(full.radius) - arb(full.least_radius)) * (
        2 * arb(full.shrink) / one.exp()
    ).sqrt()
    return [
        Inequality("0 < each error and axis of a measured state", zero, _least(disturbed)),
        Inequality("errors of a measured state are in their ellipsoid", _share(disturbed), one),
        Inequality(
            "what a measured state moves xi by, beside its bound, < state radius",
            xi + steepest * phase,
            arb(disturbed.state_radius),
        ),
        Inequality(
            "|S e| of torques of measured states < error",
            sensed_error(disturbed),
            arb(disturbed.error),
        ),
        Inequality("torques of measured states are held: 0 < hold", zero, arb(disturbed.hold)),
    ]


def sensed_error(disturbed: DisturbedConstants) -> arb:
    """Bound |S e| of torques of measured states when they are set [rad/s^2]."""
    first, growth = map(arb, disturbed.state_slopes)
    return first * growth.exp()


def _least(disturbed: DisturbedConstants) -> arb:
    """Return the least of numbers that must be positive."""
    numbers = *disturbed.state_error, *disturbed.state_axes, *disturbed.state_moves
    least = arb(min(numbers))
    # Slopes may be zero.
    return least if min(disturbed.state_slopes) >= 0.0 else arb(-1)


def _share(disturbed: DisturbedConstants) -> arb:
    """Return the largest sum of squared errors over squared axes: 1 on the ellipsoid's surface."""
    angles = len(disturbed.state_axes) // 2
    most = [error for error in disturbed.state_error for _ in range(angles)]
    pairs = zip(most, disturbed.state_axes, strict=True)
    return sum(((arb(error) / arb(axis)) ** 2 for error, axis in pairs), arb(0))
