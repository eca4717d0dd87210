"""What a level above 1 is to those who read a proof: parameters, premises and a conclusion.

How its parameters are found, and what its premises are as functions of a gait, is its entry of
`sets.LEVEL_SEARCHES`. Needs no JAX.
"""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from neuralgaits.certificate.chart import Chart, Corner
from neuralgaits.certificate.levels.premises import Bounds, Boxes
from neuralgaits.records.certified import Conclusion

Parameters = Mapping[int, Any]
"""Parameters of levels, by number."""


@dataclass(frozen=True)
class Level:
    """A theorem about trajectories whose premises a proof file has statements of.

    Attributes:
        number: of the level.
        part: what constants of the Program that are its parameters are named after.
        parameters: the class of its parameters.
        constants: of parameters, by name: lists of numbers that the Program has as constants.
        premises: of parameters and of the boxes of level 1: (label, output, low, high) of all that
            it rests on beside the levels below.
        conclude: from parameters, boxes of level 1 and proved bounds.
        rests_on: numbers of the levels that have to be proved.
        full_order: whether its premises are about outputs off zero: about xi of the unit ball. It
            rests on no condition of level 1 then.
        refusal: from parameters and the chart: why the theorem is not about them, or None.
    """

    number: int
    part: str
    parameters: type
    constants: Callable[[Any], Mapping[str, tuple[float, ...]]]
    premises: Callable[[Parameters, Boxes], Iterator[tuple[str, str, Corner, Corner]]]
    conclude: Callable[[Parameters, Boxes, Bounds], Conclusion]
    rests_on: tuple[int, ...] = ()
    full_order: bool = False
    refusal: Callable[[Parameters, Chart], str | None] = lambda known, chart: None
