"""Conclude level 5 from the constants of the disturbed theorem, in balls.

The argument is in docs/level5_proof.md. Needs no JAX.
"""

from flint import arb

from neuralgaits.certificate.levels.disturbed.model_inequalities import (
    most_error,
    output_drift,
    outputs_landed,
)
from neuralgaits.certificate.levels.disturbed.push_inequalities import (
    decay,
    error_rate,
    factor,
    first_kick,
    growth,
    inequalities,
    rest,
    sqrt_v_after_kick,
)
from neuralgaits.certificate.levels.disturbed.state_inequalities import sensed_error
from neuralgaits.certificate.levels.disturbed.theorem import DisturbedConstants, premises
from neuralgaits.certificate.levels.full_order.inequalities import mismatch, obstacle, step_factor
from neuralgaits.certificate.levels.full_order.theorem import (
    FullOrderConstants,
    joints_of,
    weighting,
)
from neuralgaits.certificate.premises import Bounds, above, below, first_missing
from neuralgaits.records.certified import Conclusion, TheoremConstant


def conclude_disturbed(
    full: FullOrderConstants, disturbed: DisturbedConstants, bounds: Bounds
) -> Conclusion:
    """Conclude that D is invariant under errors of the outputs' acceleration and held torques.

    Args:
        full: the set and its constants at level 4, which has to be proved.
        disturbed: constants that level 5 adds.
        bounds: proved bounds, see `premises.proved_bounds`.
    """
    rows = tuple(constant_rows(full, disturbed))
    figures = {constant.name: constant.value for constant in rows}
    reasons = [obstacle(step) for step in inequalities(full, disturbed) if not step.holds]
    if missing := first_missing(premises(full, disturbed), bounds):
        reasons.append(missing)
    if [b.name for b in disturbed.barriers] != [b.name for b in full.barriers]:
        reasons.insert(0, "its barriers are not those of level 4")
    if reasons:
        return Conclusion(5, "undecided", "; ".join(reasons), (), figures, rows)
    return Conclusion(5, "proved", None, _words(full, disturbed), figures, rows)


def constant_rows(full: FullOrderConstants, disturbed: DisturbedConstants) -> list[TheoremConstant]:
    """Return every constant that level 5 adds."""
    always, loop = _always(full, disturbed), step_factor(full, decay(full, disturbed))
    # Errors up to the push are borne where sqrt(V) is small, too.
    if disturbed.scheduled:
        kept = 2 * factor(full) * (always + rest(disturbed)) / decay(full, disturbed)
    else:
        kept = 2 * always / arb(full.bandwidth) ** 2
    rows = [
        TheoremConstant("push", below(always), "rad/s^2", "every e with |S e| up to this", "least"),
        TheoremConstant(
            "push of any joints", below(always / _size_of_norm(full)), "rad/s^2",
            "every e with |e| up to this has |S e| up to the push", "least",
        ),
        TheoremConstant(
            "b", above(factor(full)), "s", "V' <= -gamma V + 2 b sqrt(V) |S e|", "most",
        ),
    ]  # fmt: skip
    if disturbed.scheduled:
        words = "V' <= -decay V + 2 b sqrt(V) (rest + |S e|) under the law"
        rows.append(TheoremConstant("decay", disturbed.decay, "1/s", words, "least"))
        words = "|S e| of the law's own torque, nothing off"
        rows.append(TheoremConstant("rest", above(rest(disturbed)), "rad/s^2", words, "most"))
    if disturbed.hold != 0.0:
        rows += _hold_rows(full, disturbed)
    if disturbed.free_clock:
        rows += _kick_rows(full, disturbed)
    if disturbed.measured:
        rows += _state_rows(disturbed)
    if disturbed.of_other_robots:
        rows += _model_rows(full, disturbed)
    words = "under such e sqrt(V) falls to this between impacts"
    rows.append(TheoremConstant("kept", above(kept), "rad", words, "most"))
    if loop < 1:
        end = (mismatch(full) + abs(arb(full.gain)) * kept) / (1 - loop)
        words = "under such e what sqrt(V+) falls to, step by step"
        rows.append(TheoremConstant("r_end", above(end), "rad", words, "most"))
    for its in disturbed.barriers:
        rows.append(TheoremConstant(f"{its.name}: alpha", its.alpha, "1/s", "gain, disturbed"))
        rows.append(TheoremConstant(f"{its.name}: lost", its.lost, "h/s", "of dh/dt + alpha h"))
    return rows


def _hold_rows(full: FullOrderConstants, disturbed: DisturbedConstants) -> list[TheoremConstant]:
    still, slope = growth(full, disturbed)
    radius = arb(full.radius)
    last = (error_rate(full, disturbed) * arb(disturbed.hold)).exp()
    return [
        TheoremConstant("hold", disturbed.hold, "s", "torques may be held for this long", "least"),
        TheoremConstant(
            "error", disturbed.error, "rad/s^2", "|S e| up to this when they are set", "least",
        ),
        TheoremConstant(
            "peak", above(arb(disturbed.peak[0]) + arb(disturbed.peak[1]) * radius), "rad/s^2",
            "|S e| up to this leaves forces and torques", "most",
        ),
        TheoremConstant(
            "growth", above(last * (still + slope * radius)), "rad/s^3",
            "|S e| grows by no more while torques are held", "most",
        ),
        TheoremConstant(
            "jerk", abs(disturbed.jerk), "rad/s^3", "|S d3y| of held torques, nothing off",
        ),
        TheoremConstant(
            "growth slope" if disturbed.scheduled else "jerk slope",
            abs(disturbed.growth_slope), "rad/s^3/rad",
            "of S de/dt in xi" if disturbed.scheduled else "of S d3y in xi",
        ),
        TheoremConstant("jerk push", abs(disturbed.jerk_push), "1/s", "slope of S d3y in S e"),
    ]  # fmt: skip


def _kick_rows(full: FullOrderConstants, disturbed: DisturbedConstants) -> list[TheoremConstant]:
    return [
        TheoremConstant(
            "kick", above(first_kick(full, disturbed)), "rad/s^2",
            "|S e| right after an impact under the torque from before", "most",
        ),
        TheoremConstant(
            "kick peak", disturbed.kick_peak, "rad/s^2", "|S e| until the next tick", "most",
        ),
        TheoremConstant(
            "kicked", above(sqrt_v_after_kick(full, disturbed)), "rad",
            "sqrt(V) until then", "most",
        ),
        TheoremConstant("kick end", disturbed.kick_end, "phase", "phase until then", "most"),
    ]  # fmt: skip


def _state_rows(disturbed: DisturbedConstants) -> list[TheoremConstant]:
    angle, rate = disturbed.state_error
    return [
        TheoremConstant("angle error", angle, "rad", "of each measured angle", "least"),
        TheoremConstant("rate error", rate, "rad/s", "of each measured rate", "least"),
        TheoremConstant(
            "sensed error", above(sensed_error(disturbed)), "rad/s^2",
            "|S e| of torques of such states when they are set", "most",
        ),
    ]  # fmt: skip


def _model_rows(full: FullOrderConstants, disturbed: DisturbedConstants) -> list[TheoremConstant]:
    mass, com, inertia = disturbed.model_box
    drift = output_drift(disturbed).at(most_error(full, disturbed), arb(full.radius))
    return [
        TheoremConstant("mass error", mass, "1", "of each type of link, a share", "least"),
        TheoremConstant("centre error", com, "m", "along a link and across it, each", "least"),
        TheoremConstant("inertia error", inertia, "1", "of each type of link, a share", "least"),
        TheoremConstant(
            "drift", above(drift), "rad/s", "of sqrt(V), by links that are not the file's", "most",
        ),
        TheoremConstant(
            "landed", above(outputs_landed(full, disturbed)), "rad",
            "of sqrt(V) in an impact, by such links", "most",
        ),
    ]  # fmt: skip


def _always(full: FullOrderConstants, disturbed: DisturbedConstants) -> arb:
    """Return the |S e| up to which any error is tolerated anywhere in the set."""
    least, (still, slope) = arb(full.least_radius), map(arb, disturbed.push)
    if disturbed.scheduled:
        return still + slope * least - rest(disturbed)
    # What barriers, forces and the least radius allow: docs/level5_proof.md.
    of_barriers = still + slope * arb(full.radius)
    of_forces = arb(disturbed.peak[0]) + arb(disturbed.peak[1]) * least
    of_radius = arb("0.4999995") * arb(full.bandwidth) ** 2 * least
    return of_barriers.min(of_forces).min(of_radius)


def _size_of_norm(full: FullOrderConstants) -> arb:
    """Return the Frobenius norm of S, which bounds its largest singular value."""
    if not full.weights:
        return arb(1)
    return sum((arb(w) ** 2 for w in full.weights), arb(0)).sqrt()


def _law_in_words(disturbed: DisturbedConstants) -> str:
    """Describe the torques whose error is e."""
    if not disturbed.scheduled:
        return "torques that give the outputs ddy = -w^2 y - 2 w dy + e"
    return (
        "torques that give the outputs e more of ddy than u = u0 - M (w^2 y + 2 w dy) does, the "
        "torque of scheduled PD, u0 and M being the file's polynomials of phase and level"
    )


def _about_touchdowns(disturbed: DisturbedConstants) -> str:
    if not disturbed.free_clock:
        return "one of them at each touchdown"
    return (
        "wherever touchdowns lie between them (each motor keeps its torque through a touchdown, "
        "until the first tick after it, which is of the new step)"
    )


def _words(full: FullOrderConstants, disturbed: DisturbedConstants) -> tuple[str, ...]:
    size = short = "|e|"
    own = " beyond that law" if disturbed.scheduled else ""
    if full.weights:
        short = "|S e|"
        size = f"|S e|, S = {weighting(full.weights, joints_of(full.weights) or 0)!r},"
    most = below(_always(full, disturbed))
    of_file = " on the file's robot" if disturbed.of_other_robots else ""
    sentences = [
        f"the same set D{of_file}, whatever measurable e(t) with {size} <= {most!r} "
        f"rad/s^2 is added: under {_law_in_words(disturbed)}, every "
        "trajectory that starts in D stays in D between impacts, meets the ground once and "
        "transversally in each step, and is in D after the impact: it walks for ever"
    ]
    if disturbed.hold != 0.0:
        sentences.append(
            f"the same set D{_on_robots(disturbed)}, whatever ticks there are at most "
            f"{disturbed.hold!r} s apart, {_about_touchdowns(disturbed)}: if torques are set at "
            f"each tick with {short} <= {disturbed.error!r} rad/s^2{own} and held until the next, "
            "every trajectory that starts in D at a tick stays in D, meets the ground once and "
            "transversally in each step, and is in D after the impact: it walks for ever"
        )
    if disturbed.measured:
        sentences.append(_of_measured_states(disturbed, short))
    known = disturbed.measured, disturbed.of_other_robots
    causes = {
        (False, False): "a wrong model or a measurement",
        (True, False): "a wrong model",
        (False, True): "any other wrong model or a measurement",
        (True, True): "any other wrong model",
    }[known]
    return (
        *sentences,
        f"all along, the barrier functions {_read(disturbed)}, the contact force "
        "and every impulse stay in the friction cone, and the torques that are applied stay within "
        "the robot's limits: none saturates",
        f"which e {causes} makes is not part of this theorem",
    )


def _read(disturbed: DisturbedConstants) -> str:
    """State on which robot barrier functions are not negative."""
    if disturbed.of_other_robots:
        return "are not negative as read with the file's model"
    return "are not negative on the robot itself"


def _on_robots(disturbed: DisturbedConstants) -> str:
    """State on which robots torques may be held."""
    if not disturbed.of_other_robots:
        return ""
    mass, com, inertia = disturbed.model_box
    return (
        " on every robot whose types of link have masses off by a share of at most "
        f"{mass!r}, centres of mass by at most {com!r} m along the link and across it, and "
        f"inertias by a share of at most {inertia!r}, both legs alike, while state and torques are "
        "computed with the file's model"
    )


def _of_measured_states(disturbed: DisturbedConstants, short: str) -> str:
    """State which torques of measured states are among those of the theorem."""
    angle, rate = disturbed.state_error
    return (
        "torques of exact linearisation that are computed from a measured state, with each joint "
        f"angle and the pitch off by at most {angle!r} rad and each of their rates by at most "
        f"{rate!r} rad/s, have {short} <= {above(sensed_error(disturbed))!r} rad/s^2 when they are "
        "set; which foot stands is known"
    )
