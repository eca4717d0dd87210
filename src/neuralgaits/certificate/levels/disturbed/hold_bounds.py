"""Bounds on what a hold does in a set, estimated at points. Nothing here is trusted."""

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
from flint import arb

from neuralgaits._digits import at_least, at_most
from neuralgaits.certificate.level_target import grid
from neuralgaits.certificate.levels.disturbed.find_model import taken_by_model, with_peaks
from neuralgaits.certificate.levels.disturbed.find_state import ABOVE, DIGITS
from neuralgaits.certificate.levels.disturbed.model_inequalities import (
    barrier_landed,
    error_drift,
    kicked_barrier,
    kicked_by_model,
    landed,
    model_inequalities,
    more_acceleration,
    most_error,
    output_drift,
    outputs_landed,
)
from neuralgaits.certificate.levels.disturbed.push_inequalities import factor
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
from neuralgaits.certificate.levels.full_order.inequalities import after_impact, bound_at, inlet
from neuralgaits.certificate.levels.full_order.norm_plans import GAINS
from neuralgaits.certificate.levels.full_order.samples import SampleEvaluators
from neuralgaits.certificate.levels.full_order.theorem import FullOrderConstants, lyapunov_rate

SHARE_BELOW = 1.0 - 1e-9
"""Share of a limit that a number which must lie below it may reach."""
NO_KICK, NO_HOLD = Kick(), Held((0.0, 0.0), (0.0, 0.0))
ROUNDS = 6
"""Rounds in which errors and what other robots add to their growth are found."""
SPENT = 0.05
"""Share of dh/dt + alpha h that bounds may lose, and by which outputs may take more of forces."""


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


class HoldBounds:
    """Effect of pushes on barriers, contact and torques at points, and growth of held errors."""

    def __init__(
        self,
        evaluators: SampleEvaluators,
        full: FullOrderConstants,
        u: np.ndarray,
        free_clock: bool,
        error: float,
        model: Mapping[str, Any],
    ):
        self.error, self.model = error, model
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
        # Constants of barriers are found last; until then these hold their places.
        self.unset = tuple(DisturbedBarrier(of.name, 1.0, 1.0, 1.0) for of in full.barriers)
        self.taken = taken_by_model(evaluators, u, model, len(full.barriers))

    def held(self, hold: float) -> Held:
        """Bound the errors of torques that are exact when set and then held, with room."""
        full, jerk, held = self.full, self.jerk, NO_HOLD
        start = full.least_radius + (full.radius - full.least_radius) * math.exp(
            -full.shrink * full.start_strip**2
        )
        # The proof takes the bound at the start's strip for the one at phase 0, which is more.
        above = (1.0 + 1e-9) * full.radius / start / SHARE_BELOW
        for _ in range(ROUNDS if self.model else 1):
            pairs = jerk.held(hold, self.error, full.bandwidth, self.gamma, self.rest)
            push, peak = (tuple(above * x for x in pair) for pair in pairs)
            held = Held((push[0], push[1]), (peak[0], peak[1]))
            jerk = self._fed(most_error(full, self.constants(hold, held)))
        return held

    def _fed(self, most: arb) -> Jerk:
        """Return the jerk with what other robots add to the growth of |S e| up to `most`."""
        if not self.model:
            return self.jerk
        more = error_drift(self.constants(0.0, NO_HOLD), most).at(most, arb(self.full.radius))
        return self.jerk._replace(still=self.jerk.still + ABOVE * float(more.upper()))

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
        constants, jerk, errors, peak = self.constants(hold, held), self.jerk, Kick(), 0.0
        first = float(kicked_by_model(full, constants, arb(1.000001 * first)).upper())
        for _ in range(ROUNDS if self.model else 1):
            errors = jerk.kicked(first, hold, full.bandwidth, full.radius)
            peak = float(at_most(errors.peak, DIGITS))
            jerk = self._fed(arb(peak))
        beside = self._drift(constants, arb(peak)) + self.rest
        return Kick(errors.first, peak, 0.5 * (errors.first + peak) + beside)

    def constants(self, hold: float, held: Held, kick: Kick = NO_KICK) -> DisturbedConstants:
        """Return the constants of a hold without those of barriers and of a kick.

        Where other robots are allowed, with the kick's peak, which bounds their effects.
        """
        error, full = self.error if hold else 0.0, self.full
        constants = DisturbedConstants(
            held.push, held.peak, hold, error, *self.jerk[:3], barriers=self.unset
        )
        if not self.model:
            return constants
        constants = replace(constants, **self.model, model_peaks=(1.0, 1.0), kick_peak=kick.peak)
        most = most_error(full, constants).max(arb(kick.peak))
        more = more_acceleration(constants).at(most, arb(full.radius))
        more_landed = landed(full, constants)
        return replace(constants, **with_peaks(float(more.upper()), float(more_landed.upper())))

    def _drift(self, constants: DisturbedConstants, most: arb) -> float:
        """Bound what other robots add to the rate of sqrt(V), in the unit of |S e| [rad/s^2]."""
        drift = output_drift(constants).at(most, arb(self.full.radius))
        return float(drift.upper()) / self.factor

    def _bears(self, hold: float, kick: Kick) -> bool:
        """Return whether the set holds what an impact adds until the next tick."""
        full, end = self.full, self.end_of_kick(hold)
        constants = self.constants(hold, NO_HOLD, kick)
        after = after_impact(full) + outputs_landed(full, constants)
        added = self.factor * hold * kick.mean
        grown = after + added
        at_tick = after.max(after * math.exp(-0.5 * self.gamma * hold) + added)
        if not all(at_tick < bound_at(full, arb(phase)) for phase in (full.start_strip, end)):
            return False
        for k, of in enumerate(full.barriers):
            if not arb(of.sigma) * grown**2 < inlet(full, of) - barrier_landed(full, constants, k):
                return False
        early, contact = self.u[:, 0] <= end, self.forces[0]
        taken = (1.0 + SPENT) * (
            kick.peak * contact.push + self.taken.of_contact(constants, self.bound)
        )
        return bool((taken < contact.left)[early].all())

    def stands(self, hold: float, held: Held) -> bool:
        """Return whether floor, decay, barriers, contact and torques allow it."""
        full = self.full
        if self.exact and hold > 0.0:
            constants = self.constants(hold, held)
            rows = face_inequalities(full, constants) + model_inequalities(full, constants)
            if not all(row.holds for row in rows):
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
        constants = self.constants(hold, held, kick)
        taken = (1.0 + SPENT) * self.taken.of_contact(constants, self.bound), 0.0
        for forces, more in zip(self.forces, taken, strict=True):
            if (peak[:, None] * forces.push + more >= forces.left).any():
                return None
        most = held.push[0] + held.push[1] * self.full.radius
        most += self._drift(constants, most_error(self.full, constants))
        most = max(most, 0.5 * self.gamma * hold * kick.mean)
        rows = tuple(self._barrier(k, most, constants) for k in range(len(self.full.barriers)))
        return None if None in rows else rows  # pyright: ignore[reportReturnType]

    def _barrier(
        self, k: int, push: float, constants: DisturbedConstants
    ) -> DisturbedBarrier | None:
        of, best = self.full.barriers[k], (0.0, None)
        tight = of.reading**2 / (4.0 * of.sigma)
        moved = 2.0 * of.sigma * self.factor * push
        drift = self.taken.of_barriers(constants, self.bound)[:, k]
        kicked = float(kicked_barrier(constants, k).upper())
        for alpha in (a for a in GAINS if a < self.gamma):
            rest = 4.0 * of.sigma * (self.gamma - alpha)
            value = self.rate[:, k] + alpha * self.h[:, k]
            value = value - SPENT * np.abs(value) - (1.0 + SPENT) * drift
            for split in (0.1, 0.2, 0.4, 0.7, 1.0, 1.5, 2.5, 5.0):
                weight = (1.0 + split) / rest
                # A little more than is needed: the conclusion rounds against it.
                lost = alpha * tight + (1.0 + 1.0 / split) * moved**2 / rest + kicked
                lost = lost * (1.0 + 1e-9) + 1e-12
                room = float((value - weight * self.squares[:, k]).min() - lost)
                if room > best[0]:
                    best = room, DisturbedBarrier(of.name, float(alpha), float(weight), float(lost))
        return best[1]
