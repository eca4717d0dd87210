"""From the constants of the full-order theorem to its verdict, in balls (level 4).

Every inequality is between numbers of `FullOrder`, whose meaning the premises prove. It holds
only if it is certain; where one does not, it is the obstacle, and by how much is said. The
argument is in docs/full_order.md. Needs no JAX.
"""

import math
from dataclasses import replace
from typing import NamedTuple

from flint import arb, fmpq

from neuralgaits.certificate.levels.full_order.theorem import (
    FENCES,
    STIFF,
    BarrierConstants,
    FullOrder,
    decays,
    joints_of,
    lyapunov_rate,
    premises,
    weighting,
)
from neuralgaits.certificate.levels.premises import Bounds, above, below
from neuralgaits.records.certified import Conclusion, Constant

LEVEL = 4
_LEAST, _MOST = ("gamma", "radius", "epsilon", "most sigma"), ("step factor", "r_end", "t")
"""Constants that are bounds from below and from above, where their meaning does not say it."""
SHOWN = 4
"""Premises that are named where more of them are not proved."""


class Inequality(NamedTuple):
    """left < right is needed."""

    claim: str
    left: arb
    right: arb

    @property
    def holds(self) -> bool:
        """Whether it is certain."""
        return bool(self.left < self.right)


def conclude_full_order(shape: FullOrder, bounds: Bounds) -> Conclusion:
    """Level 4: D is forward invariant, between impacts and across them.

    Args:
        shape: the set and its constants.
        bounds: what is proved, see `conclusions.proved_bounds`.
    """
    known = tuple(constants(shape, bounds))
    figures = {constant.name: constant.value for constant in known}
    broken = [step for step in inequalities(shape) if not step.holds]
    missing = _missing(shape, bounds)
    reasons = [obstacle(step) for step in broken] + missing
    names = [barrier.name for barrier in shape.barriers]
    if names[:2] != list(FENCES) or len(set(names)) < len(names):
        reasons.insert(0, f"barriers {names}: two fences, then barriers of other names, are needed")
    if not decays(shape.bandwidth):
        reasons.insert(0, "A^T P + P A <= -gamma P does not hold")
    if not is_norm(shape):
        reasons.insert(0, "weights that are no upper triangle without zeros on its diagonal")
    if reasons:
        return Conclusion(LEVEL, "undecided", "; ".join(reasons), (), figures, known)
    return Conclusion(LEVEL, "proved", None, _words(shape), figures, known)


def inequalities(shape: FullOrder) -> list[Inequality]:
    """Everything that the constants must satisfy."""
    gamma, zero = _gamma(shape), arb(0)
    least, most = map(arb, shape.pace)
    # The edges that the boxes have: 1 + g, 1 - g and 1 -+ e, each rounded to a double.
    last, before = arb(shape.ends[1]), arb(shape.guard_from)
    shrink, radius = arb(shape.shrink), arb(shape.radius)
    kept, at_guard = bound_at(shape, arb(shape.start_strip)), bound_at(shape, before)
    landing = arb(shape.landing) + _size(shape.landing_slope) * arb(shape.guard_radius)
    found = [
        Inequality("the phase moves on: 0 < its least rate", zero, least),
        Inequality("the dynamics have a denominator: 0 < inertia", zero, arb(shape.inertia)),
        Inequality("0 < radius", zero, radius),
        Inequality("0 < start_strip", zero, arb(shape.start_strip)),
        Inequality("start_strip < 0.05", arb(shape.start_strip), arb("0.05")),
        Inequality("guard_strip < 0.05", arb(shape.guard_strip), arb("0.05")),
        Inequality("0 < crossing", zero, arb(shape.crossing)),
        Inequality("1 - guard_strip < 1 - crossing", before, arb(shape.crossings[0])),
        Inequality("1 + crossing < 1 + guard_strip", arb(shape.crossings[1]), last),
        Inequality("0 < risen", zero, arb(shape.risen)),
        Inequality("risen < 1 - guard_strip", arb(shape.risen), before),
        Inequality("the bound on sqrt(V) is largest at phase 0: 0 < shrink", zero, shrink),
        Inequality(
            "V decays faster than its bound shrinks: 4 shrink (1 + guard_strip) most pace < gamma",
            4 * shrink * last * most,
            gamma,
        ),
        Inequality("the bound at the guard < guard_radius", at_guard, arb(shape.guard_radius)),
        Inequality(
            "an impact lands in the tube: |phase+| < start_strip", landing, arb(shape.start_strip)
        ),
        Inequality(
            "outputs after an impact are in the set: sqrt(V+) < radius", _after(shape), kept
        ),
    ]
    if shape.least_radius != 0.0:
        floor = arb(shape.least_radius)
        found += [
            Inequality("0 < floor", zero, floor),
            Inequality("floor < radius", floor, radius),
        ]
    for barrier in shape.barriers:
        found += _of_barrier(shape, barrier, gamma)
    return found


def is_norm(shape: FullOrder) -> bool:
    """Whether S of V = |S dy/w|^2 + ... is an upper triangular matrix with an inverse."""
    joints = joints_of(shape.weights)
    if joints is None:
        return False
    matrix = weighting(shape.weights, joints)
    return all(math.isfinite(w) for w in shape.weights) and all(
        matrix[i][i] != 0.0 for i in range(joints)
    )


def bound_at(shape: FullOrder, phase: arb) -> arb:
    """Bound on sqrt(V) in D at a phase."""
    floor = arb(shape.least_radius)
    return floor + (arb(shape.radius) - floor) * (-arb(shape.shrink) * phase**2).exp()


def _of_barrier(shape: FullOrder, barrier: BarrierConstants, gamma: arb) -> list[Inequality]:
    name, zero = barrier.name, arb(0)
    alpha, sigma = arb(barrier.alpha), arb(barrier.sigma)
    if not sigma > 0:
        return [
            Inequality(f"{name}: 0 < epsilon", zero, arb(barrier.epsilon)),
            Inequality(f"{name}: 0 < sigma", zero, sigma),
        ]
    tightened = tightening(barrier)
    lost = arb(barrier.coupling) ** 2 / (4 * sigma * (gamma - alpha))
    return [
        Inequality(f"{name}: 0 < alpha", zero, alpha),
        Inequality(f"{name}: alpha < gamma", alpha, gamma),
        Inequality(
            f"{name}: between impacts, c_P^2/(4 sigma (gamma - alpha)) + alpha t < epsilon",
            lost + alpha * tightened,
            arb(barrier.epsilon),
        ),
        Inequality(
            f"{name}: across impacts, sigma V+ < h(z+) - t",
            sigma * _after(shape) ** 2,
            inlet(shape, barrier),
        ),
    ]


def tightening(barrier: BarrierConstants) -> arb:
    """The t = l_P^2 / (4 sigma) for which h >= t + sigma V keeps what the robot reads positive."""
    return arb(barrier.reading) ** 2 / (4 * arb(barrier.sigma))


def inlet(shape: FullOrder, barrier: BarrierConstants) -> arb:
    """What h - t is at least after any impact of the set."""
    moved = _size(barrier.reset_slope) * arb(shape.guard_radius)
    return arb(barrier.reset) - moved - tightening(barrier)


def constants(shape: FullOrder, bounds: Bounds | None = None) -> list[Constant]:
    """Every constant of the theorem, and what was proved of contact, torques and foot in D."""
    w, rate = shape.bandwidth, float(lyapunov_rate(shape.bandwidth))
    after = above(_after(shape))
    found = [
        Constant("w", w, "rad/s", "double pole of the outputs, critically damped"),
        Constant("P stiffness", float(STIFF) ** 2, "1", "V = sum (dy/w)^2 + this (y + dy/w)^2"),
        Constant("gamma", rate, "1/s", "V' <= -gamma V"),
        Constant("radius", shape.radius, "rad", "sqrt(V) in the set, at the start of a step"),
        Constant("shrink", shape.shrink, "1", f"at later phases: {_bound_in_words()}"),
        Constant("least radius", shape.least_radius, "rad", "what the bound on sqrt(V) shrinks to"),
        Constant("guard radius", shape.guard_radius, "rad", "sqrt(V) before an impact, at most"),
        Constant("least pace", shape.pace[0], "1/s", "rate of the phase, at least"),
        Constant("most pace", shape.pace[1], "1/s", "rate of the phase, at most"),
        Constant("T_min", below(_least_time(shape)), "s", "time of a step, at least"),
        Constant("inertia", shape.inertia, "kg m", "-J.s, at least"),
        Constant("sqrt v_sym", above(mismatch(shape)), "rad", "sqrt(V+) after eta = 0, at most"),
        Constant("L_D", shape.gain, "1", "growth of sqrt(V) across an impact, at most"),
        Constant("r_bar", after, "rad", "sqrt(V+) after any impact of the set, at most"),
        Constant("step factor", above(step_factor(shape)), "1", "L_D exp(-gamma T_min / 2)"),
        Constant("r_end", above(_end(shape)), "rad", "what sqrt(V+) falls to, step by step"),
        Constant("L_z", shape.landing_slope, "1/rad", "d phase+ / d sqrt(V), at most"),
        Constant("start strip", shape.start_strip, "phase", "the set begins so far before phase 0"),
        Constant("guard strip", shape.guard_strip, "phase", "the guard is met so near to phase 1"),
        Constant("foot rises", shape.risen, "phase", "until here it rises; then it is up"),
    ]
    for barrier in shape.barriers:
        found += _constants_of(shape, barrier, after)
    found += [] if bounds is None else _slacks(shape, bounds)
    return [_sided(constant) for constant in found]


def _sided(constant: Constant) -> Constant:
    """With the side on which it is a bound: as its meaning says, or its name."""
    if constant.meaning.endswith("at least"):
        return replace(constant, side="least")
    if constant.meaning.endswith("at most"):
        return replace(constant, side="most")
    name = constant.name.rpartition(": ")[2]
    if name in _LEAST:
        return replace(constant, side="least")
    return replace(constant, side="most") if name in _MOST else constant


def _slacks(shape: FullOrder, bounds: Bounds) -> list[Constant]:
    """Bounds proved of premises that are inequalities of the robot, everywhere in D."""
    named = {
        "full/contact": ("contact slack", "weights", "normal force, both sides of the cone"),
        "full/torque": ("torque slack", "limits", "to both limits of each joint"),
        "full/foot-rises": ("foot lift", "m/s", "the foot rises by at least this at first"),
        "full/foot-above": ("foot clearance", "m", "then it is up by this until the guard's strip"),
        "full/foot-falls": ("foot fall", "m/s", "and falls by at least this in the strip"),
        "full/impulse": ("impulse slack", "N s", "normal impulse, both sides of the cone"),
    }
    return [
        Constant(name, bounds[output, low, high], unit, f"{meaning}, at least")
        for output, low, high, _ in premises(shape)
        if (output, low, high) in bounds and output in named
        for name, unit, meaning in [named[output]]
    ]


def _constants_of(shape: FullOrder, barrier: BarrierConstants, after: float) -> list[Constant]:
    name, unit = barrier.name, "1" if barrier.reading == 0.0 else "rad"
    least = above(arb(barrier.epsilon)) if barrier.sigma <= 0.0 else barrier.epsilon
    found = [
        Constant(f"{name}: alpha", barrier.alpha, "1/s", "h' + alpha h >= epsilon at eta = 0"),
        Constant(f"{name}: epsilon", least, f"{unit}/s", "h' + alpha h >= epsilon at eta = 0"),
        Constant(f"{name}: c_P", barrier.coupling, f"{unit}/(s rad)", "|d h'/d sqrt(V)|, at most"),
        Constant(f"{name}: sigma", barrier.sigma, f"{unit}/rad^2", "the set has h - t >= sigma V"),
        Constant(f"{name}: l_P", barrier.reading, f"{unit}/rad", "|d h/d sqrt(V)| on the robot"),
        Constant(f"{name}: h(z+)", barrier.reset, unit, "after an impact from eta = 0, at least"),
        Constant(f"{name}: L_h", barrier.reset_slope, f"{unit}/rad", "d h(z+)/d sqrt(V), at most"),
    ]
    if barrier.sigma > 0.0 and after > 0.0:
        room = below(inlet(shape, barrier) / arb(after) ** 2)
        # Exactly nothing where outputs do not move it.
        tightened = above(tightening(barrier)) if barrier.reading != 0.0 else 0.0
        found += [
            Constant(f"{name}: t", tightened, unit, "tightening, l_P^2/(4 sigma)"),
            Constant(
                f"{name}: most sigma", room, f"{unit}/rad^2", "what the inlet leaves room for"
            ),
        ]
    return found


def _gamma(shape: FullOrder) -> arb:
    rate = lyapunov_rate(shape.bandwidth)
    return arb(fmpq(rate.numerator, rate.denominator))


def _after(shape: FullOrder) -> arb:
    """Bound on sqrt(V) after any impact of the set."""
    return mismatch(shape) + _size(shape.gain) * arb(shape.guard_radius)


def mismatch(shape: FullOrder) -> arb:
    """sqrt(v_sym): bound on sqrt(V) after an impact from eta = 0."""
    near, far = map(arb, shape.crossings)
    return _size(shape.mismatch) + _size(shape.drift) * (1 - near).max(far - 1)


def _size(bound: float) -> arb:
    """A constant of which the premises speak by its square: its sign is free there."""
    return abs(arb(bound))


def _least_time(shape: FullOrder) -> arb:
    """Of a step: from the end of the start's strip to the beginning of the guard's [s]."""
    return (arb(shape.guard_from) - arb(shape.start_strip)) / arb(shape.pace[1])


def step_factor(shape: FullOrder) -> arb:
    """sqrt(V) after an impact is at most this times its value after the last one, and v_sym."""
    return _size(shape.gain) * (-_gamma(shape) * _least_time(shape) / 2).exp()


def _end(shape: FullOrder) -> arb:
    """Limit of r+ = sqrt(v_sym) + factor r, and never more than after any one impact."""
    factor = step_factor(shape)
    limit = mismatch(shape) / (1 - factor)
    return limit if factor < 1 and limit < _after(shape) else _after(shape)


def obstacle(step: Inequality) -> str:
    """An inequality that does not hold, with both of its sides."""
    left, right = (value.str(4, radius=False) for value in (step.left, step.right))
    return f"{step.claim}: {left} against {right}"


def _missing(shape: FullOrder, bounds: Bounds) -> list[str]:
    """Premises without a sufficient bound, in words."""
    found = []
    for output, low, high, sign in premises(shape):
        bound = bounds.get((output, low, high), float("nan"))
        if not (bound > 0.0 if sign == "positive" else bound >= 0.0):
            found.append(f"{output} from {low} to {high} is not proved")
    if len(found) > SHOWN:
        found[SHOWN:] = [f"and {len(found) - SHOWN} more premises"]
    return found


def _words(shape: FullOrder) -> tuple[str, ...]:
    first, last = shape.ends
    names = [barrier.name for barrier in shape.barriers]
    steps = "; ".join(f"{_tightened(b)} >= {b.sigma!r} V" for b in shape.barriers)
    square = float(STIFF) ** 2
    return (
        f"D is every full state with z2 > 0, phase from {first!r} to {last!r}, swing foot on or "
        f"above the ground, sqrt(V) <= {_bound_in_words(shape)}, and {steps}; V is the sum of "
        f"(dy/w)^2 + {square:g} (y + dy/w)^2 over {_outputs_in_words(shape)}, "
        f"w = {shape.bandwidth!r} rad/s",
        "under exact input-output linearisation, ddy = -w^2 y - 2 w dy, in continuous time, every "
        "trajectory that starts in D stays in D between impacts, meets the ground once and "
        "transversally in each step, and is in D after the impact: it walks for ever",
        f"all along, {', '.join(names)} are not negative on the robot itself, outputs included; "
        "the contact force stays in the friction cone, so does every impulse, and torques stay "
        "within the robot's limits",
    )


def _bound_in_words(shape: FullOrder | None = None) -> str:
    """The bound on sqrt(V) along the phase."""
    if shape is None:
        return "floor + (radius - floor) exp(-shrink phase^2)"
    radius, shrink, floor = shape.radius, shape.shrink, shape.least_radius
    if floor == 0.0:
        return f"{radius!r} exp(-{shrink!r} phase^2)"
    return f"{floor!r} + ({radius!r} - {floor!r}) exp(-{shrink!r} phase^2)"


def _outputs_in_words(shape: FullOrder) -> str:
    if not shape.weights:
        return "the outputs"
    rows = weighting(shape.weights, joints_of(shape.weights) or 0)
    return f"the elements of S times the outputs, S = {rows!r}"


def _tightened(barrier: BarrierConstants) -> str:
    if barrier.reading == 0.0:
        return barrier.name
    return f"{barrier.name} - {barrier.reading!r}^2/(4 * {barrier.sigma!r})"
