"""The part of a family that is its own: model, controller, conditions and words.

All else of its verbs is shared: run folders, proofs and their comparison with a run, exports,
pages and screens, see `systems.family_verbs`.
"""

from abc import abstractmethod
from collections.abc import Callable, Mapping, Sequence
from typing import Any

from matplotlib.figure import Figure

from neuralgaits._types import Array, Float
from neuralgaits.records.certified import Conclusion
from neuralgaits.systems.condition_table import ConditionTable
from neuralgaits.systems.controller_header import ControllerHeader
from neuralgaits.systems.system_family import Screen
from neuralgaits.systems.trained_system import TrainedSystem


class ProvedSystem(TrainedSystem):
    """A system whose conditions are proved on boxes of a chart.

    Attributes:
        table: its conditions, of a controller without commands.
        highest: highest level of its proofs.
        why_highest: why there is no higher one, for a person.
        about_proofs: what its proofs are about, for a person.
        claimed: share of a margin that proofs claim: on many axes it takes many boxes to claim all
            of it, and only the sign matters.
    """

    table: ConditionTable
    highest: int
    why_highest: str
    about_proofs: str
    claimed: float = 0.4

    def table_of(self, config: Any) -> ConditionTable:
        """Return the conditions of a configuration: those of all, unless it has commands."""
        del config
        return self.table

    @abstractmethod
    def sizes(self, summary: Any) -> str:
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
    def episodes_screen(self, record: Any) -> Screen:
        """Return the lines that show a record of episodes to a person."""

    @abstractmethod
    def page_lines(self, run: Any) -> list[str]:
        """Return the sentences at the head of a run's page, about robot and set."""

    @abstractmethod
    def page_figures(self, run: Any) -> Sequence[tuple[Figure, str]]:
        """Draw the figures of a run's page, each with its caption."""


class ExportedSystem(ProvedSystem):
    """A system whose controller is exported as C, with or without a memory.

    Attributes:
        state_size: how many numbers the exported function takes, of a controller without commands.
    """

    state_size: int

    def state_size_of(self, config: Any) -> int:
        """Return how many it takes of a configuration: those of all, unless it has commands."""
        del config
        return self.state_size

    @abstractmethod
    def header(self, run: Any) -> ControllerHeader:
        """Return names and numbers of the exported controller."""

    @abstractmethod
    def law(self, run: Any) -> Callable[[Float[Array, " n"]], dict[str, Array]]:
        """Return the exported controller: from a state to outputs, the first of them compared."""

    @abstractmethod
    def states(self, run: Any, count: int, seed: int) -> Float[Any, "count n"]:
        """Return random states of the proved set, at which an export is compared."""
