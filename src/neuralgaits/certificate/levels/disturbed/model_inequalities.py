"""Effect of robots whose links are not the file's, in balls: numbers of docs/level5_model.md.

Everything is 0 where the robot is the file's, so that inequalities are those of docs/level5.md.
Needs no JAX.
"""

from typing import NamedTuple

from flint import arb

from neuralgaits.certificate.levels.disturbed.model_theorem import (
    GROWTH,
    MODEL_LENGTHS,
    MOMENTUM,
    OUTPUT,
    PACE,
)
from neuralgaits.certificate.levels.disturbed.theorem import DisturbedConstants
from neuralgaits.certificate.levels.full_order.inequalities import (
    Inequality,
    after_impact,
    bound_at,
    inlet,
)
from neuralgaits.certificate.levels.full_order.share_bounds import largest_shares
from neuralgaits.certificate.levels.full_order.theorem import (
    FullOrderConstants,
    joints_of,
    weighting,
)


class Affine(NamedTuple):
    """A bound that is first + second P + third R, for |S e| up to P and sqrt(V) up to R."""

    first: arb
    second: arb
    third: arb

    def at(self, push: arb, radius: arb) -> arb:
        """Return the bound for |S e| up to `push` and sqrt(V) up to `radius`."""
        return self.first + self.second * push + self.third * radius

    def with_more(self, factor: arb, other: "Affine") -> "Affine":
        """Return the bound that has a multiple of another one more."""
        return Affine(*(own + factor * its for own, its in zip(self, other, strict=True)))


NOTHING = Affine(arb(0), arb(0), arb(0))


def more_acceleration(disturbed: DisturbedConstants) -> Affine:
    """Bound what shares add to Q ddq: rho of docs/level5_model.md."""
    if not disturbed.of_other_robots:
        return NOTHING
    left = 1 - _size(disturbed.model_feeds[0])
    return Affine(*(bound / left for bound in _moves(disturbed, 0)))


def output_drift(disturbed: DisturbedConstants) -> Affine:
    """Bound what shares add to the rate of xi [rad/s]."""
    return _felt(disturbed, OUTPUT)


def momentum_drift(disturbed: DisturbedConstants) -> Affine:
    """Bound what shares add to the rate of z2 [N m]."""
    return _felt(disturbed, MOMENTUM)


def error_drift(disturbed: DisturbedConstants, most: arb) -> Affine:
    """Bound what shares add to d|S e|/dt under held torques, for |S e| up to `most` [rad/s^3].

    To first order that is affine in S e but for a product, and more acceleration feeds it.
    """
    if not disturbed.of_other_robots:
        return NOTHING
    slope, growth, _ = map(_size, disturbed.model_errors)
    first, push, radius = _moves(disturbed, GROWTH)
    square = growth * _size(disturbed.model_pushes[0]) * most
    fed = (slope + growth * most) * _size(disturbed.model_feeds[0])
    return Affine(first, push + square, radius).with_more(fed, more_acceleration(disturbed))


def jerk_drift(full: FullOrderConstants, disturbed: DisturbedConstants, most: arb) -> Affine:
    """Bound what shares add to the rate of the outputs' acceleration by the file [rad/s^3].

    That is dF - w^2 y' - 2 w y'', whose last parts are w^2 (xi_1' + xi_2' / 2) in what shares add.
    """
    back = arb(5).sqrt() / 2 * arb(full.bandwidth) ** 2
    return error_drift(disturbed, most).with_more(back, output_drift(disturbed))


def _moves(disturbed: DisturbedConstants, which: int) -> Affine:
    """Bound what shares add to one of `Moves`, to first order."""
    lists = disturbed.model_moves, disturbed.model_pushes, disturbed.model_moves_slope
    return Affine(*(_size(bounds[which]) for bounds in lists))


def _felt(disturbed: DisturbedConstants, which: int) -> Affine:
    """Bound what shares add to a rate: to first order, and what more acceleration feeds."""
    if not disturbed.of_other_robots:
        return NOTHING
    fed = _size(disturbed.model_feeds[which])
    return _moves(disturbed, which).with_more(fed, more_acceleration(disturbed))


def most_error(full: FullOrderConstants, disturbed: DisturbedConstants) -> arb:
    """Bound |S e| in all of the set, apart from what an impact leaves until the next tick."""
    return arb(disturbed.peak[0]) + arb(disturbed.peak[1]) * arb(full.radius)


def landed(full: FullOrderConstants, disturbed: DisturbedConstants) -> arb:
    """Bound what shares add to Q dq in an impact."""
    if not disturbed.of_other_robots:
        return arb(0)
    return _first_landed(full, disturbed, 0) / (1 - _size(disturbed.model_feeds[0]))


def outputs_landed(full: FullOrderConstants, disturbed: DisturbedConstants) -> arb:
    """Bound what shares add to sqrt(V) in an impact [rad]."""
    if not disturbed.of_other_robots:
        return arb(0)
    momentum, pace = (_landed(full, disturbed, which) for which in (MOMENTUM, PACE))
    mixed, twice = map(_size, disturbed.model_curvature)
    return _landed(full, disturbed, OUTPUT) + mixed * pace * momentum + twice * momentum**2 / 2


def barrier_landed(full: FullOrderConstants, disturbed: DisturbedConstants, k: int) -> arb:
    """Bound what shares take of a barrier in an impact [h]."""
    if not disturbed.of_other_robots:
        return arb(0)
    return _size(disturbed.model_slopes[k]) * _landed(full, disturbed, MOMENTUM)


def _first_landed(full: FullOrderConstants, disturbed: DisturbedConstants, which: int) -> arb:
    """Bound what shares add to one of `Landed`, to first order."""
    slope = _size(disturbed.model_impacts_slope[which]) * arb(full.guard_radius)
    return _size(disturbed.model_impacts[which]) + slope


def _landed(full: FullOrderConstants, disturbed: DisturbedConstants, which: int) -> arb:
    """Bound what shares add in an impact: to first order, and what more rates feed."""
    fed = _size(disturbed.model_feeds[which])
    return _first_landed(full, disturbed, which) + fed * landed(full, disturbed)


def kicked_barrier(disturbed: DisturbedConstants, k: int) -> arb:
    """Bound what shares take more of a barrier's rate between an impact and the next tick [h/s].

    Their premise counts errors up to the peak; those of an impact reach `kick_peak`.
    """
    if not disturbed.of_other_robots:
        return arb(0)
    more = momentum_drift(disturbed).second * arb(disturbed.kick_peak)
    return _size(disturbed.model_slopes[k]) * more


def kicked_by_model(full: FullOrderConstants, disturbed: DisturbedConstants, first: arb) -> arb:
    """Bound |S e| after an impact of another robot, given that of the file's [rad/s^2]."""
    if not disturbed.of_other_robots:
        return first
    slope, growth, _ = map(_size, disturbed.model_errors)
    more = landed(full, disturbed)
    return (first + slope * more) * (growth * more).exp()


def model_inequalities(full: FullOrderConstants, disturbed: DisturbedConstants) -> list[Inequality]:
    """Return every inequality about other robots; none where the robot is the file's."""
    if not disturbed.of_other_robots:
        return []
    zero, one = arb(0), arb(1)
    if not _fits(full, disturbed):
        claim = (
            "other robots have five shares a type of link, a triangular metric over the "
            "coordinates and bounds that are not negative, under held exact linearisation"
        )
        return [Inequality(claim, one, zero)]
    most = most_error(full, disturbed).max(arb(disturbed.kick_peak))
    peak, peak_landed = map(arb, disturbed.model_peaks)
    after = after_impact(full) + outputs_landed(full, disturbed)
    rows = [
        Inequality("0 < axes of the shares of other robots", zero, _least_axis(disturbed)),
        Inequality("shares of other robots are in their ellipsoid", _share(disturbed), one),
        Inequality(
            "other robots: what accelerations feed < 1", _size(disturbed.model_feeds[0]), one
        ),
        Inequality(
            "other robots: what shares add to accelerations < its bound",
            more_acceleration(disturbed).at(most, arb(full.radius)),
            peak,
        ),
        Inequality(
            "other robots: what shares add to rates in an impact < its bound",
            landed(full, disturbed),
            peak_landed,
        ),
        Inequality(
            "other robots: outputs after an impact are in the set: sqrt(V+) < radius",
            after,
            bound_at(full, arb(full.start_strip)),
        ),
    ]
    for k, barrier in enumerate(full.barriers[: len(disturbed.model_slopes)]):
        rows.append(
            Inequality(
                f"{barrier.name}: other robots: across impacts, sigma V+ < h(z+) - t",
                arb(barrier.sigma) * after**2,
                inlet(full, barrier) - barrier_landed(full, disturbed, k),
            )
        )
    return rows


def _fits(full: FullOrderConstants, disturbed: DisturbedConstants) -> bool:
    """Return whether lists have their lengths and signs. Premises see some bounds by squares only.

    Others read the same bounds as they are, so that a negative one would give room.
    """
    joints, size = joints_of(full.weights), joints_of(disturbed.model_metric)
    lists = (getattr(disturbed, name) for name in (*MODEL_LENGTHS, "model_slopes"))
    # A comparison with NaN is false.
    if not all(number >= 0.0 for numbers in lists for number in numbers):
        return False
    if not joints or size is None or size != joints + 1 or len(disturbed.model_axes) % 5:
        return False
    rows = weighting(disturbed.model_metric, size)
    if not all(rows[i][i] * rows[i][i] > 0.0 for i in range(size)):
        return False
    return not disturbed.scheduled and disturbed.hold != 0.0


def _share(disturbed: DisturbedConstants) -> arb:
    """Return the largest sum of squared shares over squared axes: 1 on the ellipsoid's surface."""
    return sum(((share / arb(axis)) ** 2 for share, axis in _shares_and_axes(disturbed)), arb(0))


def _least_axis(disturbed: DisturbedConstants) -> arb:
    """Return the least axis of shares that are not 0; 0 if all are."""
    return arb(min((axis for _, axis in _shares_and_axes(disturbed)), default=0.0))


def _shares_and_axes(disturbed: DisturbedConstants) -> list[tuple[arb, float]]:
    """Return the largest of each share, with its axis, but for shares that are 0."""
    types = len(disturbed.model_axes) // 5
    largest = largest_shares(*map(arb, disturbed.model_box))
    most = [share for share in largest for _ in range(types)]
    pairs = zip(most, disturbed.model_axes, strict=True)
    return [(share, axis) for share, axis in pairs if share > 0]


def _size(bound: float) -> arb:
    """Return the size of a bound; `_fits` refuses negative ones."""
    return abs(arb(bound))
