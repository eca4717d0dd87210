"""Boxes inside a tube's chart, and the sides of a tube, which conditions are about."""

from typing import Literal, NamedTuple

Side = Literal["lower", "upper"]


class Box(NamedTuple):
    """A box of the chart: low <= u <= high; low == high on an axis is a curve.

    Axes behind the last one that is named, as those of commands, are taken whole.
    """

    low: tuple[float, ...]
    high: tuple[float, ...]

    def why_not_of(self, axes: int) -> str | None:
        """Say why its faces close no box of a chart with so many axes; None if they do."""
        plane = 2  # Phase and level come first.
        if not plane <= len(self.low) == len(self.high) <= axes:
            count = f"{plane}" if axes == plane else f"{plane} to {axes}"
            return (
                f"expected {count} numbers in each corner of a box, as many in both, found "
                f"{len(self.low)} and {len(self.high)}: name phase and level in both"
            )
        for axis, (low, high) in enumerate(zip(self.low, self.high, strict=True)):
            if not low <= high:
                return (
                    f"expected a box from its low corner to its high one, found {low:g} to "
                    f"{high:g} on axis {axis}: exchange them"
                )
        if not all(0.0 <= end <= 1.0 for end in (*self.low[:plane], *self.high[:plane])):
            return (
                "expected phases and levels from 0 to 1, the whole step between the fences, found "
                f"{self.low[:plane]} to {self.high[:plane]}: keep the box within"
            )
        return None
