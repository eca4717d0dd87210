"""Inequalities between the constants of the disturbed theorem (level 5), in balls.

The argument is in docs/level5_proof.md; numbers of inequalities are those of docs/level5.md. Needs
no JAX.
"""

from flint import arb, fmpq

from neuralgaits.certificate.levels.disturbed.theorem import DisturbedConstants
from neuralgaits.certificate.levels.full_order.inequalities import (
    Inequality,
    after_impact,
    bound_at,
    inlet,
    tightening,
)
from neuralgaits.certificate.levels.full_order.theorem import (
    STIFF,
    BarrierConstants,
    FullOrderConstants,
    lyapunov_rate,
)


def inequalities(full: FullOrderConstants, shape: DisturbedConstants) -> list[Inequality]:
    """Return every inequality that the constants must satisfy."""
    zero, gamma, push = arb(0), decay(full, shape), arb(shape.push[0])
    left = _slower(full, shape)
    found = [] if not shape.scheduled else [Inequality("0 < decay", zero, gamma)]
    # Inequality 1 of docs/level5.md.
    found += [
        Inequality("0 < push", rest(shape), push),
        _not_above("0 <= its slope", 0.0, shape.push[1]),
        _not_above("push <= peak", shape.push[0], shape.peak[0]),
        _not_above("slope of push <= slope of peak", shape.push[1], shape.peak[1]),
        Inequality(
            "V decays faster than its bound shrinks, pushed: 4 shrink (1 + guard_strip) most pace "
            "< gamma - 2 b slope of push",
            4 * arb(full.shrink) * arb(full.ends[1]) * arb(full.pace[1]),
            left,
        ),
        Inequality(
            "the floor is above what pushes keep outputs at: 2 b push < (gamma - 2 b slope) floor",
            2 * factor(full) * push,
            left * arb(full.least_radius),
        ),
    ]
    for its, of in zip(shape.barriers, full.barriers, strict=False):
        found += _of_barrier(full, shape, its.name, its.alpha, its.weight, its.lost, of)
    if shape.free_clock:
        found += _of_kick(full, shape)
    return found + (_of_hold(full, shape, gamma) if shape.hold != 0.0 else [])


def _of_kick(full: FullOrderConstants, shape: DisturbedConstants) -> list[Inequality]:
    """Return inequalities by which D holds what an impact adds until the next tick."""
    hold, end, peak = arb(shape.hold), arb(shape.kick_end), arb(shape.kick_peak)
    rate = error_rate(full, shape)
    most = abs(arb(shape.jerk)) + abs(arb(shape.growth_slope)) * arb(full.radius)
    grown = (rate * hold).exp()
    kicked = sqrt_v_after_kick(full, shape)
    # Inequality 4 of docs/level5.md.
    found = [
        Inequality("free clock: 0 < hold", arb(0), hold),
        Inequality(
            "free clock: start_strip + most pace hold < kick_end",
            arb(full.start_strip) + arb(full.pace[1]) * hold,
            end,
        ),
        Inequality("free clock: kick_end < 1 - guard_strip", end, arb(full.guard_from)),
        Inequality(
            "free clock: errors from an impact to the next tick < kick_peak",
            first_kick(full, shape) * grown + most * (grown - 1) / rate,
            peak,
        ),
        Inequality(
            "free clock: sqrt(V+) + b hold mean kick < bound on sqrt(V) at the next tick",
            kicked,
            bound_at(full, arb(full.start_strip)).min(bound_at(full, end)),
        ),
    ]
    for barrier in full.barriers:
        found.append(
            Inequality(
                f"{barrier.name}: free clock: sigma (sqrt(V+) + b hold mean kick)^2 < h(z+) - t",
                arb(barrier.sigma) * kicked**2,
                inlet(full, barrier),
            )
        )
    return found


def sqrt_v_after_kick(full: FullOrderConstants, shape: DisturbedConstants) -> arb:
    """Bound sqrt(V) from an impact to the next tick, under the torque from before it [rad]."""
    return after_impact(full) + factor(full) * arb(shape.hold) * mean_kick(full, shape)


def first_kick(full: FullOrderConstants, shape: DisturbedConstants) -> arb:
    """Bound |S e| right after an impact under the torque from before it: J_0 [rad/s^2]."""
    radius = arb(full.guard_radius)
    before = arb(shape.peak[0]) + arb(shape.peak[1]) * radius
    exact = abs(arb(shape.kick)) + abs(arb(shape.kick_slope)) * radius
    return exact + abs(arb(shape.kick_push)) * before


def mean_kick(full: FullOrderConstants, shape: DisturbedConstants) -> arb:
    """Bound the mean of |S e| from an impact to the next tick; its bound is convex in time.

    With the error of the law's own torque at eta = 0.
    """
    return (first_kick(full, shape) + arb(shape.kick_peak)) / 2 + rest(shape)


def error_rate(full: FullOrderConstants, shape: DisturbedConstants) -> arb:
    """Return the rate at which |S e| feeds itself under held torques: 2 w + kappa [1/s]."""
    return 2 * arb(full.bandwidth) + abs(arb(shape.jerk_push))


def _of_hold(full: FullOrderConstants, shape: DisturbedConstants, gamma: arb) -> list[Inequality]:
    """Return inequalities by which a hold's error stays under peak and, in the mean, under push."""
    zero, hold, error = arb(0), arb(shape.hold), arb(shape.error)
    mean = hold / 2 * (1 + gamma * hold / 8)
    still, slope = growth(full, shape)
    # Inequality 3 of docs/level5.md; `mean` is its tau.
    return [
        Inequality("0 < hold", zero, hold),
        _not_above("0 <= error", 0.0, shape.error),
        Inequality("error + hold growth < peak", error + hold * still, arb(shape.peak[0])),
        Inequality("hold slope of growth < slope of peak", hold * slope, arb(shape.peak[1])),
        Inequality(
            "error + hold/2 (1 + gamma hold/8) growth < push",
            rest(shape) + error + mean * still,
            arb(shape.push[0]),
        ),
        Inequality(
            "hold/2 (1 + gamma hold/8) slope of growth < slope of push",
            mean * slope,
            arb(shape.push[1]),
        ),
    ]


def growth(full: FullOrderConstants, shape: DisturbedConstants) -> tuple[arb, arb]:
    """Return (first, second): under held torques |S e| grows by at most first + second R.

    R is the bound on sqrt(V) [rad/s^3, rad/s^3 per rad].
    """
    peak = arb(shape.peak[0]) + arb(shape.peak[1]) * arb(full.radius)
    still = abs(arb(shape.jerk)) + error_rate(full, shape) * peak
    # The bound on V was larger when the hold began, or at phase 0 if the phase is below.
    earlier = (decay(full, shape) * arb(shape.hold) / 2).exp() * arb(full.radius)
    earlier /= bound_at(full, arb(full.start_strip))
    return still, earlier * abs(arb(shape.growth_slope))


def most_push(full: FullOrderConstants, shape: DisturbedConstants) -> arb:
    """Bound what |S e| does to sqrt(V) in the mean over a hold, anywhere in the set."""
    most = arb(shape.push[0]) + arb(shape.push[1]) * arb(full.radius)
    if not shape.free_clock:
        return most
    # From an impact to the next tick sqrt(V) may be below its bound by b hold (mean kick).
    return most.max(decay(full, shape) * arb(shape.hold) * mean_kick(full, shape) / 2)


def _slower(full: FullOrderConstants, shape: DisturbedConstants) -> arb:
    """Return gamma less the part that pushes growing with V take: gamma' of inequality 1 [1/s]."""
    return decay(full, shape) - 2 * factor(full) * arb(shape.push[1])


def _not_above(claim: str, left: float, right: float) -> Inequality:
    """Return left <= right, of doubles, as an inequality."""
    if left <= right:
        return Inequality(claim, arb(0), arb(1))
    return Inequality(claim, arb(left), arb(right))


def _of_barrier(
    full: FullOrderConstants,
    shape: DisturbedConstants,
    name: str,
    alpha: float,
    weight: float,
    lost: float,
    of: BarrierConstants,
) -> list[Inequality]:
    """Return the inequality of one barrier.

    With q = 2 sigma b (most push), it uses (c + q)^2 <= (1 + r) c^2 + (1 + 1/r) q^2 for every r >
    0.
    """
    # Inequality 2 of docs/level5.md; `spare` is its r_i.
    zero, gamma, gain = arb(0), decay(full, shape), arb(alpha)
    first = [
        Inequality(f"{name}: 0 < alpha", zero, gain),
        Inequality(f"{name}: alpha < gamma", gain, gamma),
        Inequality(f"{name}: 0 < sigma", zero, arb(of.sigma)),
    ]
    if not all(step.holds for step in first):
        return first
    rest = 4 * arb(of.sigma) * (gamma - gain)
    spare = arb(weight) * rest - 1
    split = Inequality(f"{name}: 1 < 4 sigma (gamma - alpha) weight", zero, spare)
    if not split.holds:
        return [*first, split]
    moved = 2 * arb(of.sigma) * factor(full) * most_push(full, shape)
    needed = gain * tightening(of) + (1 + 1 / spare) * moved**2 / rest
    claim = f"{name}: alpha t and what the push takes < lost"
    return [*first, split, Inequality(claim, needed, arb(lost))]


def factor(full: FullOrderConstants) -> arb:
    """Return the b of V' <= -gamma V + 2 b sqrt(V) |S e| [s]."""
    stiff = arb(fmpq(STIFF.numerator, STIFF.denominator))
    return (1 + stiff**2).sqrt() / arb(full.bandwidth)


def rest(shape: DisturbedConstants) -> arb:
    """Bound |S e| of the law's own torque at eta = 0 [rad/s^2]."""
    return abs(arb(shape.rest)) if shape.scheduled else arb(0)


def decay(full: FullOrderConstants, shape: DisturbedConstants) -> arb:
    """Return gamma, the rate at which V falls at least without errors [1/s]."""
    if shape.scheduled:
        return arb(shape.decay)
    rate = lyapunov_rate(full.bandwidth)
    return arb(fmpq(rate.numerator, rate.denominator))
