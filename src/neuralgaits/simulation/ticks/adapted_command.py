"""The commands of one episode, adapted at each touchdown if that is wanted: speed, lean, slope."""

import math

import numpy as np

from neuralgaits._types import Float
from neuralgaits.control import speed_adapter
from neuralgaits.control.command_belief import (
    SETTLED,
    belief_for,
    next_belief,
    slope_under_feet,
)
from neuralgaits.control.speed_adapter import ADAPTED, StepOdometer
from neuralgaits.gait.commands import LEAN, SLOPE, Commands, place_of
from neuralgaits.robots import PlanarBiped

ADAPTABLE = ADAPTED, *SETTLED
"""Commands that can be adapted, in the order in which they are written."""


class AdaptedCommand:
    """Adapter, odometer and beliefs of one robot; without such commands it changes nothing.

    Attributes:
        names: commands that are adapted; speeds are measured in any case.
        place: place of the speed among the commands; None if it is not there.
        ended: reference and measured speed of the step that ended last [m/s]; NaN if unknown.
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
        self._believed = {name: float(first[place]) for name, (place, _) in self._beliefs.items()}

    def request(self, told: Float[np.ndarray, " p"]) -> Float[np.ndarray, " p"]:
        """Return what the controller is to be told in the place of these commands."""
        adapted = np.array(told)
        if self._adapter is not None and ADAPTED in self.names:
            speed = float(told[self.place])
            adapted[self.place] = speed_adapter.command_for(self._adapter, self._state, speed)
        for name, (place, _) in self._beliefs.items():
            if name in self.names:
                adapted[place] = self._believed[name]
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
        for name, (place, belief) in self._beliefs.items():
            # Once it is not adapted it stays as the user tells it, and is learned from there.
            self._believed[name] = next_belief(belief, float(latched[1, place]), shown[name])
        if self._adapter is None:
            return
        hips = speed_adapter.hips_over_feet(self._robot, np.asarray(q))
        self._odometer, walked = self._odometer.touch_down(time, *hips)
        self.ended = self._state.reference, math.nan if walked is None else walked
        speed, before, after = (float(one[self.place]) for one in (told, *latched))
        heard = None if self._believes_anew(latched) else walked
        self._state = speed_adapter.advance(self._adapter, self._state, speed, before, after, heard)

    def _believes_anew(self, latched: Float[np.ndarray, "2 p"]) -> bool:
        """Return whether a belief is on its way, so that a speed says little about the next one."""
        changes = np.abs(np.diff(latched, axis=0)[0])
        return any(
            name in self.names and float(changes[place]) > SETTLED[name]
            for name, (place, _) in self._beliefs.items()
        )
