"""Sets for held torques, or without a hold, that one norm of V allows, estimated at points.

Nothing here is trusted.
"""

import math
from typing import NamedTuple

import numpy as np

from neuralgaits.certificate.levels.full_order.held import (
    JERK,
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
from neuralgaits.certificate.levels.full_order.hold_map import hold_shares
from neuralgaits.certificate.levels.full_order.model_room import ModelRoom
from neuralgaits.certificate.levels.full_order.samples import GaitSamples, doubled
from neuralgaits.certificate.levels.full_order.theorem import STIFF, lyapunov_rate

HELD_SPARE = 1.1
"""Factor of room for contact, torque and foot while torques are held. It is smaller than without a
hold, because slopes already take too much."""
TORQUE_SPARE = 1.2
"""Factor more for torques where a law is not exact: level 4 bounds those of exact linearisation."""
FULL = 0.96
"""Share of a set without pushes that an impact may fill."""
IMPACT = 1.18
"""Effect of an impact, as a multiple of the largest seen: bounds cost so much."""
LONGEST = 4e-3
"""Longest hold that is tried [s]."""
STRIP = 0.97
"""Phase at which the guard's strip begins."""
STRIP_OF_HELD = 0.99
"""The same of the smaller sets for held torques."""
LARGEST = 0.2
"""Largest radius that is tried for a set without pushes [rad]."""
LARGEST_OF_LAW = 6.5e-3
"""Largest radius that is tried where a law is not exact [rad]: bounds on its decay fail beyond."""
GAINS = np.array([0.5, 1.0, 2.0, 3.0, 5.0, 8.0, 12.0, 20.0])
"""Barrier gains alpha that are tried [1/s]."""


class Plan(NamedTuple):
    """A set for held torques, or the largest set without a hold, estimated at points.

    Attributes:
        matrix: S. [m, m]
        hold: time that torques are held [s]; 0 for no hold.
        radius, floor: those of the set [rad]; the radius is 0 if there is no set.
        slower: share of the decay of V that remains with a hold.
        sigma: weight of V in each barrier.
        planned: plans of this norm for shorter holds.
    """

    matrix: np.ndarray
    hold: float
    radius: float
    floor: float
    slower: float
    sigma: tuple[float, ...]
    planned: "NormPlans"

    def smaller(self, share: float) -> "Plan":
        """Return the plan for this share of the hold, or of the radius if there is no hold."""
        if self.hold == 0.0:
            return self.planned.still(share * self.radius)
        return self.planned.plan(share * self.hold)

    @property
    def weights(self) -> tuple[float, ...]:
        """Return S in the form of `FullOrderConstants.weights`."""
        size = len(self.matrix)
        return tuple(float(self.matrix[i, j]) for i in range(size) for j in range(i, size))


def sensed_bound(errors: np.ndarray) -> float:
    """Bound |S e| of torques of measured states, given S e of an error of each angle and rate.

    At points, the errors' lengths add up at worst. [n, m, 2n].
    """
    room = 1.04  # As a multiple of the largest sum seen: between points, and off zero outputs.
    return room * float(np.linalg.norm(errors, axis=1).sum(axis=1).max())


def push_factor(bandwidth: float) -> float:
    """Return |d xi'/d e| for a unit |S e|, where xi' has S e/w and STIFF S e/w [s]."""
    return math.sqrt(1.0 + float(STIFF) ** 2) / bandwidth


class NormPlans:
    """Plans for holds and sets that one norm allows."""

    def __init__(
        self,
        samples: GaitSamples,
        bandwidth: float,
        matrix: np.ndarray,
        held: bool = False,
        error: float = 0.0,
    ):
        self.samples, self.w, self.matrix = samples, bandwidth, matrix
        self.error = (
            error if samples.sensed is None else error + sensed_bound(matrix @ samples.sensed)
        )
        self.impact = 1.06 if held else IMPACT
        inverse = np.linalg.inv(matrix)
        pair, inverse_pair = doubled(matrix), doubled(inverse)
        usual = float(lyapunov_rate(bandwidth))
        self.factor = push_factor(bandwidth)
        own, along = samples.law
        # Where a law is not exact: the decay that is left of the usual, and its error at xi = 0.
        self.gamma = least_decay(matrix @ along @ inverse_pair, bandwidth) if along.any() else usual
        self.gamma_share = self.gamma / usual
        self.largest = LARGEST_OF_LAW if along.any() else LARGEST
        self.rest = rest_bound(own @ matrix.T) if along.any() else 0.0
        value, slope, pushed = samples.slack
        self.slack = value, _size(slope @ inverse_pair), _size(pushed @ inverse)
        self.coupling = 1.15 * _size(samples.rate.in_xi @ inverse_pair)
        self.reading = 1.2 * _size(samples.reading @ inverse_pair).max(axis=0)
        after = pair @ samples.after @ inverse_pair
        self.gain = self.impact * float(np.sqrt((after**2).sum(axis=(1, 2)).max()))
        self.reset = self.impact * _size(samples.reset @ inverse_pair).max(axis=0)
        jerk, along, moved = samples.jerk
        self.exact = not samples.law.in_xi.any()
        self.jerk = Jerk(
            JERK * float(_size(jerk @ matrix.T).max()),
            slope_bound(matrix @ along @ inverse_pair, bandwidth, exact=self.exact),
            push_bound(matrix @ moved @ inverse, samples.law.in_xi),
            feedback_slope(bandwidth) if self.exact else 0.0,
        )
        self.kick = None
        if samples.kick is not None:
            first, along, more = samples.kick
            self.kick = first @ matrix.T, matrix @ along @ inverse_pair, matrix @ more @ inverse
        self.model = ModelRoom.of(samples, matrix, pair)
        self.jerk = self.jerk._replace(still=self.jerk.still + self.model.growth)
        # Errors of the law itself, and the drift of sqrt(V) by other robots, in their unit.
        self.beside = self.rest + self.model.drift / self.factor
        # Four times the largest pace, in which outputs off zero have a part, bounds the shrinking.
        pace = samples.pace * (4.08 * 1.04 if held else 4.25 * 1.1)
        self.shrink, self.strip = self.gamma / pace, STRIP_OF_HELD if held else STRIP
        self.shape = np.exp(-self.shrink * samples.phase**2)
        self.left = math.exp(-self.shrink * self.strip**2)

    def best(self) -> Plan:
        """Return the plan in which torques can be held the longest."""
        low, high = 0.0, LONGEST
        for _ in range(14):
            middle = 0.5 * (low + high)
            low, high = (middle, high) if self.plan(middle).radius else (low, middle)
        return self.plan(low)

    def plan(self, hold: float) -> Plan:
        """Return the set for a hold; its radius is 0 if there is none."""
        none = Plan(self.matrix, 0.0, 0.0, 0.0, 1.0, (), self)
        full = 0.995  # Share of the set that an impact may fill.
        if not (hold > 0.0 and self.gamma > 0.0):
            return none
        bounds = self._hold_bounds(hold)
        slower, floor = self._slower_and_floor(hold, bounds)
        if slower <= 0.2:
            return none
        left = math.exp(-slower * self.shrink * self.strip**2)
        growth, landed = max(self.gain, 1.1) / full, self.model.landed / full
        if growth * left >= 0.9:
            return none
        radius, kick = 0.0, Kick()
        for _ in range(4 if self.kick else 1):  # What an impact adds depends on the radius.
            kick = self._kicked(hold, bounds, floor + (radius - floor) * left, radius)
            radius = (growth * floor * (1.0 - left) + landed) / (1.0 - growth * left)
            if self.kick:
                added = self.factor * hold * (kick.mean + self.beside) / full
                decayed = math.exp(-0.5 * self.gamma * hold) * growth
                least = floor * (1.0 - left) + landed / growth
                kicked = (decayed * least + added) / (1.0 - decayed * left)
                radius = max(radius, kicked)
        if radius > self.largest:
            return none
        bound = floor + (radius - floor) * np.exp(-slower * self.shrink * self.samples.phase**2)
        value, slope, pushed = self.slack
        contact, torque = slice(0, 3), slice(3, -2)  # The foot's two slacks are the last.
        need = bound[:, None] * slope
        if self.samples.law.in_xi.any():
            need[:, torque] *= TORQUE_SPARE
        need = need + (bounds.peak[0] + bounds.peak[1] * bound)[:, None] * pushed
        if not (HELD_SPARE * need <= value).all():
            return none
        # Phase until which contact has to stand the error that an impact makes under old torques.
        early = self.samples.phase <= 0.05
        need = bound[:, None] * slope + kick.peak * pushed
        if not (HELD_SPARE * need <= value)[early, contact].all():
            return none
        before = floor + (radius - floor) * math.exp(-slower * self.shrink * self.strip**2)
        push = bounds.push[0] + bounds.push[1] * radius + self.model.drift / self.factor
        if self.kick:
            push = max(push, 0.5 * self.gamma * hold * (kick.mean + self.beside))
        sigma = tuple(self._sigma(i, push, before, radius) for i in range(len(self.samples.inlet)))
        if 0.0 in sigma:
            return none
        return Plan(self.matrix, hold, radius, floor, self.gamma_share * slower, sigma, self)

    def _slower_and_floor(self, hold: float, bounds: Held) -> tuple[float, float]:
        """Return the share of the decay that a hold leaves, and the least radius [rad]."""
        if not self.exact:
            slower = 1.0 - 2.0 * self.factor * bounds.push[1] / self.gamma
            # Bound on sqrt(V), as a multiple of the level at which pushes alone keep outputs.
            return slower, 1.02 * 2.0 * self.factor * bounds.push[0] / (slower * self.gamma)
        grown, slope = self.jerk.halves(hold, bounds)
        shares = hold_shares(self.w, hold, slope)
        grown += 0.5 * hold * self.model.jerk(self.w)
        floor = 1.02 * shares.floor * (grown + self.error) / self.w**2
        floor, shrink = self.model.floor_and_shrink(floor, shares.shrink, self.w, hold)
        return min(0.99 * 2.0 * shrink / self.gamma, 1.0), floor

    def _hold_bounds(self, hold: float) -> Held:
        """Bound errors of a hold, that of the law at xi = 0 included."""
        return self.jerk.held(hold, self.error, self.w, self.gamma, self.rest)

    def _kicked(self, hold: float, bounds: Held, before: float, radius: float) -> Kick:
        """Bound errors from an impact to the next tick; `before` bounds sqrt(V) before it."""
        if self.kick is None:
            return Kick()
        exact, slope, push = kick_bounds(*self.kick, before)
        first = exact + slope * before + push * (bounds.peak[0] + bounds.peak[1] * before)
        return self.jerk.kicked(first, hold, self.w, radius)

    @property
    def slack_of_impacts(self) -> float:
        """Return the share of a set without floor that an impact leaves free; negative if none."""
        return min(FULL - self.gain * self.left, 0.0)

    def widest(self) -> Plan:
        """Return the largest set without pushes."""
        low, high = 0.0, LARGEST
        for _ in range(14):
            middle = 0.5 * (low + high)
            low, high = (middle, high) if self.still(middle).radius else (low, middle)
        return self.still(low)

    def still(self, radius: float) -> Plan:
        """Return a set of this radius without pushes; its radius is 0 if there is none."""
        sigma: tuple[float, ...] = ()
        value, slope, _ = self.slack
        spare = 1.6  # Factor of room for contact, torque and foot.
        stands = spare * radius * self.shape[:, None] * slope <= value
        if radius > 0.0 and self.slack_of_impacts == 0.0 and stands.all():
            sigma = tuple(self._still_sigma(i, radius) for i in range(len(self.samples.inlet)))
        if not sigma or 0.0 in sigma:
            radius, sigma = 0.0, ()
        return Plan(self.matrix, 0.0, radius, 0.0, 1.0, sigma, self)

    def _still_sigma(self, i: int, radius: float) -> float:
        """Return the weight that leaves a barrier the most room without pushes; 0 if none does."""
        c, read, before = self.coupling[:, i].max(), self.reading[i], radius * self.left
        rate = (self.samples.rate.value[:, i] + GAINS[:, None] * self.samples.h[:, i]).min(axis=1)
        sigmas = np.geomspace(1.0, 1e5, 121)  # Weights of V in a barrier that are tried.
        tight = read**2 / (4.0 * sigmas)
        lost = 1.1 * c**2 / (4.0 * sigmas[:, None] * (self.gamma - GAINS))
        room = (0.91 * rate - lost - GAINS * tight[:, None]).max(axis=1)
        inlet = 0.95 * self.samples.inlet[i] - self.reset[i] * before - tight
        room[1.05 * sigmas * (self.gain * before) ** 2 > inlet] = -1.0
        return float(sigmas[room.argmax()]) if room.max() > 0.0 else 0.0

    def _sigma(self, i: int, push: float, before: float, radius: float) -> float:
        """Return the weight that leaves a barrier the most room; 0 if none does.

        `before` bounds sqrt(V) before an impact.
        """
        c, read = self.coupling[:, i], self.reading[i]
        value = 0.97 * (self.samples.rate.value[:, i] + GAINS[:, None] * self.samples.h[:, i])
        rest = self.gamma - GAINS
        middle = c.max() / (2.0 * self.factor * push)
        sigma = np.concatenate(
            [middle * np.geomspace(0.1, 1.5, 9), read / radius * np.array([0.5, 1, 2])]
        )
        sigma = sigma[sigma > 0.0]
        tight = read**2 / (4.0 * sigma)
        inlet = 0.95 * self.samples.inlet[i] - self.reset[i] * before - tight
        inlet = inlet - self.model.landed_barriers[i]
        lost = (c + 2.0 * sigma[:, None, None] * self.factor * push) ** 2 / (
            4.0 * sigma[:, None, None] * rest[:, None]
        )
        room = (value - self.model.barriers[:, i] - lost).min(axis=2) - GAINS * tight[:, None]
        # Level 4 takes the least rate and the largest coupling, wherever each is.
        still = 0.94 * value.min(axis=1) - c.max() ** 2 * 1.1 / (4.0 * sigma[:, None] * rest)
        still = (still - GAINS * tight[:, None]).max(axis=1)
        room = np.minimum(room.max(axis=1), still)
        room[sigma * radius**2 > inlet] = -1.0
        return float(sigma[room.argmax()]) if room.max() > 0.0 else 0.0


def _size(rows: np.ndarray) -> np.ndarray:
    return np.linalg.norm(rows, axis=-1)
