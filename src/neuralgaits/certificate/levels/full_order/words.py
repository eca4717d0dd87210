"""Describe the set at full order in words, and its constants with units (level 4). Needs no JAX."""

from dataclasses import replace

from flint import arb

from neuralgaits.certificate.levels.full_order.inequalities import (
    after_impact,
    inlet,
    least_time,
    mismatch,
    r_end,
    step_factor,
    tightening,
)
from neuralgaits.certificate.levels.full_order.theorem import (
    STIFF,
    BarrierConstants,
    FullOrderConstants,
    joints_of,
    lyapunov_rate,
    premises,
    weighting,
)
from neuralgaits.certificate.premises import Bounds, above, below
from neuralgaits.records.certified import TheoremConstant


def constant_rows(
    constants: FullOrderConstants, bounds: Bounds | None = None
) -> list[TheoremConstant]:
    """Return every constant of the theorem, and proved bounds on contact, torques and foot in D."""
    w, rate = constants.bandwidth, float(lyapunov_rate(constants.bandwidth))
    after = above(after_impact(constants))
    rows = [
        TheoremConstant("w", w, "rad/s", "double pole of the outputs, critically damped"),
        TheoremConstant(
            "P stiffness", float(STIFF) ** 2, "1", "V = sum (dy/w)^2 + this (y + dy/w)^2"
        ),
        TheoremConstant("gamma", rate, "1/s", "V' <= -gamma V"),
        TheoremConstant(
            "radius", constants.radius, "rad", "sqrt(V) in the set, at the start of a step"
        ),
        TheoremConstant("shrink", constants.shrink, "1", f"at later phases: {_bound_in_words()}"),
        TheoremConstant(
            "least radius", constants.least_radius, "rad", "what the bound on sqrt(V) shrinks to"
        ),
        TheoremConstant(
            "guard radius", constants.guard_radius, "rad", "sqrt(V) before an impact, at most"
        ),
        TheoremConstant("least pace", constants.pace[0], "1/s", "rate of the phase, at least"),
        TheoremConstant("most pace", constants.pace[1], "1/s", "rate of the phase, at most"),
        TheoremConstant("T_min", below(least_time(constants)), "s", "time of a step, at least"),
        TheoremConstant("inertia", constants.inertia, "kg m", "-J.s, at least"),
        TheoremConstant(
            "sqrt v_sym", above(mismatch(constants)), "rad", "sqrt(V+) after eta = 0, at most"
        ),
        TheoremConstant("L_D", constants.gain, "1", "growth of sqrt(V) across an impact, at most"),
        TheoremConstant("r_bar", after, "rad", "sqrt(V+) after any impact of the set, at most"),
        TheoremConstant(
            "step factor", above(step_factor(constants)), "1", "L_D exp(-gamma T_min / 2)"
        ),
        TheoremConstant(
            "r_end", above(r_end(constants)), "rad", "what sqrt(V+) falls to, step by step"
        ),
        TheoremConstant("L_z", constants.landing_slope, "1/rad", "d phase+ / d sqrt(V), at most"),
        TheoremConstant(
            "start strip", constants.start_strip, "phase", "the set begins so far before phase 0"
        ),
        TheoremConstant(
            "guard strip", constants.guard_strip, "phase", "the guard is met so near to phase 1"
        ),
        TheoremConstant(
            "foot rises", constants.risen, "phase", "until here it rises; then it is up"
        ),
    ]
    for barrier in constants.barriers:
        rows += _constants_of(constants, barrier, after)
    rows += [] if bounds is None else _slacks(constants, bounds)
    return [_sided(constant) for constant in rows]


def _sided(constant: TheoremConstant) -> TheoremConstant:
    """Add the side on which a constant is a bound, from its meaning or its name."""
    if constant.meaning.endswith("at least"):
        return replace(constant, side="least")
    if constant.meaning.endswith("at most"):
        return replace(constant, side="most")
    name = constant.name.rpartition(": ")[2]
    if name in ("gamma", "radius", "epsilon", "most sigma"):
        return replace(constant, side="least")
    if name in ("step factor", "r_end", "t"):
        return replace(constant, side="most")
    return constant


def _slacks(constants: FullOrderConstants, bounds: Bounds) -> list[TheoremConstant]:
    """Return proved bounds of the premises that are inequalities of the robot, everywhere in D."""
    named = {
        "full/contact": ("contact slack", "weights", "normal force, both sides of the cone"),
        "full/torque": ("torque slack", "limits", "to both limits of each joint"),
        "full/foot-rises": ("foot lift", "m/s", "the foot rises by at least this at first"),
        "full/foot-above": ("foot clearance", "m", "then it is up by this until the guard's strip"),
        "full/foot-falls": ("foot fall", "m/s", "and falls by at least this in the strip"),
        "full/impulse": ("impulse slack", "N s", "normal impulse, both sides of the cone"),
    }
    return [
        TheoremConstant(name, bounds[output, low, high], unit, f"{meaning}, at least")
        for output, low, high, _ in premises(constants)
        if (output, low, high) in bounds and output in named
        for name, unit, meaning in [named[output]]
    ]


def _constants_of(
    constants: FullOrderConstants, barrier: BarrierConstants, after: float
) -> list[TheoremConstant]:
    name, unit = barrier.name, "1" if barrier.reading == 0.0 else "rad"
    least = above(arb(barrier.epsilon)) if barrier.sigma <= 0.0 else barrier.epsilon
    rows = [
        TheoremConstant(
            f"{name}: alpha", barrier.alpha, "1/s", "h' + alpha h >= epsilon at eta = 0"
        ),
        TheoremConstant(
            f"{name}: epsilon", least, f"{unit}/s", "h' + alpha h >= epsilon at eta = 0"
        ),
        TheoremConstant(
            f"{name}: c_P", barrier.coupling, f"{unit}/(s rad)", "|d h'/d sqrt(V)|, at most"
        ),
        TheoremConstant(
            f"{name}: sigma", barrier.sigma, f"{unit}/rad^2", "the set has h - t >= sigma V"
        ),
        TheoremConstant(
            f"{name}: l_P", barrier.reading, f"{unit}/rad", "|d h/d sqrt(V)| on the robot"
        ),
        TheoremConstant(
            f"{name}: h(z+)", barrier.reset, unit, "after an impact from eta = 0, at least"
        ),
        TheoremConstant(
            f"{name}: L_h", barrier.reset_slope, f"{unit}/rad", "d h(z+)/d sqrt(V), at most"
        ),
    ]
    if barrier.sigma > 0.0 and after > 0.0:
        room = below(inlet(constants, barrier) / arb(after) ** 2)
        # Exactly nothing where outputs do not move it.
        tightened = above(tightening(barrier)) if barrier.reading != 0.0 else 0.0
        rows += [
            TheoremConstant(f"{name}: t", tightened, unit, "tightening, l_P^2/(4 sigma)"),
            TheoremConstant(
                f"{name}: most sigma", room, f"{unit}/rad^2", "what the inlet leaves room for"
            ),
        ]
    return rows


def in_words(constants: FullOrderConstants) -> tuple[str, ...]:
    """Return the theorem in sentences: the set, its invariance, and what holds in it."""
    first, last = constants.ends
    names = [barrier.name for barrier in constants.barriers]
    steps = "; ".join(f"{_tightened(b)} >= {b.sigma!r} V" for b in constants.barriers)
    square = float(STIFF) ** 2
    return (
        f"D is every full state with z2 > 0, phase from {first!r} to {last!r}, swing foot on or "
        f"above the ground, sqrt(V) <= {_bound_in_words(constants)}, and {steps}; V is the sum of "
        f"(dy/w)^2 + {square:g} (y + dy/w)^2 over {_outputs_in_words(constants)}, "
        f"w = {constants.bandwidth!r} rad/s",
        "under exact input-output linearisation, ddy = -w^2 y - 2 w dy, in continuous time, every "
        "trajectory that starts in D stays in D between impacts, meets the ground once and "
        "transversally in each step, and is in D after the impact: it walks for ever",
        f"all along, {', '.join(names)} are not negative on the robot itself, outputs included; "
        "the contact force stays in the friction cone, so does every impulse, and torques stay "
        "within the robot's limits",
    )


def _bound_in_words(constants: FullOrderConstants | None = None) -> str:
    """Describe the bound on sqrt(V) along the phase."""
    if constants is None:
        return "least radius + (radius - least radius) exp(-shrink phase^2)"
    radius, shrink, floor = constants.radius, constants.shrink, constants.least_radius
    if floor == 0.0:
        return f"{radius!r} exp(-{shrink!r} phase^2)"
    return f"{floor!r} + ({radius!r} - {floor!r}) exp(-{shrink!r} phase^2)"


def _outputs_in_words(constants: FullOrderConstants) -> str:
    if not constants.weights:
        return "the outputs"
    rows = weighting(constants.weights, joints_of(constants.weights) or 0)
    return f"the elements of S times the outputs, S = {rows!r}"


def _tightened(barrier: BarrierConstants) -> str:
    if barrier.reading == 0.0:
        return barrier.name
    return f"{barrier.name} - {barrier.reading!r}^2/(4 * {barrier.sigma!r})"
