"""Save a search to disk, so that a later one continues from there."""

import hashlib
import json
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from neuralgaits.certificate.chart import Corner
from neuralgaits.certificate.search.box_tree import BoxTree, PendingBoxes
from neuralgaits.certificate.search.branch_and_bound import Search
from neuralgaits.certificate.search.halving import boxes_of
from neuralgaits.certificate.search.problem import Problem
from neuralgaits.errors import RunError
from neuralgaits.records.certified import Counterexample
from neuralgaits.runs import read_arrays, write_arrays
from neuralgaits.runs.arrays import SHA256

_KEPT = ("first", "axis", "lower", "upper", "alone")
"""Arrays of a tree in a file; corners and cuts follow from these."""


def save(path: Path, problem: Problem, state: Search) -> None:
    """Write one root's boxes in one piece, or nothing at all."""
    tree = state.tree
    proved = bool(np.all(tree.lower[tree.is_leaf] >= 0.0))
    arrays = {"first": tree.first, "axis": tree.axis, "lower": tree.lower}
    if not proved:
        costs = np.full((len(tree.first), len(problem.low)), np.inf)
        costs[tree.pending.number] = tree.pending.costs
        arrays |= {"upper": tree.upper, "alone": costs}
    arrays["seen"] = state.smallest
    refuted = {
        name: {"u": point.u, "z": point.z, "margin": point.margin}
        for name, point in state.refuted.items()
    }
    metadata = {
        "problem": fingerprint(problem),
        "refuted": json.dumps(refuted),
        "region": problem.region,
        "conditions": json.dumps(problem.names),
        "low": json.dumps(problem.low),
        "high": json.dumps(problem.high),
    }
    write_arrays(path, arrays, metadata)


def load(path: Path, problem: Problem) -> Search:
    """Read what `save` wrote. Raises: RunError if it is damaged or of another problem."""
    arrays, metadata = read_arrays(path)
    if metadata.get("problem") != fingerprint(problem):
        raise RunError(
            f"expected boxes of this run's conditions in {path}, found those of another gait, "
            "spec, level or version: certify without --resume"
        )
    _refuse_unsigned(path, metadata)
    points = {
        name: Counterexample(tuple(row["u"]), tuple(row["z"]), row["margin"])
        for name, row in json.loads(metadata["refuted"]).items()
    }
    return Search(_tree(arrays, problem), arrays["seen"], points)


def boxes_saved(path: Path, problem: Problem) -> int:
    """Return how many boxes of this problem a file of `save` has; 0 if none can be read."""
    try:
        return len(load(path, problem).tree.first)
    except (RunError, OSError):
        return 0


def _tree(arrays: Mapping[str, np.ndarray], problem: Problem) -> BoxTree:
    """Rebuild a tree from the arrays of a file."""
    first, axis = (arrays[name].astype(np.int64) for name in ("first", "axis"))
    low, high, cuts = _boxes(first, axis, problem.low, problem.high)
    lower = np.asarray(arrays["lower"])
    upper = np.asarray(arrays.get("upper", np.full_like(lower, np.inf)))
    number = np.flatnonzero((first < 0) & problem.unfinished(lower))
    ends, numbers = (low[number], high[number]), number.astype(np.int32)
    pending = PendingBoxes.unmeasured(numbers, *ends, cuts[number])
    if "alone" in arrays:
        pending = replace(pending, costs=np.asarray(arrays["alone"])[number])
    small = first.astype(np.int32), axis.astype(np.int8), cuts.sum(axis=1).astype(np.int16)
    return BoxTree(low[0], high[0], *small, lower, upper, pending)


def _boxes(
    first: np.ndarray, axis: np.ndarray, low: Corner, high: Corner
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return corners of all boxes, and how often each axis was halved. [N, n] each.

    Raises: RunError if it is no tree.
    """
    inner = first >= 0
    if np.any(first[inner] <= np.flatnonzero(inner)) or np.any(first >= len(first) - 1):
        raise RunError("expected boxes whose halves follow them, found others: the file is damaged")
    if np.any(axis[inner] < 0) or np.any(axis >= len(low)):
        raise RunError("expected halvings of the chart's axes, found others: the file is damaged")
    return boxes_of(first, axis, np.array(low), np.array(high))


def _refuse_unsigned(path: Path, metadata: Mapping[str, str]) -> None:
    """Refuse a file without the sha256 of its content. Raises: RunError."""
    if SHA256 not in metadata:
        raise RunError(
            f"expected boxes with their sha256 in {path}, found none: certify without --resume"
        )


@dataclass(frozen=True)
class OpenBoxes:
    """The boxes of one root on which some condition is not proved.

    Attributes:
        region: region of the root.
        low, high: corners in the chart. [B, n]
        failing: number of them that each condition has, if any.
    """

    region: str
    low: np.ndarray
    high: np.ndarray
    failing: dict[str, int]


def open_boxes(path: Path) -> OpenBoxes:
    """Read the unproved boxes from a file of `save`. Raises: RunError if it is damaged."""
    arrays, metadata = read_arrays(path)
    _refuse_unsigned(path, metadata)
    leaf = arrays["first"] < 0
    low, high = (tuple(json.loads(metadata[end])) for end in ("low", "high"))
    first, axis = (arrays[name].astype(np.int64) for name in ("first", "axis"))
    lows, highs, _ = _boxes(first, axis, low, high)
    fails = ~(arrays["lower"][leaf] >= 0.0)
    some = np.any(fails, axis=1)
    counts = dict(zip(json.loads(metadata["conditions"]), fails.sum(axis=0).tolist(), strict=True))
    return OpenBoxes(
        metadata["region"],
        lows[leaf][some],
        highs[leaf][some],
        {name: count for name, count in counts.items() if count},
    )


def fingerprint(problem: Problem) -> str:
    """Return a hash of everything that bounds depend on."""
    text = json.dumps(
        [
            _KEPT,
            problem.region,
            [float(value).hex() for value in (*problem.low, *problem.high, *problem.scales)],
            problem.names,
            problem.degree,
            problem.program.hash,
            problem.coupled_axes,
        ]
    )
    return hashlib.sha256(text.encode()).hexdigest()
