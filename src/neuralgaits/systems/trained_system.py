"""The part of a family that training and simulation need: robot files, controller and words."""

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from neuralgaits.systems.system_family import Screen, SystemFamily

TrainingProgress = Callable[[int, float], None]
"""Function of the gradient step and the loss."""


class TrainedSystem(ABC):
    """A system whose controller is trained, or found.

    `run` is a `FamilyRun` everywhere: what was asked of the training, model, numbers of the robot
    file, and what training found.

    Attributes:
        family: what the house asks of it without JAX.
        config: type of its configurations, `FamilyConfig` or a subclass.
        summary: type of a training's result, `TrainedSummary` or a subclass.
        spec_files: sources of the conditions, of which each run keeps a copy.
        steps: usual number of gradient steps.
        robot_file: file of the built-in robot, beside the family's modules.
    """

    family: SystemFamily
    config: type[Any]
    summary: type[Any]
    spec_files: Sequence[Path]
    steps: int
    robot_file: Path

    @abstractmethod
    def read(self, text: str, name: str) -> tuple[Any, Any]:
        """Read model and numbers from MJCF text. Raises: RobotError with all that is wrong."""

    @abstractmethod
    def robot_facts(self, robot: Any, data: Any) -> Any:
        """Describe a robot file as a record, for `inspect`."""

    @abstractmethod
    def robot_screen(self, facts: Any) -> Screen:
        """Return the record of `robot_facts` for a person."""

    @abstractmethod
    def untrained(self, config: Any) -> Any:
        """Return a controller of zeros, to read arrays into."""

    @abstractmethod
    def refuse_controller(self, controller: Any, file: Path) -> None:
        """Refuse arrays that no training leaves. Raises: RobotError naming their file."""

    @abstractmethod
    def train(self, robot: Any, config: Any, progress: TrainingProgress | None) -> Any:
        """Train a controller for a robot of the family."""

    @abstractmethod
    def measured(self, run: Any) -> dict[str, Any]:
        """Return the margins, number of samples and sizes that a training's summary has."""
