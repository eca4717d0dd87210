"""The commands of one episode, adapted at each touchdown if that is wanted: speed, lean, slope."""

import math
from collections.abc import Mapping

import numpy as np

from neuralgaits._types import Float
from neuralgaits.control import speed_adapter
from neuralgaits.control.command_belief import (
    SETTLED,
    CommandEstimate,
    belief_for,
    believable,
    can_be,
    learn,
    next_belief,
    slope_under_feet,
    speed_by_lean,
)
from neuralgaits.control.speed_adapter import ADAPTED, StepOdometer
from neuralgaits.gait.commands import LEAN, SLOPE, Commands, place_of
from neuralgaits.robots import PlanarBiped


class AdaptedCommand:
    """Adapter, odometer and beliefs of one robot; without such commands it changes nothing.

    Attributes:
        names: commands that are adapted; speeds are measured in any case.
        place: place of the speed among the commands; None if it is not there.
        ended: reference and measured speed of the step that ended last [m/s]; NaN if unknown.
        doubted: commands of which the step that ended last showed what cannot be.
    """

    def __init__(
        self,
        robot: PlanarBiped,
        commands: Commands,
        first: Float[np.ndarray, " p"],
        names: tuple[str, ...],
    ):
        """Begin at the commands of the first step. [p]. `robot` is the controller's model."""
        self.names = names
        self.ended: tuple[float, float] = (math.nan, math.nan)
        self.doubted: tuple[str, ...] = ()
        self._adapter, self.place = speed_adapter.adapter_for(commands), place_of(commands, ADAPTED)
        self._beliefs = {
            name: (place, belief)
            for name in SETTLED
            if (place := place_of(commands, name)) is not None
            and (belief := belief_for(commands, name)) is not None
        }
        self._robot, self._odometer = robot, StepOdometer()
        if self._adapter is not None:
            self._state = speed_adapter.start(self._adapter, float(first[self.place]))
        self._latched, self._begun = np.array(first), False
        self._estimates = {
            name: CommandEstimate(float(first[place])) for name, (place, _) in self._beliefs.items()
        }
        self._speed_by_lean = speed_by_lean(robot) if LEAN in self._beliefs else 0.0

    def request(
        self, told: Float[np.ndarray, " p"], lean: float = math.nan
    ) -> Float[np.ndarray, " p"]:
        """Return what the controller is to be told in the place of these commands. [p].

        Args:
            told: commands that the user tells. [p]
            lean: lean that the step under way shows so far (m); NaN if it shows none.
        """
        adapted, estimates = np.array(told), self._so_far(lean)
        if self._adapter is not None and ADAPTED in self.names:
            speed = float(told[self.place])
            excess, moving = self._excess(estimates)
            adapted[self.place] = speed_adapter.command_for(
                self._adapter, self._state, speed, excess, moving=moving
            )
        for name, (place, belief) in self._beliefs.items():
            if name in self.names:
                adapted[place] = believable(belief, estimates[name])
        return adapted

    def touch_down(
        self,
        time: float,
        q: Float[np.ndarray, " n"],
        latched: Float[np.ndarray, "2 p"],
        told: Float[np.ndarray, " p"],
        lean: float = math.nan,
    ) -> None:
        """Take note of a touchdown.

        Args:
            time: time of the touchdown (s).
            q: coordinates, standing on the leg that stands now (rad).
            latched: commands of the step that ended, and of the one that begins.
            told: what the user told the step that begins.
            lean: lean that the step that ended shows (m); NaN if it shows none.
        """
        shown = {LEAN: lean, SLOPE: slope_under_feet(self._robot, np.asarray(q))}
        self._latched = np.array(latched[1])
        self.doubted = tuple(
            name
            for name, (_, belief) in self._beliefs.items()
            if not (math.isnan(shown[name]) or can_be(belief, shown[name]))
        )
        for name, (_, belief) in self._beliefs.items():
            whole = self._begun or name != LEAN
            self._estimates[name] = learn(belief, self._estimates[name], shown[name], whole=whole)
        self._begun = True
        if self._adapter is None:
            return
        hips = speed_adapter.hips_over_feet(self._robot, np.asarray(q))
        self._odometer, walked = self._odometer.touch_down(time, *hips)
        self.ended = self._state.reference, math.nan if walked is None else walked
        speed, before, after = (float(one[self.place]) for one in (told, *latched))
        settled = not self._believes_anew(latched[0])
        self._state = speed_adapter.advance(
            self._adapter, self._state, speed, before, after, walked, settled=settled
        )

    def _so_far(self, lean: float) -> dict[str, CommandEstimate]:
        """Return the estimates with what the step under way shows so far."""
        if LEAN not in self._beliefs:
            return self._estimates
        _, belief = self._beliefs[LEAN]
        now = learn(belief, self._estimates[LEAN], lean, whole=self._begun)
        return self._estimates | {LEAN: now}

    def _excess(self, estimates: Mapping[str, CommandEstimate]) -> tuple[float, bool]:
        """Return the speed that a lean beyond the belief of the next step adds (m/s).

        With it, whether that belief is still on its way.
        """
        if LEAN not in self.names or LEAN not in self._beliefs:
            return 0.0, False
        place, belief = self._beliefs[LEAN]
        estimate = estimates[LEAN]
        next_lean = next_belief(belief, estimate, float(self._latched[place]))
        excess = self._speed_by_lean * (estimate.value - next_lean)
        return excess, next_lean != believable(belief, estimate)

    def _believes_anew(self, before: Float[np.ndarray, " p"]) -> bool:
        """Return whether a belief is on its way, so that a speed says little about the next one.

        Some steps after an estimate began anew the speed is still on its way, too. `before` has the
        commands of the step that ended. [p]
        """
        return any(
            name in self.names
            and (
                self._estimates[name].pause > 0
                or abs(believable(belief, self._estimates[name]) - float(before[place]))
                > SETTLED[name]
            )
            for name, (place, belief) in self._beliefs.items()
        )
