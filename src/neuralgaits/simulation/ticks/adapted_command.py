"""The commands of one episode, with speed and lean adapted at each touchdown if that is wanted."""

import math

import numpy as np

from neuralgaits._types import Float
from neuralgaits.control import speed_adapter
from neuralgaits.control.lean_belief import SETTLED_M, belief_for, next_belief
from neuralgaits.control.speed_adapter import ADAPTED, StepOdometer
from neuralgaits.gait.commands import LEAN, Commands, place_of
from neuralgaits.robots import PlanarBiped

ADAPTABLE = ADAPTED, LEAN
"""Commands that can be adapted, in the order in which they are written."""


class AdaptedCommand:
    """Adapter, odometer and belief of one robot; without such commands it changes nothing.

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
        self._adapter, self._belief = speed_adapter.adapter_for(commands), belief_for(commands)
        self.place, self._lean = place_of(commands, ADAPTED), place_of(commands, LEAN)
        self._robot, self._odometer = robot, StepOdometer()
        if self._adapter is not None:
            self._state = speed_adapter.start(self._adapter, float(first[self.place]))
        self._believed = math.nan if self._lean is None else float(first[self._lean])

    def request(self, told: Float[np.ndarray, " p"]) -> Float[np.ndarray, " p"]:
        """Return what the controller is to be told in the place of these commands."""
        adapted = np.array(told)
        if self._adapter is not None and ADAPTED in self.names:
            speed = float(told[self.place])
            adapted[self.place] = speed_adapter.command_for(self._adapter, self._state, speed)
        if self._lean is not None and LEAN in self.names:
            adapted[self._lean] = self._believed
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
        if self._belief is not None:
            # Once it is not adapted it stays as the user tells it, and is learned from there.
            self._believed = next_belief(self._belief, float(latched[1, self._lean]), lean)
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
        if self._lean is None or LEAN not in self.names:
            return False
        return abs(float(np.diff(latched[:, self._lean])[0])) > SETTLED_M
