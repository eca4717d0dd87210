"""Conditions on one box of the chart, with bounds over boxes and values at points."""

from collections.abc import Callable, Generator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from neuralgaits._types import Float
from neuralgaits.certificate.chart import CoupledAxes, required_boxes
from neuralgaits.certificate.search.halving import Corners, PerCondition, wide_axes
from neuralgaits.programs import POINT, Program, evaluate, fold
from neuralgaits.programs.algebras.taylor_algebra import TaylorAlgebra, taylor_remainders
from neuralgaits.programs.algebras.taylor_model import terms
from neuralgaits.programs.native.bounder import Bounder
from neuralgaits.programs.native.compiled_choice import compiled_choice
from neuralgaits.programs.remainder_symbols import count_of, numbered, values_with_symbols

Boxes = tuple[np.ndarray, np.ndarray]
"""Lower and upper corners of B boxes. [B, n] each."""
Bounds = tuple[np.ndarray, np.ndarray]
"""Bounds of each condition on each box, from below and above. [B, C] each."""
BoundAll = Callable[["Problem", Sequence[Boxes]], Generator[Bounds, None, None]]
"""Function that yields bounds on the boxes of each batch, in order."""
INPUT = "u"
"""Name of a Program's first input: the point of the chart."""


@dataclass(frozen=True)
class Problem:
    """Margins of some conditions on one root box.

    Attributes:
        region: name of the spec's region the box belongs to.
        low, high: corners in the chart. [n]
        names: names of the conditions, outputs of the Program.
        scales: scales of the conditions. [C]
        program: margins by condition name as a function of u; more outputs cost time only. A
            second input is anywhere in the unit ball.
        degree: degree of the Taylor models: 2 in every search, since 1 needs more boxes; checkers
            read both.
        least: lower limit that each condition must reach, in scales; 0 for all if empty. Margins
            are relative to it. [C]
        claimed: share of the margin found that is claimed. A reader needs fewer boxes for less,
            and bounds them in another arithmetic, perhaps less tightly.
        tight: share of the smallest margin seen that is worth proving once it is known not to be
            negative: the rest would cost more boxes. 0 if its size is worth none.
        weak_axes: how many axes, the last ones, have little influence: only their ends are
            evaluated.
        coupled_axes: axes whose values must be near each other; points with larger differences are
            left out.
        symbols: values whose remainders have symbols of their own.
    """

    region: str
    low: tuple[float, ...]
    high: tuple[float, ...]
    names: tuple[str, ...]
    scales: tuple[float, ...]
    program: Program
    degree: int = 2
    least: tuple[float, ...] = ()
    claimed: float = 0.99
    tight: float = 0.95
    weak_axes: int = 0
    coupled_axes: tuple[CoupledAxes, ...] = ()
    symbols: tuple[int, ...] = ()

    @cached_property
    def with_symbols(self) -> "Problem":
        """Return the problem with symbols for remainders that cancel; itself if there are none."""
        program, low, high = self.program, self.low, self.high
        chosen = compiled_choice(program, low, high, self._folded) if self.compiled else None
        if chosen is None:
            chosen = values_with_symbols(program, low, high, taylor_remainders)
        return replace(self, symbols=chosen) if chosen else self

    @property
    def compiled(self) -> bool:
        """Return whether compiled code bounds boxes, each by itself."""
        return self._compiled is not None

    @cached_property
    def batch(self) -> int:
        """Number of boxes to bound at once."""
        largest = max((operation.size for operation in self.program.operations), default=1)
        if self._compiled is not None:
            return 8192
        one = terms(self.degree, len(self.low)) * largest * np.dtype(np.float64).itemsize
        # Size of the largest result of an operation over a batch [bytes]: about a core's own cache.
        cache_bytes = 2**22
        # Fewer boxes waste time in calls, more exhaust the processor's cache.
        least, most = 64, 512
        return min(max(cache_bytes // one, least), most)

    def bounds(self, low: Corners, high: Corners) -> tuple[PerCondition, PerCondition]:
        """Bound each condition's smallest margin over boxes, in scales; NaN if unbounded."""
        if self._compiled is not None:
            lower, upper = self._compiled.bounds(low, high)
            return self._from_least(lower), self._from_least(upper)
        centre = low + (high - low) * 0.5
        # Up by two last places: the corners lie inside whatever the centre was rounded to.
        half = np.maximum(high - centre, centre - low) * (1.0 + 2.0**-51)
        with np.errstate(all="ignore"):
            models = evaluate(
                self.program, {INPUT: (centre, half)}, self._algebra, self._folded, self._symbols_of
            )
            ranges = [models[name].range() for name in self.names]
        return self._smallest([r[0] for r in ranges], low), self._smallest(
            [r[1] for r in ranges], low
        )

    def values(self, u: Corners) -> PerCondition:
        """Evaluate each condition's smallest margin at points, in scales, in plain float64.

        A second input is zero.
        """
        inputs = {item.name: np.zeros((len(u), *item.shape)) for item in self.program.inputs}
        inputs[INPUT] = u
        with np.errstate(all="ignore"):
            values = evaluate(self.program, inputs, POINT)
        return self._smallest([values[name].reshape(len(u), -1).T for name in self.names], u)

    def unfinished(self, lower: PerCondition) -> np.ndarray:
        """Return which boxes with these bounds may yet be halved. [B].

        Where only the sign is worth proving, a box that has it is done.
        """
        return np.any(~(lower >= 0.0), axis=1) | (self.tight > 0.0)

    def required(self, low: Corners, high: Corners) -> np.ndarray:
        """Return which boxes have a point that conditions apply to. A reader checks again. [B]."""
        return required_boxes(self.coupled_axes, low, high)

    def grid(self, points: int) -> Corners:
        """Return about so many points that cover the box, its edges included. [B, n].

        On weak axes each point has ends of its own, drawn at random: all combinations would be too
        many.
        """
        first_weak = len(self.low) - self.weak_axes
        wide = wide_axes(np.array(self.low), np.array(self.high))
        wide = [axis for axis in wide if axis < first_weak]
        fewest, most = 3, 33  # Points along an axis.
        size = min(max(round(points ** (1.0 / max(len(wide), 1))), fewest), most)
        lines = [
            np.linspace(low, high, size if axis in wide else 1)
            for axis, (low, high) in enumerate(
                zip(self.low[:first_weak], self.high[:first_weak], strict=True)
            )
        ]
        points_of_grid = np.stack(np.meshgrid(*lines, indexing="ij"), axis=-1).reshape(
            -1, len(lines)
        )
        if not self.weak_axes:
            return points_of_grid
        points_of_grid = np.tile(points_of_grid, (max(points // len(points_of_grid), 1), 1))
        upper = np.random.default_rng(0).random((len(points_of_grid), self.weak_axes)) < 0.5
        ends = np.where(upper, self.high[first_weak:], self.low[first_weak:])
        return np.hstack([points_of_grid, ends])

    def worse(self, points: Float[np.ndarray, "P n"]) -> Float[np.ndarray, "Q n"]:
        """Move the points, for each condition, to ends of weak axes where its margin is smaller.

        At the point where it is smallest each weak axis is moved to either end by itself; the
        better ends of all axes together then replace those of every point. Q = P C.
        """
        first_weak, candidates = len(self.low) - self.weak_axes, []
        values = self.values(points)
        for column in range(len(self.names)):
            margins = np.where(np.isnan(values[:, column]), np.inf, values[:, column])
            at = points[int(np.argmin(margins))]
            ends_of_axes = np.tile(at, (2 * self.weak_axes, 1))
            axes = first_weak + np.arange(self.weak_axes)
            ends_of_axes[2 * np.arange(self.weak_axes), axes] = np.array(self.low)[first_weak:]
            ends_of_axes[2 * np.arange(self.weak_axes) + 1, axes] = np.array(self.high)[first_weak:]
            ends = self.values(ends_of_axes)[:, column].reshape(-1, 2)
            better = np.where(
                ends[:, 0] < ends[:, 1], self.low[first_weak:], self.high[first_weak:]
            )
            everywhere = points.copy()
            everywhere[:, first_weak:] = better
            candidates.append(everywhere)
        return np.concatenate(candidates)

    def _smallest(self, elements: Sequence[np.ndarray], boxes: np.ndarray) -> np.ndarray:
        """Return each condition's smallest element [n, B] above its least, in scales; NaN wins."""
        rows = [np.broadcast_to(e.min(axis=0), len(boxes)) for e in elements]
        return self._from_least(np.stack(rows, axis=1))

    def _from_least(self, margins: PerCondition) -> PerCondition:
        """Return margins relative to the limit that each condition must reach, in scales."""
        return margins / np.array(self.scales) - np.array(self.least or (0.0,))

    @cached_property
    def _compiled(self) -> Bounder | None:
        """Return compiled code where there is a compiler; the Python rules are the reference."""
        if self.degree != 2:  # No other degree is compiled.
            return None
        return Bounder.of(self.program, self.names, self._folded, self._symbols_of)

    @cached_property
    def _symbols_of(self) -> dict[int, int]:
        return numbered(self.program, self.symbols)

    @cached_property
    def _algebra(self) -> TaylorAlgebra:
        return TaylorAlgebra(self.degree, count_of(self.program, self._symbols_of))

    @cached_property
    def _folded(self):
        with np.errstate(all="ignore"):
            return fold(self.program, self._algebra)
