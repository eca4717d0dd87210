"""Conclude level 5 from the constants of the disturbed theorem, in balls.

The argument is in docs/level5_proof.md. Needs no JAX.
"""

from flint import arb, fmpq

from neuralgaits.certificate.levels.disturbed.theorem import DisturbedConstants, premises
from neuralgaits.certificate.levels.full_order.inequalities import (
    Inequality,
    bound_at,
    mismatch,
    obstacle,
    step_factor,
    tightening,
)
from neuralgaits.certificate.levels.full_order.theorem import (
    STIFF,
    BarrierConstants,
    FullOrderConstants,
    joints_of,
    lyapunov_rate,
    weighting,
)
from neuralgaits.certificate.premises import Bounds, above, below, first_missing
from neuralgaits.records.certified import Conclusion, TheoremConstant

LEVEL = 5


def conclude_disturbed(
    full: FullOrderConstants, shape: DisturbedConstants, bounds: Bounds
) -> Conclusion:
    """Conclude that D is invariant under errors of the outputs' acceleration and held torques.

    Args:
        full: the set and its constants at level 4, which has to be proved.
        shape: constants that level 5 adds.
        bounds: proved bounds, see `premises.proved_bounds`.
    """
    known = tuple(constants(full, shape))
    figures = {constant.name: constant.value for constant in known}
    reasons = [obstacle(step) for step in inequalities(full, shape) if not step.holds]
    if missing := first_missing(premises(full, shape), bounds):
        reasons.append(missing)
    if [b.name for b in shape.barriers] != [b.name for b in full.barriers]:
        reasons.insert(0, "its barriers are not those of level 4")
    if reasons:
        return Conclusion(LEVEL, "undecided", "; ".join(reasons), (), figures, known)
    return Conclusion(LEVEL, "proved", None, _words(full, shape), figures, known)


def inequalities(full: FullOrderConstants, shape: DisturbedConstants) -> list[Inequality]:
    """Return every inequality that the constants must satisfy."""
    zero, gamma, push = arb(0), _rate(full), arb(shape.push[0])
    left = _slower(full, shape)
    # Inequality 1 of docs/level5.md.
    found = [
        Inequality("0 < push", zero, push),
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
    return found + (_of_hold(full, shape, gamma) if shape.hold != 0.0 else [])


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
            error + mean * still,
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
    w, peak = arb(full.bandwidth), arb(shape.peak[0]) + arb(shape.peak[1]) * arb(full.radius)
    still = abs(arb(shape.jerk)) + (2 * w + abs(arb(shape.jerk_push))) * peak
    # The bound on V was larger when the hold began, or at phase 0 if the phase is below.
    earlier = (_rate(full) * arb(shape.hold) / 2).exp() * arb(full.radius)
    earlier /= bound_at(full, arb(full.start_strip))
    return still, earlier * (arb(2).sqrt() * w**3 + abs(arb(shape.jerk_slope)))


def most_push(full: FullOrderConstants, shape: DisturbedConstants) -> arb:
    """Bound |S e| in the mean over a hold, anywhere in the set."""
    return arb(shape.push[0]) + arb(shape.push[1]) * arb(full.radius)


def _slower(full: FullOrderConstants, shape: DisturbedConstants) -> arb:
    """Return gamma less the part that pushes growing with V take: gamma' of inequality 1 [1/s]."""
    return _rate(full) - 2 * factor(full) * arb(shape.push[1])


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
    zero, gamma, gain = arb(0), _rate(full), arb(alpha)
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


def constants(full: FullOrderConstants, shape: DisturbedConstants) -> list[TheoremConstant]:
    """Return every constant that level 5 adds."""
    always, loop = _always(full, shape), step_factor(full)
    # Errors up to the push are borne where sqrt(V) is small, too.
    kept = 2 * factor(full) * always / _rate(full)
    found = [
        TheoremConstant("push", below(always), "rad/s^2", "every e with |S e| up to this", "least"),
        TheoremConstant(
            "push of any joints", below(always / _size_of_norm(full)), "rad/s^2",
            "every e with |e| up to this has |S e| up to the push", "least",
        ),
        TheoremConstant(
            "b", above(factor(full)), "s", "V' <= -gamma V + 2 b sqrt(V) |S e|", "most",
        ),
    ]  # fmt: skip
    if shape.hold != 0.0:
        found += _of_holds(full, shape)
    words = "under such e sqrt(V) falls to this between impacts"
    found.append(TheoremConstant("kept", above(kept), "rad", words, "most"))
    if loop < 1:
        end = (mismatch(full) + abs(arb(full.gain)) * kept) / (1 - loop)
        words = "under such e what sqrt(V+) falls to, step by step"
        found.append(TheoremConstant("r_end", above(end), "rad", words, "most"))
    for its in shape.barriers:
        found.append(TheoremConstant(f"{its.name}: alpha", its.alpha, "1/s", "gain, disturbed"))
        found.append(TheoremConstant(f"{its.name}: lost", its.lost, "h/s", "of dh/dt + alpha h"))
    return found


def _of_holds(full: FullOrderConstants, shape: DisturbedConstants) -> list[TheoremConstant]:
    still, slope = growth(full, shape)
    radius = arb(full.radius)
    return [
        TheoremConstant("hold", shape.hold, "s", "torques may be held for this long", "least"),
        TheoremConstant(
            "error", shape.error, "rad/s^2", "|S e| up to this when they are set", "least",
        ),
        TheoremConstant(
            "peak", above(arb(shape.peak[0]) + arb(shape.peak[1]) * radius), "rad/s^2",
            "|S e| up to this leaves forces and torques", "most",
        ),
        TheoremConstant(
            "growth", above(still + slope * radius), "rad/s^3",
            "|S e| grows by no more while torques are held", "most",
        ),
        TheoremConstant("jerk", abs(shape.jerk), "rad/s^3", "|S d3y| of held torques, nothing off"),
        TheoremConstant("jerk slope", abs(shape.jerk_slope), "rad/s^3/rad", "its slope in xi"),
        TheoremConstant("jerk push", abs(shape.jerk_push), "1/s", "its slope in S e"),
    ]  # fmt: skip


def _always(full: FullOrderConstants, shape: DisturbedConstants) -> arb:
    """Return the |S e| up to which any error is tolerated anywhere in the set."""
    return arb(shape.push[0]) + arb(shape.push[1]) * arb(full.least_radius)


def _size_of_norm(full: FullOrderConstants) -> arb:
    """Return the Frobenius norm of S, which bounds its largest singular value."""
    if not full.weights:
        return arb(1)
    return sum((arb(w) ** 2 for w in full.weights), arb(0)).sqrt()


def _rate(full: FullOrderConstants) -> arb:
    rate = lyapunov_rate(full.bandwidth)
    return arb(fmpq(rate.numerator, rate.denominator))


def _words(full: FullOrderConstants, shape: DisturbedConstants) -> tuple[str, ...]:
    size = short = "|e|"
    if full.weights:
        short = "|S e|"
        size = f"|S e|, S = {weighting(full.weights, joints_of(full.weights) or 0)!r},"
    found = [
        f"the same set D, whatever measurable e(t) with {size} <= {below(_always(full, shape))!r} "
        "rad/s^2 is added: under torques that give the outputs ddy = -w^2 y - 2 w dy + e, every "
        "trajectory that starts in D stays in D between impacts, meets the ground once and "
        "transversally in each step, and is in D after the impact: it walks for ever"
    ]
    if shape.hold != 0.0:
        found.append(
            "the same set D, whatever ticks there are at most "
            f"{shape.hold!r} s apart, one of them at each touchdown: if torques are set at each "
            f"tick with {short} <= {shape.error!r} rad/s^2 and held until the next, every "
            "trajectory that starts in D at a tick stays in D, meets the ground once and "
            "transversally in each step, and is in D after the impact: it walks for ever"
        )
    return (
        *found,
        "all along, the barrier functions are not negative on the robot itself, the contact force "
        "and every impulse stay in the friction cone, and the torques that are applied stay within "
        "the robot's limits: none saturates",
        "which e a wrong model or a measurement makes is not part of this theorem",
    )
