"""Definition of a level above 1 for readers of a proof: parameters, premises, conclusion.

Each level's folder has its `level.py`, and in `search.py` the search for its parameters and its
premises as functions of a gait. Needs no JAX.
"""

from abc import ABC, abstractmethod
from collections.abc import Iterator, Mapping
from dataclasses import fields
from typing import Any, ClassVar

from neuralgaits.certificate.chart import Chart, Corner
from neuralgaits.certificate.premises import Bounds, Boxes
from neuralgaits.records.certified import Conclusion

Parameters = Mapping[int, Any]
"""Parameters of levels, by number of the level."""


class Level(ABC):
    """A theorem about trajectories whose premises a proof file has statements of.

    Attributes:
        number: number of the level.
        part: prefix of the Program's constants that are its parameters.
        parameters: the class of its parameters.
        rests_on: numbers of the levels that have to be proved first.
        full_order: whether its premises are about outputs off zero, xi of the unit ball. It
            rests on no condition of level 1 then.
    """

    number: ClassVar[int]
    part: ClassVar[str]
    parameters: ClassVar[type]
    rests_on: ClassVar[tuple[int, ...]] = ()
    full_order: ClassVar[bool] = False

    def constants(self, own: Any) -> Mapping[str, tuple[float, ...]]:
        """Return the Program's constants, lists of numbers by name, of its own parameters."""
        values = {field.name: getattr(own, field.name) for field in fields(own)}
        return {
            name: value
            for name, value in values.items()
            if isinstance(value, tuple) and value and isinstance(value[0], float)
        }

    @abstractmethod
    def premises(
        self, parameters: Parameters, boxes: Boxes
    ) -> Iterator[tuple[str, str, Corner, Corner]]:
        """Return (label, output, low, high) of all premises beside the levels below.

        Args:
            parameters: parameters of this level, and of those below.
            boxes: boxes of level 1.
        """

    @abstractmethod
    def conclude(self, parameters: Parameters, boxes: Boxes, bounds: Bounds) -> Conclusion:
        """Draw the conclusion of the theorem from proved bounds."""

    def refusal(self, parameters: Parameters, chart: Chart) -> str | None:
        """Explain why the theorem does not cover a chart, or return None."""
        return None
