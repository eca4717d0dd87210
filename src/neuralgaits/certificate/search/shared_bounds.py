"""Bound boxes on many workers: batches are tasks, and results are put together in order.

Bounds depend on the batch alone, and the batches on the search alone. So the boxes, and the proof
made of them, are the same whoever bounded them.
"""

import json
import math
from collections.abc import Generator, Iterator, Sequence
from contextlib import closing, contextmanager
from dataclasses import fields
from functools import lru_cache

import numpy as np

from neuralgaits.certificate.chart import CoupledAxes
from neuralgaits.certificate.search.problem import BoundAll, Bounds, Boxes, Problem
from neuralgaits.engine import Files, Job, Settings, WorkerPool, worker_pool_for
from neuralgaits.programs import Program

_PROBLEM, _LOW, _HIGH, _LOWER, _UPPER = "problem.json", "low", "high", "lower", "upper"


class SharedBounds:
    """A function that gets bounds from the workers of an engine."""

    def __init__(self, engine: WorkerPool):
        self._engine = engine

    def __call__(self, problem: Problem, batches: Sequence[Boxes]) -> Generator[Bounds, None, None]:
        """Yield bounds on the boxes of each batch, in order.

        Small batches are bounded in this process, as are boxes that no worker could bound.
        """
        pieces = [_pieces(problem, batch) for batch in batches]
        bounds = self._ordered_bounds(problem, [piece for some in pieces for piece in some])
        with closing(bounds):
            for some in pieces:
                parts = [next(bounds) for _ in some]
                lower, upper = (np.concatenate(part) for part in zip(*parts, strict=True))
                yield lower, upper

    def _ordered_bounds(
        self, problem: Problem, pieces: Sequence[Boxes]
    ) -> Generator[Bounds, None, None]:
        if len(pieces) == 1:
            yield problem.bounds(*pieces[0])
            return
        jobs = (
            Job(str(k), {"axes": low.shape[1]}, {_LOW: low.tobytes(), _HIGH: high.tobytes()})
            for k, (low, high) in enumerate(pieces)
        )
        common = {_PROBLEM: to_json(problem).encode()}
        shape = (-1, len(problem.names))
        bounds_by_piece: dict[int, Bounds] = {}
        next_piece = 0
        with closing(self._engine.map(bound_batch, jobs, common=common)) as answers:
            for done in answers:
                number = int(done.name)
                if done.failure is None:
                    lower, upper = (
                        np.frombuffer(done.files[name]).reshape(shape) for name in (_LOWER, _UPPER)
                    )
                    bounds_by_piece[number] = lower, upper
                else:
                    bounds_by_piece[number] = problem.bounds(*pieces[number])
                while next_piece in bounds_by_piece:
                    yield bounds_by_piece.pop(next_piece)
                    next_piece += 1


@contextmanager
def bounding(workers: int | None, ray: str | None) -> Iterator[BoundAll | None]:
    """Yield the function that bounds boxes on workers; None bounds them in this process."""
    if workers is None and ray is None:
        yield None
        return
    with worker_pool_for(workers, ray) as pool:
        yield SharedBounds(pool)


def _pieces(problem: Problem, batch: Boxes) -> list[Boxes]:
    """Split a batch: compiled code bounds each box by itself, NumPy whole batches."""
    low, high = batch
    most = 512  # Boxes of a task for compiled code: tenths of a second.
    count = math.ceil(len(low) / most) if problem.compiled else 1
    return list(zip(np.array_split(low, count), np.array_split(high, count), strict=True))


def bound_batch(settings: Settings, files: Files) -> Files:
    """Bound the boxes of a batch, as a task of a worker.

    Args:
        settings: `axes` of the chart.
        files: `problem.json`, and corners of the boxes as float64.

    Returns: bounds from below and above as float64.
    """
    problem = _problem(files[_PROBLEM])
    low, high = (np.frombuffer(files[name]).reshape(-1, settings["axes"]) for name in (_LOW, _HIGH))
    lower, upper = problem.bounds(low, high)
    return {_LOWER: _bytes(lower), _UPPER: _bytes(upper)}


def _bytes(values: np.ndarray) -> bytes:
    return np.ascontiguousarray(values, np.float64).tobytes()


@lru_cache(maxsize=4)
def _problem(text: bytes) -> Problem:
    """Return the problem of a text; recent ones are kept, so a worker reads each Program once."""
    return from_json(text.decode())


def to_json(problem: Problem) -> str:
    """Return a problem as text, all digits included."""
    values = {item.name: getattr(problem, item.name) for item in fields(problem)}
    return json.dumps(values | {"program": problem.program.to_json()})


def from_json(text: str) -> Problem:
    """Read a problem that `to_json` wrote."""
    values = json.loads(text)
    tuples = ("low", "high", "names", "scales", "least", "symbols")
    values |= {name: tuple(values[name]) for name in tuples}
    values["coupled_axes"] = tuple(CoupledAxes(*pair) for pair in values["coupled_axes"])
    return Problem(**values | {"program": Program.from_json(values["program"])})
