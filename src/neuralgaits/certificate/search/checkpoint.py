"""A search on disk, so that a later one goes on where it ended."""

import hashlib
import json
from collections.abc import Mapping
from dataclasses import dataclass, fields
from pathlib import Path

import numpy as np

from neuralgaits.certificate.search.box_tree import BoxTree
from neuralgaits.certificate.search.branch_and_bound import Search
from neuralgaits.certificate.search.problem import Problem
from neuralgaits.errors import RunError
from neuralgaits.records.certified import Counterexample
from neuralgaits.runs import read_arrays, write_arrays
from neuralgaits.runs.arrays import SHA256

_FIELDS = tuple(item.name for item in fields(BoxTree) if item.name != "late")


def save(path: Path, problem: Problem, state: Search) -> None:
    """Write one root's boxes, whole or not at all."""
    arrays = {name: getattr(state.tree, name) for name in _FIELDS} | {"seen": state.seen}
    refuted = {
        name: {"u": point.u, "z": point.z, "margin": point.margin}
        for name, point in state.refuted.items()
    }
    metadata = {
        "problem": fingerprint(problem),
        "refuted": json.dumps(refuted),
        "region": problem.region,
        "conditions": json.dumps(problem.names),
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
    fields_of = {name: np.asarray(arrays[name]) for name in _FIELDS}
    tree = BoxTree(**fields_of, late=problem.late)
    return Search(tree, arrays["seen"], points)


def _refuse_unsigned(path: Path, metadata: Mapping[str, str]) -> None:
    """Raises: RunError for a file without the sha256 that makes sure that it is what was saved."""
    if SHA256 not in metadata:
        raise RunError(
            f"expected boxes with their sha256 in {path}, found none: certify without --resume"
        )


@dataclass(frozen=True)
class OpenBoxes:
    """The boxes of one root on which some condition is not proved.

    Attributes:
        region: of the root.
        low, high: corners in the chart. [B, n]
        failing: how many of them each condition has, if any.
    """

    region: str
    low: np.ndarray
    high: np.ndarray
    failing: dict[str, int]


def open_boxes(path: Path) -> OpenBoxes:
    """Read what is not proved yet from a file of `save`. Raises: RunError if it is damaged."""
    arrays, metadata = read_arrays(path)
    _refuse_unsigned(path, metadata)
    leaf = arrays["first"] < 0
    fails = ~(arrays["lower"][leaf] >= 0.0)
    some = np.any(fails, axis=1)
    counts = dict(zip(json.loads(metadata["conditions"]), fails.sum(axis=0).tolist(), strict=True))
    return OpenBoxes(
        metadata["region"],
        arrays["low"][leaf][some],
        arrays["high"][leaf][some],
        {name: count for name, count in counts.items() if count},
    )


def fingerprint(problem: Problem) -> str:
    """What bounds depend on, as a hash."""
    text = json.dumps(
        [
            _FIELDS,
            problem.region,
            [float(value).hex() for value in (*problem.low, *problem.high, *problem.scales)],
            problem.names,
            problem.degree,
            problem.program.hash,
        ]
    )
    return hashlib.sha256(text.encode()).hexdigest()
