"""A slider of the live page: its range, and how it is labelled and moved."""

import math
from typing import NamedTuple


class Slider(NamedTuple):
    """Range, initial value and words of a slider."""

    label: str
    """Name and unit."""
    low: float
    high: float
    first: float
    """Initial value."""
    step: float | None = None
    """Distance between two values; None for about a seventieth of the range."""
    hint: str = ""
    """Explanation for whoever points at it."""
    unit: float = 1.0
    """Size of the label's unit in that of the value that is set, as 0.001 of millimetres."""

    def clip(self, value: object) -> float | None:
        """Clip a number from the page to the limits; None if it is no number."""
        if isinstance(value, bool) or not isinstance(value, int | float):
            return None
        number = float(value)
        return min(max(number, self.low), self.high) if math.isfinite(number) else None

    @property
    def notch(self) -> float:
        """Return the step; if none was given, 1, 2 or 5 times a power of ten.

        Other steps have more digits than the number beside the slider has room for. Over the usual
        range of speeds a seventieth is half a centimetre a second.
        """
        if self.step is not None:
            return self.step
        share = (self.high - self.low) / 70.0 * (1.0 + 1e-9)
        place = 10.0 ** math.floor(math.log10(share))
        return float(f"{max(n * place for n in (1, 2, 5) if n * place <= share):.0e}")

    @property
    def shown(self) -> tuple[float, float, float]:
        """Return limits and initial value with three digits: the page cuts longer ones off."""
        low, high, first = (float(f"{value:.3g}") for value in self[1:4])
        return low, high, first
