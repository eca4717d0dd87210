"""Which remainders get symbols of their own, so that they cancel where they meet themselves.

What a Taylor model cannot expand is a remainder [-r, r], bounded anew wherever the result is read,
though it is one number everywhere: in a sum of products it counts with the sum of magnitudes. As
r e, with a symbol e in [-1, 1] of its own, it counts with the magnitude of the sum. Where bounds on
barrier conditions fail, 95 to 99 percent of what they lack is such a remainder, and nearly all of
that is false.

A symbol costs time in every operation behind it, so there are few. Let d be the derivative of an
output by an element, and p the sum of the magnitudes of all paths to it. A symbol takes r (p - |d|)
from the output's remainder. The value with the largest sum of these, in units of the output's own
remainder, gets symbols first; then r and p are computed again. Whatever is chosen, bounds are true:
the choice is only about how near they come.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence

import numpy as np

from neuralgaits.programs.evaluation import fold, results
from neuralgaits.programs.point_algebra import POINT
from neuralgaits.programs.program import Program
from neuralgaits.programs.sensitivity import Sensitivity, sensitivities

MOST_SYMBOLS = 16
"""Most symbols of a Program. Four hard conditions over all speeds took 279 thousand boxes and 21 s
with 8, 151 thousand and 15 s with 16; one of them alone took over 600 thousand with none."""
MOST_OFF_ZERO = 32
"""The same where xi is an input: terms of second order in xi do not shrink with boxes. With 16 the
slope of held errors under scheduled PD has no bound in sets of 6.4 mrad on boxes of 1/400; with 32
it has."""
SHARES = (0.05, 0.005, 5e-4, 5e-5)
"""Widths of the box on which remainders are compared, in those of the region: the next one where
one has no bounds. Eliminations of large matrices have bounds on small boxes alone."""

Symbols = Mapping[int, int]
"""First symbol, counted from 0, by the number of the value whose remainders have symbols."""
Remainders = Callable[[Program, np.ndarray, np.ndarray, Symbols], dict[int, np.ndarray]]
"""Function from Program, corners of a box [n] and symbols to remainders of all results [size]."""


def most_symbols(program: Program) -> int:
    """Return how many symbols a Program may have."""
    return MOST_SYMBOLS if len(program.inputs) == 1 else MOST_OFF_ZERO


def least_gain(program: Program) -> float:
    """Return the least part of an output's remainder for which a value gets symbols."""
    least = 0.02  # Least part of an output's remainder for which a value gets symbols.
    least_off_zero = 0.002  # Less where xi is an input: many small values share what is lost.
    return least if len(program.inputs) == 1 else least_off_zero


def count_of(program: Program, symbols: Symbols) -> int:
    """Return how many symbols there are."""
    return sum(program.sizes[number] for number in symbols)


def numbered(program: Program, values: Sequence[int]) -> dict[int, int]:
    """Return the symbols of some values."""
    numbers, count = {}, 0
    for number in sorted(values):
        numbers[number], count = count, count + program.sizes[number]
    return numbers


def values_with_symbols(
    program: Program, low: Sequence[float], high: Sequence[float], remainders: Remainders
) -> tuple[int, ...]:
    """Choose the values of a Program whose remainders get symbols.

    Args:
        program: Program of u, over which boxes are given, its first input; a second one is in the
            unit ball.
        low: lower corner of the region in which boxes are. [n]
        high: upper corner. [n]
        remainders: remainders in the algebra that is to have symbols.

    Returns: their numbers; none where none helps, or where nothing has a bound.
    """
    if too_large(program):
        return ()
    with np.errstate(all="ignore"):
        for share in SHARES:
            at_middle = _Evaluations(program, *middle(low, high, share), remainders)
            if np.all(np.isfinite(at_middle.of_outputs(at_middle.remainders([])))):
                return tuple(sorted(at_middle.greedy()))
    return ()


def too_large(program: Program) -> bool:
    """Return whether nothing is chosen: outputs have too many sensitivities, or are constants."""
    outputs = {output.value for output in program.outputs}
    columns = sum(program.sizes[number] for number in outputs if program.varies[number])
    most_numbers = 2**23  # Most sensitivities: of larger Programs nothing is chosen.
    return not 0 < sum(program.sizes) * columns <= most_numbers


def middle(
    low: Sequence[float], high: Sequence[float], share: float
) -> tuple[np.ndarray, np.ndarray]:
    """Return the corners of a box in the middle of a region, a share of its width wide. [n]."""
    ends = np.array(low), np.array(high)
    centre, half = (ends[0] + ends[1]) / 2.0, share * (ends[1] - ends[0]) / 2.0
    return centre - half, centre + half


class _Evaluations:
    """Remainders and sensitivities of a Program in the middle of its region."""

    def __init__(
        self,
        program: Program,
        low: np.ndarray,
        high: np.ndarray,
        remainders: Remainders,
    ):
        self.program, self._remainders = program, remainders
        outputs = sorted({output.value for output in program.outputs})
        self.outputs = [number for number in outputs if program.varies[number]]
        self.low, self.high = low, high
        centre = (low + high) / 2.0
        point = {
            item.name: np.zeros(item.shape) if k else centre
            for k, item in enumerate(program.inputs)
        }
        constants = fold(program, POINT)
        values = {**constants, **dict(results(program, point, POINT, constants))}
        self.values = {number: value[:, 0] for number, value in values.items()}
        sizes = [program.sizes[number] for number in self.outputs]
        places = np.split(np.eye(sum(sizes)), np.cumsum(sizes)[:-1])
        self.seeds = dict(zip(self.outputs, places, strict=True))

    def remainders(self, numbers: Sequence[int]) -> dict[int, np.ndarray]:
        """Return the remainder of each result; 0 of those that have symbols. [size]."""
        return self._remainders(self.program, self.low, self.high, numbered(self.program, numbers))

    def of_outputs(self, remainders: Mapping[int, np.ndarray]) -> np.ndarray:
        """Return the remainders of all elements of outputs. [m]."""
        return np.concatenate([remainders[number] for number in self.outputs])

    def greedy(self) -> Iterator[int]:
        """Yield values while there are symbols left for one that helps."""
        program = self.program
        numbers = []
        left = most_symbols(self.program)
        # Off zero the gain of one symbol counts: a large value would leave room for nothing else.
        off_zero = len(program.inputs) > 1
        remainders = self.remainders(numbers)
        whole = self.of_outputs(remainders)
        while True:
            reached = sensitivities(program, self.values, self.seeds, numbers)
            gains = {
                number: _gain(remainders[number], reached[number], whole)
                for number in remainders
                if number in reached and program.sizes[number] <= left
            }
            helping = {
                number: gain.sum() / (program.sizes[number] if off_zero else 1)
                for number, gain in gains.items()
                if gain.max() >= least_gain(program) or not off_zero
            }
            best = max(helping, key=lambda number: helping[number], default=None)
            if best is None or not gains[best].max() >= least_gain(program):
                return
            yield best
            numbers.append(best)
            left -= program.sizes[best]
            remainders = self.remainders(numbers)


def _gain(remainder: np.ndarray, reached: Sensitivity, whole: np.ndarray) -> np.ndarray:
    """Return the parts of the outputs' remainders that symbols for a value would take away. [m]."""
    gain = remainder @ (reached.paths - np.abs(reached.derivative)) / whole
    return np.where(np.isfinite(gain), gain, 0.0)
