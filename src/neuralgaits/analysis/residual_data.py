"""The residual of a run on the plane of its gait, computed once and kept in the run."""

import hashlib
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from neuralgaits import logs
from neuralgaits.analysis.data import ResidualData
from neuralgaits.analysis.gait_data import fingerprint, gait_data
from neuralgaits.analysis.learned import LearnedResiduals
from neuralgaits.analysis.point_evaluator import PointEvaluator
from neuralgaits.analysis.run import Run
from neuralgaits.analysis.walk_log import GAIT_FILES
from neuralgaits.errors import InputError, RunError
from neuralgaits.records.fitted import FittedGait, Logs
from neuralgaits.runs import read_arrays, write_arrays
from neuralgaits.runs.arrays import SHA256
from neuralgaits.runs.hashes import other_file
from neuralgaits.runs.names import FIT_SUMMARY, LEARNED_RESIDUAL, RESIDUAL

FILE = "figures/residual.safetensors"


def residual_data(run: Run) -> ResidualData | None:
    """Return data of the residual used in training, else of the one learned from logs.

    Returns: None if the run has neither, or if its record says that another gait walked.
    """
    trained = run.learned is not None
    path = run.path / (RESIDUAL if trained else LEARNED_RESIDUAL)
    if not path.is_file() or (not trained and _is_foreign(run)):
        return None
    gait = gait_data(run)
    of = hashlib.sha256(fingerprint(run).encode() + path.read_bytes()).hexdigest()
    file = run.path / FILE
    if file.is_file():
        try:
            arrays, words = read_arrays(file)
        except RunError:
            arrays, words = {}, {}
        if SHA256 in words and words.get("of") == of:
            return ResidualData(gait, arrays["epsilon"], arrays["visited"], trained)
    flow = LearnedResiduals.read(path, run.robot.n - 1).flow
    evaluate = PointEvaluator(lambda z: {"epsilon": flow(z)})
    z1, z2 = gait["plane/z1"], gait["plane/z2"]
    grid = np.stack(np.meshgrid(z1, z2), axis=-1)
    epsilon = evaluate(grid.reshape(-1, 2))["epsilon"].reshape(grid.shape)
    visited = _visited(run, trained)
    write_arrays(file, {"epsilon": epsilon, "visited": visited}, {"of": of})
    return ResidualData(gait, epsilon, visited, trained)


def _is_foreign(run: Run) -> bool:
    """Return whether the record of the run's learned residual is about another gait."""
    try:
        recorded = FittedGait.read(run.path / FIT_SUMMARY).sha256
    except RunError:
        return False
    return other_file(run.path, recorded, GAIT_FILES) is not None


def _visited(run: Run, trained: bool) -> np.ndarray:
    """Return the states of the logs behind the residual, where the logs still exist. [K, 2]."""
    parent = run.config.parent
    places = [run.path.parent / Path(parent).name, Path(parent)] if trained and parent else []
    for place in places or [run.path]:
        try:
            return _states(run, Logs.read(place / FIT_SUMMARY).logs, place)
        except RunError:
            # Without it the picture has no dots.
            continue
    return np.zeros((0, 2))


def _states(run: Run, paths: Sequence[str], place: Path) -> np.ndarray:
    parts = []
    for name in paths:
        path = Path(name)
        candidates = [path, *place.glob(f"*/{path.name}"), *place.glob(f"*/*/{path.name}")]
        path = next((candidate for candidate in candidates if candidate.is_file()), None)
        if path is None:
            continue
        try:
            z = logs.read(path, run.robot).log.z
        except InputError:
            continue
        if z is not None:
            parts.append(z)
        if len(parts) == 4:  # The picture needs no more logs.
            break
    states = np.concatenate(parts) if parts else np.zeros((0, 2))
    most_states = 2500
    return states[:: max(len(states) // most_states, 1)]
