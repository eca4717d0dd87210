"""Find constants of the disturbed theorem by evaluating points. Nothing here is trusted."""

from dataclasses import replace

import numpy as np

from neuralgaits._digits import at_least
from neuralgaits.certificate.level_target import USUAL_CONTROL, ControlAssumption, grid
from neuralgaits.certificate.levels.disturbed.find_model import model_bounds
from neuralgaits.certificate.levels.disturbed.find_state import DIGITS, largest, state_bounds
from neuralgaits.certificate.levels.disturbed.hold_bounds import HoldBounds
from neuralgaits.certificate.levels.disturbed.push_inequalities import inequalities
from neuralgaits.certificate.levels.disturbed.theorem import DisturbedConstants
from neuralgaits.certificate.levels.full_order.held import Held
from neuralgaits.certificate.levels.full_order.inequalities import obstacle
from neuralgaits.certificate.levels.full_order.norm_plans import LONGEST
from neuralgaits.certificate.levels.full_order.samples import SampleEvaluators
from neuralgaits.certificate.levels.full_order.theorem import FullOrderConstants
from neuralgaits.gait.scheduled_gains import ScheduledGains


def find_disturbed(
    evaluators: SampleEvaluators,
    full: FullOrderConstants,
    control: ControlAssumption = USUAL_CONTROL,
    gains: ScheduledGains | None = None,
) -> DisturbedConstants | str:
    """Return the longest hold and the largest push that points allow in the set, or why none.

    Args:
        evaluators: functions that evaluate the gait, in the set's norm.
        full: the set.
        control: assumptions about the controller. Its error is apart from a measured state's.
        gains: gains of scheduled PD, if that is the law that the functions are of.
    """
    if full.least_radius <= 0.0:
        return (
            "the set of level 4 shrinks to nothing along the step, so that no disturbance leaves "
            "outputs inside it: no set with a least radius was found for this gait"
        )
    u = grid(np.linspace(*full.ends, 61), np.linspace(0.0, 1.0, 9))
    state = state_bounds(evaluators, full, u, control.state_error)
    model, free_clock = model_bounds(evaluators, full, u, control.model_box), control.free_clock
    sampled = HoldBounds(evaluators, full, u, free_clock, control.error + state.error, model)
    if not sampled.gamma > 0.0:
        return "under this law V is not shown to fall"
    hold = largest(LONGEST, lambda hold: sampled.stands(hold, sampled.held(hold)))
    hold = float(at_least(hold, DIGITS))
    if hold == 0.0 and (free_clock or state.error or model):
        return _no_hold(control, sampled.error)
    held = sampled.held(hold) if hold > 0.0 else Held((0.0, 0.0), (0.0, 0.0))
    # Any more that the floor bears; under exact linearisation a hold's mean does not decide it.
    more = 0.0 if sampled.exact and hold > 0.0 else sampled.most(held.push[1]) - held.push[0]
    extra = largest(more, lambda extra: sampled.stands(hold, _raised(held, extra)))
    raised = _raised(held, extra)
    kick = sampled.kicked(hold, raised)
    barriers = sampled.barriers(hold, raised, kick)
    if barriers is None or not extra + held.push[0] > 0.0:
        return "a barrier leaves no room for any disturbance"
    disturbed = sampled.constants(hold, raised, kick)
    disturbed = replace(disturbed, barriers=barriers, **state.constants)
    if free_clock:
        assert sampled.kick is not None
        disturbed = replace(
            disturbed,
            **dict(zip(("kick", "kick_slope", "kick_push"), sampled.kick, strict=True)),
            kick_peak=kick.peak,
            kick_end=sampled.end_of_kick(hold),
        )
    if gains is not None:
        disturbed = replace(_with_gains(disturbed, gains), decay=sampled.gamma, rest=sampled.rest)
    broken = [obstacle(step) for step in inequalities(full, disturbed) if not step.holds]
    return "; ".join(broken) if broken else disturbed


def _no_hold(control: ControlAssumption, error: float) -> str:
    """Explain why torques cannot be held at all in a set."""
    if control.model_box is not None:
        return (
            "what other robots' masses and centres of mass add between impacts and in them does "
            "not fit into the set: give a smaller --model-error, or another --bandwidth"
        )
    if control.free_clock:
        return "what a torque held through an impact adds to outputs does not fit into the set"
    return f"torques with |S e| = {error:.4g} rad/s^2 when they are set cannot be held in this set"


def _with_gains(disturbed: DisturbedConstants, gains: ScheduledGains) -> DisturbedConstants:
    """Return the constants with the polynomials of a law."""
    return replace(
        disturbed,
        torque_gains=tuple(np.ravel(gains.torque).tolist()),
        inertia_gains=tuple(np.ravel(gains.inertia).tolist()),
    )


def _raised(held: Held, extra: float) -> Held:
    """Return the constants with a larger push, and a peak that is not below it."""
    push = held.push[0] + extra
    return Held((push, held.push[1]), (max(push, held.peak[0]), held.peak[1]))
