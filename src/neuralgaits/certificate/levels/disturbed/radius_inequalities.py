"""Inequality 1 of docs/level5.md in balls: sqrt(V) stays in its bound while torques are held.

The argument is in docs/level5_radius.md. Needs no JAX.
"""

from flint import arb

from neuralgaits.certificate.levels.disturbed.model_inequalities import (
    jerk_drift,
    most_error,
    output_drift,
)
from neuralgaits.certificate.levels.disturbed.theorem import DisturbedConstants
from neuralgaits.certificate.levels.full_order.hold_map import HoldErrors, face_matrix
from neuralgaits.certificate.levels.full_order.inequalities import Inequality, bound_at
from neuralgaits.certificate.levels.full_order.theorem import FullOrderConstants

SPLITS = ("0.4", "0.45", "0.5", "0.55", "0.6", "0.7", "0.8", "0.9", "1", "1.2", "1.5")
"""Numbers that are tried for the split of `face_matrix`."""
PIECES = 8
"""Pieces of a hold on each of which `face_matrix` is bounded."""


def face_inequalities(full: FullOrderConstants, disturbed: DisturbedConstants) -> list[Inequality]:
    """Return inequality 1 for holds under exact linearisation: sqrt(V) stays in its bound.

    The matrices of `face_matrix`, at the least radius and per rad beyond it, are positive definite
    for the whole hold.
    """
    zero, hold = arb(0), arb(disturbed.hold)
    if not (hold > 0 and disturbed.error >= 0.0):
        return [Inequality("0 < hold, 0 <= error", zero, zero)]
    w, least = arb(full.bandwidth), arb(full.least_radius)
    still, slope = _halves(full, disturbed)
    at_tick = arb(disturbed.error) / w**2
    shrinks = 2 * arb(full.shrink) * arb(full.ends[1]) * arb(full.pace[1]) / w
    at_least = HoldErrors((still + slope * least) / w**2, at_tick)
    drifts, drift_slope = _drifts(full, disturbed)
    return [
        _definite(
            "the least radius is above what holds keep outputs at: N at the least radius is "
            "positive definite",
            (w * hold, least, at_least, (drifts + drift_slope * least) / w),
        ),
        _definite(
            "outputs in holds fall faster than their bound shrinks: the slope of N in it is "
            "positive definite",
            (w * hold, arb(1), HoldErrors(slope / w**2, zero), shrinks + drift_slope / w),
        ),
    ]


def _definite(claim: str, at: tuple[arb, arb, HoldErrors, arb]) -> Inequality:
    """Return, for the best split, an inequality that the least eigenvalue of N is positive."""
    last, radius, errors, shrink = at
    rows: list[Inequality] = []
    for split in SPLITS:
        rows.append(_definite_for_all(claim, last, radius, errors, shrink, arb(split)))
        if rows[-1].holds:
            return rows[-1]
    return rows[len(rows) // 2]


def _definite_for_all(
    claim: str, last: arb, radius: arb, errors: HoldErrors, shrink: arb, split: arb
) -> Inequality:
    """Return the inequality for pieces of [0, last]; of one that fails, if one does."""
    row = Inequality(claim, arb(0), arb(0))
    for piece in range(PIECES):
        tau = (last * piece / PIECES).union(last * (piece + 1) / PIECES)
        first, mixed, second = face_matrix(tau, radius, errors, shrink, split)
        apart = ((first - second) ** 2 + 4 * mixed**2).sqrt()
        row = Inequality(claim, apart, first + second)
        if not row.holds:
            break
    return row


def _halves(full: FullOrderConstants, disturbed: DisturbedConstants) -> tuple[arb, arb]:
    """Return (first, second): the jerk of a hold times half its length, at most [rad/s^2].

    It is first + second R, R being the bound on sqrt(V) at the tick.
    """
    half, push = arb(disturbed.hold) / 2, abs(arb(disturbed.jerk_push))
    of_model = jerk_drift(full, disturbed, most_error(full, disturbed))
    still = abs(arb(disturbed.jerk)) + (push + of_model.second) * arb(disturbed.peak[0])
    slope = abs(arb(disturbed.growth_slope)) + (push + of_model.second) * arb(disturbed.peak[1])
    slope += of_model.third
    return half * (still + of_model.first), half * slope * beside_start(full)


def _drifts(full: FullOrderConstants, disturbed: DisturbedConstants) -> tuple[arb, arb]:
    """Return (first, second): what other robots' links add to sqrt(V) per second [rad/s].

    It is first + second R, as in `_halves`. Without a torque outputs drift on for the rest of the
    hold, which makes what was added longer by at most the norm of (1, 0; 2 w T, 1).
    """
    drift, angle = output_drift(disturbed), arb(full.bandwidth) * arb(disturbed.hold)
    longer = angle + (1 + angle**2).sqrt()
    slope = drift.second * arb(disturbed.peak[1]) + drift.third
    return longer * drift.at(arb(disturbed.peak[0]), arb(0)), longer * slope * beside_start(full)


def beside_start(full: FullOrderConstants) -> arb:
    """Return how much larger the bound on sqrt(V) is at phase 0 than where the tube begins, [1]."""
    return arb(full.radius) / bound_at(full, arb(full.start_strip))
