"""Control tick of a live walk: one robot, a plant that changes. In JAX or compiled, see beside."""

from abc import ABC, abstractmethod
from typing import Any, NamedTuple

import numpy as np

from neuralgaits._types import Float
from neuralgaits.simulation.setup.plant import Plant
from neuralgaits.simulation.ticks.tick import TickOutcome, TickRecord


class MeasuredTick(NamedTuple):
    """State that the controller had at a tick."""

    q: Float[np.ndarray, " n"]
    """Measured coordinates [rad]. [n]"""
    dq: Float[np.ndarray, " n"]
    """Measured rates [rad/s]. [n]"""
    z: Float[np.ndarray, "2"]
    """State of the zero dynamics that follows (m, kg m^2/s). [2]"""
    commands: Float[np.ndarray, "2 p"]
    """Commands of the step before, and of this one. [2, p]"""


class StepSpeeds(NamedTuple):
    """Speeds of the last whole step, of a gait that takes a speed as command [m/s]."""

    requested: float
    """Speed that the step was to have, spread over steps as large changes are."""
    commanded: float
    """Command of the step; another one than requested where it is adapted."""
    walked: float
    """Mean speed by joint angles and pitch."""

    @classmethod
    def of(
        cls, ended: tuple[float, float], commands: Float[np.ndarray, " p"], place: int | None
    ) -> "StepSpeeds | None":
        """Return the speeds of a step that ended; None if it was not measured.

        Args:
            ended: its reference, and its measured speed (m/s); NaN where unknown.
            commands: its commands. [p]
            place: place of the speed among them; None if it is not there.
        """
        if place is None or not np.all(np.isfinite(ended)):
            return None
        return cls(float(ended[0]), float(commands[place]), float(ended[1]))


class LiveTick(ABC):
    """A control tick that keeps the state of stance and policy from one call to the next.

    Attributes:
        speeds: speeds of the last whole step; None before one, or without a commanded speed.
        doubted: commands of which the last step showed what cannot be, so the belief stays.
    """

    speeds: StepSpeeds | None = None
    doubted: tuple[str, ...] = ()

    @abstractmethod
    def compile(self) -> None:
        """Compile the tick; without this call the first tick waits for it."""

    @abstractmethod
    def restart(self) -> None:
        """Clear the memory: the robot stands on leg 0."""

    @abstractmethod
    def tell(self, requested: Float[np.ndarray, " p"]) -> None:
        """Request other commands from the next touchdown on."""

    @abstractmethod
    def adapt(self, active: bool) -> None:
        """Adapt the commands that can be, from now on, or no longer; see `AdaptedCommand`."""

    @abstractmethod
    def change(self, plant: Plant, torque_limit: Float[np.ndarray, " m"], slope: float) -> None:
        """Continue with another plant, torque limits (N m) and slope of the floor."""

    @abstractmethod
    def decide(self, data: Any, levels: Float[np.ndarray, "2"]) -> TickOutcome:
        """Compute one tick at a state of MuJoCo. Leaves have an axis of one.

        `levels` are those of the floor, or of the foothold that each foot had last (m).
        """

    @property
    @abstractmethod
    def record(self) -> TickRecord | None:
        """Record of the last tick, with a leading axis of one; None before it."""

    @property
    @abstractmethod
    def measured(self) -> MeasuredTick | None:
        """State at the last tick, which is quicker to have than its record; None before it."""
