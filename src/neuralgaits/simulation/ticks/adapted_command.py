"""The commands of one episode, with the speed adapted at each touchdown if that is wanted."""

import math

import numpy as np

from neuralgaits._types import Float
from neuralgaits.control import speed_adapter
from neuralgaits.control.speed_adapter import ADAPTED, StepOdometer
from neuralgaits.gait.commands import Commands, place_of
from neuralgaits.robots import PlanarBiped


class AdaptedCommand:
    """Adapter and odometer of one robot; without a commanded speed it changes nothing.

    Attributes:
        active: whether commands are adapted; speeds are measured in any case.
        place: place of the speed among the commands; None if it is not there.
        ended: reference and measured speed of the step that ended last [m/s]; NaN if unknown.
    """

    def __init__(
        self,
        robot: PlanarBiped,
        commands: Commands,
        first: Float[np.ndarray, " p"],
        *,
        active: bool,
    ):
        """Begin at the commands of the first step. [p]. `robot` is the controller's model."""
        self.active = active
        self.ended: tuple[float, float] = (math.nan, math.nan)
        self._adapter = speed_adapter.adapter_for(commands)
        self.place = place_of(commands, ADAPTED)
        self._robot, self._odometer = robot, StepOdometer()
        if self._adapter is not None:
            self._state = speed_adapter.start(self._adapter, float(first[self.place]))

    def request(self, told: Float[np.ndarray, " p"]) -> Float[np.ndarray, " p"]:
        """Return what the controller is to be told in the place of these commands."""
        if self._adapter is None or not self.active:
            return told
        adapted = np.array(told)
        speed = float(told[self.place])
        adapted[self.place] = speed_adapter.command_for(self._adapter, self._state, speed)
        return adapted

    def touch_down(
        self,
        time: float,
        q: Float[np.ndarray, " n"],
        latched: Float[np.ndarray, "2 p"],
        told: Float[np.ndarray, " p"],
    ) -> None:
        """Take note of a touchdown.

        Args:
            time: time of the touchdown (s).
            q: coordinates, standing on the leg that stands now (rad).
            latched: commands of the step that ended, and of the one that begins.
            told: what the user told the step that begins.
        """
        if self._adapter is None:
            return
        hips = speed_adapter.hips_over_feet(self._robot, np.asarray(q))
        self._odometer, walked = self._odometer.touch_down(time, *hips)
        self.ended = self._state.reference, math.nan if walked is None else walked
        speed, before, after = (float(one[self.place]) for one in (told, *latched))
        self._state = speed_adapter.advance(
            self._adapter, self._state, speed, before, after, walked
        )
