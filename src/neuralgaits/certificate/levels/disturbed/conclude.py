"""From the constants of the disturbed theorem to its verdict, in balls (level 5).

The argument is in docs/level5.md. Needs no JAX.
"""

from flint import arb, fmpq

from neuralgaits.certificate.levels.disturbed.theorem import Disturbed, premises
from neuralgaits.certificate.levels.full_order.inequalities import (
    Inequality,
    mismatch,
    obstacle,
    step_factor,
    tightening,
)
from neuralgaits.certificate.levels.full_order.theorem import (
    STIFF,
    BarrierConstants,
    FullOrder,
    joints_of,
    lyapunov_rate,
    weighting,
)
from neuralgaits.certificate.levels.premises import Bounds, above, below, first_missing
from neuralgaits.records.certified import Conclusion, Constant

LEVEL = 5


def conclude_disturbed(full: FullOrder, shape: Disturbed, bounds: Bounds) -> Conclusion:
    """Level 5: D is invariant whatever e with |S e| <= push is added to the outputs' acceleration.

    Args:
        full: the set and its constants, of level 4, which has to be proved.
        shape: what level 5 adds.
        bounds: what is proved, see `premises.proved_bounds`.
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


def inequalities(full: FullOrder, shape: Disturbed) -> list[Inequality]:
    """Everything that the constants must satisfy."""
    zero, gamma = arb(0), _rate(full)
    found = [
        Inequality("0 < push", zero, arb(shape.push)),
        Inequality(
            "the floor is above what the push keeps outputs at: 2 b push < gamma floor",
            2 * factor(full) * arb(shape.push),
            gamma * arb(full.least_radius),
        ),
    ]
    for its, of in zip(shape.barriers, full.barriers, strict=False):
        found += _of_barrier(full, shape, its.name, its.alpha, its.weight, its.lost, of)
    return found


def _of_barrier(
    full: FullOrder,
    shape: Disturbed,
    name: str,
    alpha: float,
    weight: float,
    lost: float,
    of: BarrierConstants,
) -> list[Inequality]:
    """With (c + q)^2 <= (1 + r) c^2 + (1 + 1/r) q^2 for every r > 0, q = 2 sigma b push."""
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
    moved = 2 * arb(of.sigma) * factor(full) * arb(shape.push)
    needed = gain * tightening(of) + (1 + 1 / spare) * moved**2 / rest
    claim = f"{name}: alpha t and what the push takes < lost"
    return [*first, split, Inequality(claim, needed, arb(lost))]


def factor(full: FullOrder) -> arb:
    """The b of V' <= -gamma V + 2 b sqrt(V) |S e| [s]."""
    stiff = arb(fmpq(STIFF.numerator, STIFF.denominator))
    return (1 + stiff**2).sqrt() / arb(full.bandwidth)


def constants(full: FullOrder, shape: Disturbed) -> list[Constant]:
    """Every constant that level 5 adds."""
    kept = 2 * factor(full) * arb(shape.push) / _rate(full)
    loop = step_factor(full)
    found = [
        Constant("push", shape.push, "rad/s^2", "every e with |S e| up to this", "least"),
        Constant(
            "push of any joints", below(_smallest_push(full, shape)), "rad/s^2",
            "every e with |e| up to this has |S e| up to the push", "least",
        ),
        Constant("b", above(factor(full)), "s", "V' <= -gamma V + 2 b sqrt(V) |S e|", "most"),
        Constant("kept", above(kept), "rad", "sqrt(V) falls to this between impacts", "most"),
    ]  # fmt: skip
    if loop < 1:
        end = (mismatch(full) + abs(arb(full.gain)) * kept) / (1 - loop)
        found.append(
            Constant("r_end", above(end), "rad", "what sqrt(V+) falls to, step by step", "most")
        )
    for its in shape.barriers:
        found.append(Constant(f"{its.name}: alpha", its.alpha, "1/s", "gain, disturbed"))
        found.append(Constant(f"{its.name}: lost", its.lost, "h/s", "of dh/dt + alpha h"))
    return found


def _smallest_push(full: FullOrder, shape: Disturbed) -> arb:
    """|e| for which |S e| <= push for sure: the Frobenius norm of S is not below its largest."""
    if not full.weights:
        return arb(shape.push)
    return arb(shape.push) / sum((arb(w) ** 2 for w in full.weights), arb(0)).sqrt()


def _rate(full: FullOrder) -> arb:
    rate = lyapunov_rate(full.bandwidth)
    return arb(fmpq(rate.numerator, rate.denominator))


def _words(full: FullOrder, shape: Disturbed) -> tuple[str, ...]:
    size = "|e|"
    if full.weights:
        size = f"|S e|, S = {weighting(full.weights, joints_of(full.weights) or 0)!r},"
    return (
        f"the same set D, whatever measurable e(t) with {size} <= {shape.push!r} rad/s^2 is added: "
        "under torques that give the outputs ddy = -w^2 y - 2 w dy + e, every trajectory that "
        "starts in D stays in D between impacts, meets the ground once and transversally in each "
        "step, and is in D after the impact: it walks for ever",
        "all along, the barrier functions are not negative on the robot itself, the contact force "
        "and every impulse stay in the friction cone, and the torques that are applied stay within "
        "the robot's limits: none saturates",
        "which e a held torque, a wrong model or a measurement makes is not part of this theorem",
    )
