"""The part of a family that is its own: model, controller, conditions and words.

All else of its verbs is shared: run folders, proofs and their comparison with a run, exports,
pages and screens, see `systems.family_verbs`.
"""

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

from matplotlib.figure import Figure

from neuralgaits._types import Array, Float
from neuralgaits.records.certified import Conclusion
from neuralgaits.systems.condition_table import ConditionTable
from neuralgaits.systems.controller_header import ControllerHeader
from neuralgaits.systems.system_family import Screen, SystemFamily

TrainingProgress = Callable[[int, float], None]
"""Function of the gradient step and the loss."""


class ProvedSystem(ABC):
    """A system whose conditions are proved on boxes of a chart.

    `run` is a `FamilyRun` everywhere: what was asked of the training, model, numbers of the robot
    file, and what training found.

    Attributes:
        family: what the house asks of it without JAX.
        table: its conditions.
        config: type of its configurations, `FamilyConfig` or a subclass.
        summary: type of a training's result, `TrainedSummary` or a subclass.
        spec_files: sources of the conditions, of which each run keeps a copy.
        steps: usual number of gradient steps.
        highest: highest level of its proofs.
        why_highest: why there is no higher one, for a person.
        about_proofs: what its proofs are about, for a person.
        claimed: share of a margin that proofs claim: on many axes it takes many boxes to claim all
            of it, and only the sign matters.
        robot_file: file of the built-in robot, beside the family's modules.
    """

    family: SystemFamily
    table: ConditionTable
    config: type[Any]
    summary: type[Any]
    spec_files: Sequence[Path]
    steps: int
    highest: int
    why_highest: str
    about_proofs: str
    robot_file: Path
    claimed: float = 0.4

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
    def new_config(
        self, *, seed: int, steps: int, hidden: tuple[int, ...] | None, robot: str
    ) -> Any:
        """Return the configuration of a training. Raises: InputError on bad settings."""

    @abstractmethod
    def untrained(self, config: Any) -> Any:
        """Return a controller of zeros, to read arrays into."""

    @abstractmethod
    def refuse_controller(self, controller: Any, file: Path) -> None:
        """Refuse arrays that no training leaves. Raises: RobotError naming their file."""

    @abstractmethod
    def train(self, robot: Any, config: Any, progress: TrainingProgress | None) -> Any:
        """Train a controller."""

    @abstractmethod
    def measured(self, run: Any) -> dict[str, Any]:
        """Return the margins, number of samples and sizes that a training's summary has."""

    @abstractmethod
    def sizes(self, done: Any) -> str:
        """Return the sizes of a training's summary in words."""

    @abstractmethod
    def margins(self, run: Any, u: Float[Array, " n"]) -> Mapping[str, Array]:
        """Return the margins of all conditions at a point of the chart, by name."""

    @abstractmethod
    def place(self, run: Any, u: Float[Array, " n"]) -> tuple[float, float]:
        """Return the two coordinates by which a person finds the state of a chart's point."""

    @abstractmethod
    def place_in_words(self, place: tuple[float, float]) -> str:
        """Return such coordinates in words, with units."""

    @abstractmethod
    def spec_numbers(self, config: Any) -> Mapping[str, float]:
        """Return numbers of the configuration that its conditions are about."""

    @abstractmethod
    def conclude(
        self, bounds: Mapping[str, float | None], config: Any, level: int
    ) -> tuple[Conclusion, ...]:
        """Draw the conclusions about trajectories that proved bounds of conditions allow."""

    @abstractmethod
    def episodes(self, run: Any, count: int, seed: int) -> tuple[Any, bool]:
        """Simulate in MuJoCo. Returns: a record, and whether the answer is yes."""

    @abstractmethod
    def episodes_screen(self, done: Any) -> Screen:
        """Return the record of `episodes` for a person."""

    @abstractmethod
    def header(self, run: Any) -> ControllerHeader:
        """Return names and numbers of the exported controller."""

    @abstractmethod
    def law(self, run: Any) -> Callable[[Float[Array, " n"]], dict[str, Array]]:
        """Return the exported controller: from a state to outputs, the first of them compared."""

    @abstractmethod
    def states(self, run: Any, count: int, seed: int) -> Float[Any, "count n"]:
        """Return random states of the proved set, at which an export is compared."""

    @abstractmethod
    def page_lines(self, run: Any) -> list[str]:
        """Return the sentences at the head of a run's page, about robot and set."""

    @abstractmethod
    def page_figures(self, run: Any) -> Sequence[tuple[Figure, str]]:
        """Draw the figures of a run's page, each with its caption."""
