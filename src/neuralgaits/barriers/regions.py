"""Boxes inside a tube's chart, and the sides of a tube, which conditions are about."""

from typing import Literal, NamedTuple

Side = Literal["lower", "upper"]


class Box(NamedTuple):
    """A box of the chart: low <= u <= high; low == high on an axis is a curve.

    Axes behind the last one that is named, as those of commands, are taken whole.
    """

    low: tuple[float, ...]
    high: tuple[float, ...]
