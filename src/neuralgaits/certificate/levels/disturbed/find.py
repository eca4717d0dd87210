"""Find constants of the disturbed theorem by evaluating points. Nothing here is trusted."""

import math
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from flint import arb

from neuralgaits._digits import at_least, at_most
from neuralgaits.certificate.level_target import grid
from neuralgaits.certificate.levels.disturbed.find_state import DIGITS, largest, state_bounds
from neuralgaits.certificate.levels.disturbed.push_inequalities import factor, inequalities
from neuralgaits.certificate.levels.disturbed.radius_inequalities import face_inequalities
from neuralgaits.certificate.levels.disturbed.theorem import DisturbedBarrier, DisturbedConstants
from neuralgaits.certificate.levels.full_order.held import (
    Held,
    Jerk,
    Kick,
    feedback_slope,
    kick_bounds,
    least_decay,
    push_bound,
    rest_bound,
    slope_bound,
)
from neuralgaits.certificate.levels.full_order.inequalities import (
    after_impact,
    bound_at,
    inlet,
    obstacle,
)
from neuralgaits.certificate.levels.full_order.norm_plans import GAINS, LONGEST
from neuralgaits.certificate.levels.full_order.samples import SampleEvaluators
from neuralgaits.certificate.levels.full_order.theorem import FullOrderConstants, lyapunov_rate
from neuralgaits.gait.scheduled_gains import ScheduledGains

SHARE_BELOW = 1.0 - 1e-9
"""Share of a limit that a number which must lie below it may reach."""
SPENT = 0.05
"""Share of dh/dt + alpha h that bounds may lose, and by which outputs may take more of forces."""


def find_disturbed(
    evaluators: SampleEvaluators,
    full: FullOrderConstants,
    *,
    free_clock: bool = False,
    gains: ScheduledGains | None = None,
    error: float = 0.0,
    state_error: tuple[float, float] | None = None,
) -> DisturbedConstants | str:
    """Return the longest hold and the largest push that points allow in the set, or why none.

    Args:
        evaluators: functions that evaluate the gait, in the set's norm.
        full: the set.
        free_clock: whether ticks may miss touchdowns.
        gains: gains of scheduled PD, if that is the law that the functions are of.
        error: bound on |S e| of torques when they are set, apart from a measured state's
            [rad/s^2].
        state_error: bounds on errors of the angles and rates that torques are computed from
            (rad, rad/s).
    """
    if full.least_radius <= 0.0:
        return (
            "the set of level 4 shrinks to nothing along the step, so that no disturbance leaves "
            "outputs inside it: no set with a least radius was found for this gait"
        )
    u = grid(np.linspace(*full.ends, 61), np.linspace(0.0, 1.0, 9))
    state = state_bounds(evaluators, full, u, state_error)
    sampled = _SampledBounds(evaluators, full, u, free_clock, error + state.error)
    if not sampled.gamma > 0.0:
        return "under this law V is not shown to fall"
    hold = largest(LONGEST, lambda hold: sampled.stands(hold, sampled.held(hold)))
    hold = float(at_least(hold, DIGITS))
    if hold == 0.0 and (free_clock or state.error):
        return _no_hold(free_clock, sampled.error)
    held = sampled.held(hold) if hold > 0.0 else Held((0.0, 0.0), (0.0, 0.0))
    # Any more that the floor bears; under exact linearisation a hold's mean does not decide it.
    more = 0.0 if sampled.exact and hold > 0.0 else sampled.most(held.push[1]) - held.push[0]
    extra = largest(more, lambda extra: sampled.stands(hold, _raised(held, extra)))
    raised = _raised(held, extra)
    kick = sampled.kicked(hold, raised)
    barriers = sampled.barriers(hold, raised, kick)
    if barriers is None or not extra + held.push[0] > 0.0:
        return "a barrier leaves no room for any disturbance"
    disturbed = replace(sampled.constants(hold, raised), barriers=barriers, **state.constants)
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


def _no_hold(free_clock: bool, error: float) -> str:
    """Explain why torques cannot be held at all in a set."""
    if free_clock:
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


def _kick_bounds(evaluators: SampleEvaluators, full: FullOrderConstants) -> tuple[float, ...]:
    """Bound the error right after an impact under the torque from before, and its slopes."""
    assert evaluators.kick is not None
    strip = np.linspace(full.guard_from, full.ends[1], 5)
    at = grid(strip, np.linspace(0.0, 1.0, 9))
    values = evaluators.kick(at, np.zeros((len(at), evaluators.size)))
    bounds = kick_bounds(
        values["kick"], values["kick/slope"], values["kick/push"], full.guard_radius
    )
    return tuple(float(at_most(bound, DIGITS)) for bound in bounds)


class _Forces(NamedTuple):
    """Slacks of contact and torques, their loss to outputs, and their slopes in S e."""

    left: np.ndarray
    push: np.ndarray


class _SampledBounds:
    """Effect of pushes on barriers, contact and torques at points, and growth of held errors."""

    def __init__(
        self,
        evaluators: SampleEvaluators,
        full: FullOrderConstants,
        u: np.ndarray,
        free_clock: bool,
        error: float,
    ):
        self.error = error
        self.full, self.gamma = full, float(lyapunov_rate(full.bandwidth))
        self.factor = float(factor(full).upper())
        step = evaluators.step(u, np.zeros((len(u), evaluators.size)))
        self.rate, self.h = step["rate"], step["h"]
        # |d(dh/dt)/d xi|^2 in the set, as a multiple of the largest value seen at eta = 0.
        room_of_squares = 1.12
        self.squares = room_of_squares * (step["rate/slope"] ** 2).sum(axis=2)
        assert evaluators.pushed is not None
        off = evaluators.pushed(u)
        self.bound = full.least_radius + (full.radius - full.least_radius) * np.exp(
            -full.shrink * u[:, 0] ** 2
        )
        self.forces = []
        self.rest = 0.0
        if off["law/slope"].any():
            self.gamma = float(at_least(least_decay(off["law/slope"], full.bandwidth), DIGITS))
            # Polynomials err by waves, which a coarse grid misses.
            fine = grid(np.linspace(*full.ends, 161), np.linspace(0.0, 1.0, 17))
            own = evaluators.pushed(fine)["law"]
            # Largest error of fitted polynomials, as a multiple of the largest on a fine grid.
            room_of_fits = 1.2
            self.rest = float(at_most(rest_bound(room_of_fits * own), DIGITS))
        for name in ("contact", "torque"):
            slopes = step[f"{name}/slope"] + off[f"{name}/push"] @ off["law/slope"]
            slopes = np.linalg.norm(slopes, axis=2)
            left = step[name] - (1.0 + SPENT) * self.bound[:, None] * slopes
            self.forces.append(_Forces(left, np.linalg.norm(off[f"{name}/push"], axis=2)))

        def size(values: np.ndarray) -> float:
            return float(np.sqrt((values**2).reshape(len(u), -1).sum(axis=1).max()))

        self.exact = not off["law/slope"].any()
        # Jerk of the outputs at eta = 0, as a multiple of the largest value sampled.
        room_of_jerk = 1.03
        slope = slope_bound(off["jerk/slope"], full.bandwidth, exact=self.exact)
        self.jerk = Jerk(
            float(at_most(room_of_jerk * size(off["jerk"]), DIGITS)),
            float(at_most(slope, DIGITS)),
            float(at_most(push_bound(off["jerk/push"], off["law/slope"]), DIGITS)),
            feedback_slope(full.bandwidth) if self.exact else 0.0,
        )
        self.u, self.kick = u, _kick_bounds(evaluators, full) if free_clock else None

    def held(self, hold: float) -> Held:
        """Bound the errors of torques that are exact when set and then held, with room."""
        full = self.full
        start = full.least_radius + (full.radius - full.least_radius) * math.exp(
            -full.shrink * full.start_strip**2
        )
        pairs = self.jerk.held(hold, self.error, full.bandwidth, self.gamma, self.rest)
        # The proof takes the bound at the start's strip for the one at phase 0, which is more.
        above = (1.0 + 1e-9) * full.radius / start / SHARE_BELOW
        push, peak = (tuple(above * x for x in pair) for pair in pairs)
        return Held((push[0], push[1]), (peak[0], peak[1]))

    def most(self, slope: float) -> float:
        """Return the largest push that the floor allows beside one that grows with V."""
        left = self.gamma - 2.0 * self.factor * slope
        return SHARE_BELOW * left * self.full.least_radius / (2.0 * self.factor)

    def end_of_kick(self, hold: float) -> float:
        """Return a phase that is not reached from an impact to the next tick."""
        reached = self.full.start_strip + self.full.pace[1] * hold
        return float(at_most(1.001 * reached, DIGITS))

    def kicked(self, hold: float, held: Held) -> Kick:
        """Bound errors from an impact to the next tick; 0 if that is the touchdown."""
        if self.kick is None:
            return Kick()
        full = self.full
        exact, slope, push = self.kick
        first = exact + slope * full.guard_radius
        first += push * (held.peak[0] + held.peak[1] * full.guard_radius)
        errors = self.jerk.kicked(1.000001 * first, hold, full.bandwidth, full.radius)
        peak = float(at_most(errors.peak, DIGITS))
        return Kick(errors.first, peak, 0.5 * (errors.first + peak) + self.rest)

    def constants(self, hold: float, held: Held) -> DisturbedConstants:
        """Return the constants of a hold without those of barriers and kicks."""
        error = self.error if hold else 0.0
        return DisturbedConstants(held.push, held.peak, hold, error, *self.jerk[:3], barriers=())

    def _bears(self, hold: float, kick: Kick) -> bool:
        """Return whether the set holds what an impact adds until the next tick."""
        full, end = self.full, self.end_of_kick(hold)
        after, added = after_impact(full), self.factor * hold * kick.mean
        grown = after + added
        at_tick = after.max(after * math.exp(-0.5 * self.gamma * hold) + added)
        if not all(at_tick < bound_at(full, arb(phase)) for phase in (full.start_strip, end)):
            return False
        if not all(arb(of.sigma) * grown**2 < inlet(full, of) for of in full.barriers):
            return False
        early, contact = self.u[:, 0] <= end, self.forces[0]
        taken = (1.0 + SPENT) * kick.peak * contact.push
        return bool((taken < contact.left)[early].all())

    def stands(self, hold: float, held: Held) -> bool:
        """Return whether floor, decay, barriers, contact and torques allow it."""
        full = self.full
        if self.exact and hold > 0.0:
            constants = self.constants(hold, held)
            if not all(row.holds for row in face_inequalities(full, constants)):
                return False
        else:
            if held.push[0] > self.most(held.push[1]):
                return False
            shrinks = 4.0 * full.shrink * full.ends[1] * full.pace[1]
            if shrinks > SHARE_BELOW * (self.gamma - 2.0 * self.factor * held.push[1]):
                return False
        kick = self.kicked(hold, held)
        if self.kick is not None and not self._bears(hold, kick):
            return False
        return self.barriers(hold, held, kick) is not None

    def barriers(self, hold: float, held: Held, kick: Kick) -> tuple[DisturbedBarrier, ...] | None:
        """Return the constants of each barrier; None if a barrier or the forces leave no room."""
        peak = (1.0 + SPENT) * (held.peak[0] + held.peak[1] * self.bound)
        if any((peak[:, None] * forces.push >= forces.left).any() for forces in self.forces):
            return None
        most = held.push[0] + held.push[1] * self.full.radius
        most = max(most, 0.5 * self.gamma * hold * kick.mean)
        rows = tuple(self._barrier(k, most) for k in range(len(self.full.barriers)))
        return None if None in rows else rows  # pyright: ignore[reportReturnType]

    def _barrier(self, k: int, push: float) -> DisturbedBarrier | None:
        of, best = self.full.barriers[k], (0.0, None)
        tight = of.reading**2 / (4.0 * of.sigma)
        moved = 2.0 * of.sigma * self.factor * push
        for alpha in (a for a in GAINS if a < self.gamma):
            rest = 4.0 * of.sigma * (self.gamma - alpha)
            value = self.rate[:, k] + alpha * self.h[:, k]
            value = value - SPENT * np.abs(value)
            for split in (0.1, 0.2, 0.4, 0.7, 1.0, 1.5, 2.5, 5.0):
                weight = (1.0 + split) / rest
                # A little more than is needed: the conclusion rounds against it.
                lost = alpha * tight + (1.0 + 1.0 / split) * moved**2 / rest
                lost = lost * (1.0 + 1e-9) + 1e-12
                room = float((value - weight * self.squares[:, k]).min() - lost)
                if room > best[0]:
                    best = room, DisturbedBarrier(of.name, float(alpha), float(weight), float(lost))
        return best[1]
