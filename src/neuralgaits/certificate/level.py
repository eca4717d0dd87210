"""Definition of a level above 1 for readers of a proof: parameters, premises, conclusion.

Each level's folder has its `level.py`, and in `search.py` the search for its parameters and its
premises as functions of a gait. Needs no JAX.
"""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, fields
from typing import Any

from neuralgaits.certificate.chart import Chart, Corner
from neuralgaits.certificate.premises import Bounds, Boxes
from neuralgaits.records.certified import Conclusion

Parameters = Mapping[int, Any]
"""Parameters of levels, by number of the level."""


@dataclass(frozen=True)
class Level:
    """A theorem about trajectories whose premises a proof file has statements of.

    Attributes:
        number: number of the level.
        part: prefix of the Program's constants that are its parameters.
        parameters: the class of its parameters.
        constants: function from parameters to the Program's constants, lists of numbers by name.
        premises: function from parameters and the boxes of level 1 to (label, output, low, high)
            of all premises beside the levels below.
        conclude: function from parameters, boxes of level 1 and proved bounds to a conclusion.
        rests_on: numbers of the levels that have to be proved first.
        full_order: whether its premises are about outputs off zero, xi of the unit ball. It
            rests on no condition of level 1 then.
        refusal: function from parameters and the chart to why the theorem does not cover them.
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


def lists_of(parameters: Any) -> Mapping[str, tuple[float, ...]]:
    """Return the parameters that are lists of numbers, by name."""
    values = {field.name: getattr(parameters, field.name) for field in fields(parameters)}
    return {
        name: value
        for name, value in values.items()
        if isinstance(value, tuple) and value and isinstance(value[0], float)
    }
