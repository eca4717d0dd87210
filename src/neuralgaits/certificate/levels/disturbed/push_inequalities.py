"""Inequalities between the constants of the disturbed theorem (level 5), in balls.

The argument is in docs/level5_proof.md; inequalities 1 to 3 are those of docs/level5.md, 4 that of
docs/level5_clock.md. Needs no JAX.
"""

from dataclasses import astuple

from flint import arb, fmpq

from neuralgaits.certificate.levels.disturbed.model_inequalities import (
    barrier_landed,
    error_drift,
    kicked_barrier,
    kicked_by_model,
    model_inequalities,
    most_error,
    output_drift,
    outputs_landed,
)
from neuralgaits.certificate.levels.disturbed.radius_inequalities import (
    beside_start,
    face_inequalities,
)
from neuralgaits.certificate.levels.disturbed.state_inequalities import state_inequalities
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


def inequalities(full: FullOrderConstants, disturbed: DisturbedConstants) -> list[Inequality]:
    """Return every inequality that the constants must satisfy."""
    zero, gamma, push = arb(0), decay(full, disturbed), arb(disturbed.push[0])
    rows = [] if not disturbed.scheduled else [Inequality("0 < decay", zero, gamma)]
    # Inequality 1 of docs/level5.md.
    rows += [
        Inequality("0 < push", rest(disturbed), push),
        _not_above("0 <= its slope", 0.0, disturbed.push[1]),
        _not_above("push <= peak", disturbed.push[0], disturbed.peak[0]),
        _not_above("slope of push <= slope of peak", disturbed.push[1], disturbed.peak[1]),
    ]
    rows += _radius_inequalities(full, disturbed)
    for k, of in enumerate(full.barriers[: len(disturbed.barriers)]):
        rows += _barrier_inequalities(full, disturbed, k, of)
    if disturbed.free_clock:
        rows += _kick_inequalities(full, disturbed)
    rows += state_inequalities(full, disturbed) + model_inequalities(full, disturbed)
    return rows + (_hold_inequalities(full, disturbed) if disturbed.hold != 0.0 else [])


def _radius_inequalities(
    full: FullOrderConstants, disturbed: DisturbedConstants
) -> list[Inequality]:
    """Return inequalities by which sqrt(V) stays in its bound."""
    if not disturbed.scheduled:
        rows = [Inequality("0 < least radius", arb(0), arb(full.least_radius))]
        return rows + (face_inequalities(full, disturbed) if disturbed.hold != 0.0 else [])
    push, left = arb(disturbed.push[0]), _slower(full, disturbed)
    return [
        Inequality(
            "V decays faster than its bound shrinks, pushed: 4 shrink (1 + guard_strip) most pace "
            "< gamma - 2 b slope of push",
            4 * arb(full.shrink) * arb(full.ends[1]) * arb(full.pace[1]),
            left,
        ),
        Inequality(
            "the least radius is above what pushes keep outputs at: 2 b push < (gamma - 2 b slope) "
            "least radius",
            2 * factor(full) * push,
            left * arb(full.least_radius),
        ),
    ]


def _kick_inequalities(full: FullOrderConstants, disturbed: DisturbedConstants) -> list[Inequality]:
    """Return inequalities by which D holds what an impact adds until the next tick."""
    hold, end, peak = arb(disturbed.hold), arb(disturbed.kick_end), arb(disturbed.kick_peak)
    rate = error_rate(full, disturbed)
    most = abs(arb(disturbed.jerk)) + growth_slope(full, disturbed) * arb(full.radius)
    most += error_drift(disturbed, peak).at(peak, arb(full.radius))
    grown = (rate * hold).exp()
    kicked, at_tick = _w_after_kick(full, disturbed), sqrt_v_after_kick(full, disturbed)
    # Inequality 4 of docs/level5_clock.md.
    rows = [
        Inequality("free clock: 0 < hold", arb(0), hold),
        Inequality(
            "free clock: start_strip + most pace hold < kick_end",
            arb(full.start_strip) + arb(full.pace[1]) * hold,
            end,
        ),
        Inequality("free clock: kick_end < 1 - guard_strip", end, arb(full.guard_from)),
        Inequality(
            "free clock: errors from an impact to the next tick < kick_peak",
            first_kick(full, disturbed) * grown + most * (grown - 1) / rate,
            peak,
        ),
        Inequality(
            "free clock: sqrt(V+) exp(-gamma hold / 2) + b hold mean kick < bound on sqrt(V) at "
            "the next tick",
            at_tick,
            bound_at(full, arb(full.start_strip)).min(bound_at(full, end)),
        ),
    ]
    for k, barrier in enumerate(full.barriers[: len(disturbed.barriers)]):
        rows.append(
            Inequality(
                f"{barrier.name}: free clock: sigma (sqrt(V+) + b hold mean kick)^2 < h(z+) - t",
                arb(barrier.sigma) * kicked**2,
                inlet(full, barrier) - barrier_landed(full, disturbed, k),
            )
        )
    return rows


def sqrt_v_after_kick(full: FullOrderConstants, disturbed: DisturbedConstants) -> arb:
    """Bound sqrt(V) from an impact to the next tick, under the torque from before it [rad].

    The bound is convex in the time since the impact, so its ends suffice.
    """
    after = after_impact(full) + outputs_landed(full, disturbed)
    decayed = (-decay(full, disturbed) * arb(disturbed.hold) / 2).exp() * after
    return after.max(decayed + _kick_added(full, disturbed))


def _w_after_kick(full: FullOrderConstants, disturbed: DisturbedConstants) -> arb:
    """Bound W right after an impact: sqrt(V) and all that is added until the next tick [rad]."""
    return after_impact(full) + outputs_landed(full, disturbed) + _kick_added(full, disturbed)


def _kick_added(full: FullOrderConstants, disturbed: DisturbedConstants) -> arb:
    """Bound what errors add to sqrt(V) from an impact to the next tick [rad]."""
    return factor(full) * arb(disturbed.hold) * mean_kick(full, disturbed)


def first_kick(full: FullOrderConstants, disturbed: DisturbedConstants) -> arb:
    """Bound |S e| right after an impact under the torque from before it: J_0 [rad/s^2]."""
    radius = arb(full.guard_radius)
    before = arb(disturbed.peak[0]) + arb(disturbed.peak[1]) * radius
    exact = abs(arb(disturbed.kick)) + abs(arb(disturbed.kick_slope)) * radius
    return kicked_by_model(full, disturbed, exact + abs(arb(disturbed.kick_push)) * before)


def mean_kick(full: FullOrderConstants, disturbed: DisturbedConstants) -> arb:
    """Bound the mean of |S e| from an impact to the next tick; its bound is convex in time.

    With the error of the law's own torque at eta = 0, and what other robots' links add.
    """
    peak = arb(disturbed.kick_peak)
    beside = rest(disturbed) + output_drift(disturbed).at(peak, arb(full.radius)) / factor(full)
    return (first_kick(full, disturbed) + peak) / 2 + beside


def error_rate(full: FullOrderConstants, disturbed: DisturbedConstants) -> arb:
    """Return the rate at which |S e| feeds itself under held torques: 2 w + kappa [1/s]."""
    return 2 * arb(full.bandwidth) + abs(arb(disturbed.jerk_push))


def _hold_inequalities(full: FullOrderConstants, disturbed: DisturbedConstants) -> list[Inequality]:
    """Return inequalities by which a hold's error stays under peak and, in the mean, under push.

    Both sides are affine in the bound on sqrt(V), so its least and largest values suffice.
    """
    hold, error = arb(disturbed.hold), arb(disturbed.error)
    # Inequality 3 of docs/level5.md.
    rows = [
        Inequality("0 < hold", arb(0), hold),
        _not_above("0 <= error", 0.0, disturbed.error),
    ]
    if not rows[0].holds:
        return rows
    still, slope = growth(full, disturbed)
    at_end, in_mean = _grown(full, disturbed)
    errors = disturbed.peak, disturbed.push
    for name, radius in (("least radius", full.least_radius), ("radius", full.radius)):
        bound = arb(radius)
        most = still + slope * bound
        peak, push = (arb(first) + arb(second) * bound for first, second in errors)
        at_tick = error + at_end * most
        mean = rest(disturbed) + error + in_mean * most
        rows += [
            Inequality(f"error + growth in a hold < peak at the {name}", at_tick, peak),
            Inequality(f"error + mean growth in a hold < push at the {name}", mean, push),
        ]
    return rows


def _grown(full: FullOrderConstants, disturbed: DisturbedConstants) -> tuple[arb, arb]:
    """Return c and mu of docs/level5.md: growth in a hold and in its mean, of a unit rate [s]."""
    hold, rate = arb(disturbed.hold), error_rate(full, disturbed)
    end = ((rate * hold).exp() - 1) / rate
    bent = decay(full, disturbed) * hold**2 * (rate * hold).exp() / 16
    return end, (end - hold) / (rate * hold) + bent


def growth(full: FullOrderConstants, disturbed: DisturbedConstants) -> tuple[arb, arb]:
    """Return (first, second) [rad/s^3, rad/s^3 per rad]: the growth of |S e| at a tick.

    It is at most first + second R, R being the bound on sqrt(V) at any later moment of the hold.
    """
    most = most_error(full, disturbed)
    still = abs(arb(disturbed.jerk)) + error_drift(disturbed, most).at(most, arb(full.radius))
    still += error_rate(full, disturbed) * arb(disturbed.error)
    # The bound on V was larger when the hold began, or at phase 0 if the phase is below.
    earlier = (decay(full, disturbed) * arb(disturbed.hold) / 2).exp() * beside_start(full)
    return still, earlier * growth_slope(full, disturbed)


def growth_slope(full: FullOrderConstants, disturbed: DisturbedConstants) -> arb:
    """Bound the slope of S de/dt in xi under held torques [rad/s^3 per rad].

    Under exact linearisation the premise is about the jerk, and outputs add w^3 (xi_1 + xi_2).
    """
    slope = abs(arb(disturbed.growth_slope))
    return slope if disturbed.scheduled else slope + arb(2).sqrt() * arb(full.bandwidth) ** 3


def most_push(full: FullOrderConstants, disturbed: DisturbedConstants) -> arb:
    """Bound what |S e| does to sqrt(V) in the mean over a hold, anywhere in the set.

    What other robots' links add to the rate of sqrt(V) is in it, in the unit of |S e|.
    """
    most = arb(disturbed.push[0]) + arb(disturbed.push[1]) * arb(full.radius)
    most += output_drift(disturbed).at(most_error(full, disturbed), arb(full.radius)) / factor(full)
    if not disturbed.free_clock:
        return most
    # From an impact to the next tick sqrt(V) may be below its bound by b hold (mean kick).
    return most.max(decay(full, disturbed) * arb(disturbed.hold) * mean_kick(full, disturbed) / 2)


def _slower(full: FullOrderConstants, disturbed: DisturbedConstants) -> arb:
    """Return gamma less the part that pushes growing with V take: gamma' of inequality 1 [1/s]."""
    return decay(full, disturbed) - 2 * factor(full) * arb(disturbed.push[1])


def _not_above(claim: str, left: float, right: float) -> Inequality:
    """Return left <= right, of doubles, as an inequality."""
    if left <= right:
        return Inequality(claim, arb(0), arb(1))
    return Inequality(claim, arb(left), arb(right))


def _barrier_inequalities(
    full: FullOrderConstants, disturbed: DisturbedConstants, k: int, of: BarrierConstants
) -> list[Inequality]:
    """Return the inequality of one barrier.

    With q = 2 sigma b (most push), it uses (c + q)^2 <= (1 + r) c^2 + (1 + 1/r) q^2 for every r >
    0.
    """
    name, alpha, weight, lost = astuple(disturbed.barriers[k])
    # Inequality 2 of docs/level5.md; `spare` is its r_i.
    zero, gamma, gain = arb(0), decay(full, disturbed), arb(alpha)
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
    moved = 2 * arb(of.sigma) * factor(full) * most_push(full, disturbed)
    needed = gain * tightening(of) + (1 + 1 / spare) * moved**2 / rest
    needed += kicked_barrier(disturbed, k)
    claim = f"{name}: alpha t and what the push takes < lost"
    return [*first, split, Inequality(claim, needed, arb(lost))]


def factor(full: FullOrderConstants) -> arb:
    """Return the b of V' <= -gamma V + 2 b sqrt(V) |S e| [s]."""
    stiff = arb(fmpq(STIFF.numerator, STIFF.denominator))
    return (1 + stiff**2).sqrt() / arb(full.bandwidth)


def rest(disturbed: DisturbedConstants) -> arb:
    """Bound |S e| of the law's own torque at eta = 0 [rad/s^2]."""
    return abs(arb(disturbed.rest)) if disturbed.scheduled else arb(0)


def decay(full: FullOrderConstants, disturbed: DisturbedConstants) -> arb:
    """Return gamma, the rate at which V falls at least without errors [1/s]."""
    if disturbed.scheduled:
        return arb(disturbed.decay)
    rate = lyapunov_rate(full.bandwidth)
    return arb(fmpq(rate.numerator, rate.denominator))
