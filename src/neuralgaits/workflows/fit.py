"""Learn a robot's deviation from the model from logs of its walks."""

import hashlib
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from neuralgaits import logs as walks
from neuralgaits._types import Array, Float
from neuralgaits.analysis.learned import LearnedResiduals
from neuralgaits.analysis.recorded_gait import refuse_logs_of_another
from neuralgaits.analysis.run import Run, open_run
from neuralgaits.analysis.walk_log import GAIT_FILES
from neuralgaits.errors import InputError
from neuralgaits.gait import ZeroDynamics
from neuralgaits.gait.flow_residual import Residual
from neuralgaits.gait.zero_coordinates import momenta_of
from neuralgaits.logs import Split, Stride, Windows
from neuralgaits.records.fitted import FitSummary, StrideCounts
from neuralgaits.residual.fitter import FitConfig, Fitter
from neuralgaits.residual.fitter import fit as fit_flow
from neuralgaits.residual.floor import floor
from neuralgaits.residual.reset import fit_reset
from neuralgaits.residual.trajectories import largest_defects, prediction_errors, root_mean_square
from neuralgaits.residual.trust import landing_errors
from neuralgaits.runs.atomic import refuse_unwritable
from neuralgaits.runs.hashes import file_hashes
from neuralgaits.runs.names import FIT_SUMMARY, LEARNED_RESIDUAL
from neuralgaits.settings import FitSettings, called_with

SAMPLES = 3
"""Samples of the windows that are learned from, as in the paper's code."""
STEP_S = 0.01
"""Spacing of the samples of a window [s], as in the paper's code."""
JUDGED_SAMPLES = 11
"""Samples of the windows on which errors are reported: 0.1 s."""


@dataclass(frozen=True)
class Fit:
    """Result of a fit.

    Attributes:
        residual: file of the residual.
        learned: content of the file.
        summary: what `fit --json` prints.
    """

    residual: Path
    learned: LearnedResiduals
    summary: FitSummary


@called_with(FitSettings)
def fit(settings: FitSettings) -> Fit:
    """Learn residuals of the flow and of the reset map from logs of a run's policy.

    Strides are split into training, validation and test sets before windows are cut. The residual
    is relative to the rigid model; a residual that the run was trained with is ignored. A log in
    the folder of a run is refused where its record names another gait than this run's.

    Returns: `Fit`. Residual and summary are in the run's folder.
    Raises: InputError with file, row, column and remedy; then nothing is written.
    """
    start_time = time.perf_counter()
    config = settings.config or FitConfig(optimizer=settings.optimizer)
    logs = settings.logs
    columns = settings.columns
    seed = settings.seed
    trained = open_run(settings.run)
    refuse_unwritable(trained.path / LEARNED_RESIDUAL, trained.path / FIT_SUMMARY, own=True)
    refuse_logs_of_another(trained, logs)
    policy = trained.gait.policy
    read, left_out = walks.read_all(logs, trained.robot, columns=columns, policy=policy, mend=True)
    cut = walks.cut(read, trained.robot)
    long, short = _long_enough(cut.strides)
    zd = ZeroDynamics(trained.robot, policy)
    parts = _dealt(long, seed, cut.left_out, sum(map(len, read)))
    scale = _scale(trained, long)
    train, validation = _windows(parts.train), _windows(parts.validation)
    fitter = Fitter.build(zd, train, validation, scale, config=config, seed=seed)
    flow, state = fit_flow(fitter, settings.progress)
    corrected = ZeroDynamics(zd.robot, zd.policy, flow)
    reset = fit_reset(corrected, walks.touchdowns([*parts.train, *parts.validation], zd))
    # Pairs of samples reach further into a stride's end than the windows of the fit.
    pairs = walks.windows(parts.heldout, samples=2, step=STEP_S)
    learned = LearnedResiduals(flow, reset, largest_defects(prediction_errors(zd, flow, pairs)))
    path = trained.path / LEARNED_RESIDUAL
    learned.write(path)
    summary = FitSummary(
        run=str(trained.path),
        residual=str(path),
        residual_sha256=hashlib.sha256(path.read_bytes()).hexdigest(),
        sha256=file_hashes(trained.path, GAIT_FILES),
        logs=tuple(str(log) for log in logs),
        columns=None if columns is None else str(columns),
        computed=tuple(dict.fromkeys(what for log in read for what in log.computed)),
        optimizer=config.optimizer,
        seed=seed,
        steps=int(state.step),
        windows=len(train.z),
        strides=StrideCounts(**{name: len(part) for name, part in parts._asdict().items()}),
        walked_s=float(sum(log.t[-1] - log.t[0] for log in read)),
        left_out=left_out | cut.left_out | {"short strides": short},
        bound=_pair(flow.bound),
        error_bound=_pair(learned.error_bound),
        **_errors(zd, flow, config, parts, scale),
        touchdowns=landing_errors(corrected, reset, walks.touchdowns(parts.heldout, zd)),
        wall_s=time.perf_counter() - start_time,
    )
    trained.folder.write_json(FIT_SUMMARY, summary)
    return Fit(path, learned, summary)


def _pair(values: Float[np.ndarray, "2"] | Array) -> tuple[float, float]:
    return float(values[0]), float(values[1])


def _long_enough(strides: Sequence[Stride]) -> tuple[list[Stride], int]:
    """Return the strides that errors can be reported on, and the number of rows of the others."""
    long = [stride for stride in strides if len(_judging_windows([stride]).z)]
    return long, sum(stride.t.size for stride in strides) - sum(stride.t.size for stride in long)


def _dealt(strides: Sequence[Stride], seed: int, left_out: Mapping[str, int], rows: int) -> Split:
    if len(strides) < 3:
        remedy = "walk longer or give more logs"
        meanings = {
            "falling": "joints are far from what the gait asks, or the hip far from above the "
            "foot: it falls there, or a sign, a zero or a unit is not the robot file's",
            "standing": "one leg stands for longer than a step: the robot stands still there, or "
            "contacts do not tell one leg from the other",
        }
        for why, meaning in meanings.items():
            if 2 * left_out[why] > rows:
                remedy = f"{left_out[why]} of {rows} rows are left out, because {meaning}"
        raise InputError(
            f"logs: expected at least 3 strides of {STEP_S * (JUDGED_SAMPLES - 1):.2g} s or more, "
            f"one each to learn from, to choose by and to report on, found {len(strides)}: {remedy}"
        )
    return walks.split(strides, seed=seed)


def _windows(strides: Sequence[Stride]) -> Windows:
    return walks.windows(strides, samples=SAMPLES, step=STEP_S)


def _judging_windows(strides: Sequence[Stride]) -> Windows:
    return walks.windows(strides, samples=JUDGED_SAMPLES, step=STEP_S)


def _scale(run: Run, strides: Sequence[Stride]) -> Float[np.ndarray, "2"]:
    """Return the units of errors: step length and median momentum (m, kg m^2/s)."""
    start, guard = (float(end) for end in run.gait.span)
    momenta = np.concatenate([momenta_of(stride.z) for stride in strides])
    return np.array([guard - start, np.median(np.abs(momenta))])


def _errors(
    zd: ZeroDynamics,
    flow: Residual,
    config: FitConfig,
    parts: Split,
    scale: Float[np.ndarray, "2"],
) -> dict[str, float]:
    """Return root mean square errors over 0.1 s in scaled z, by name."""
    nothing = Residual.like(config.hidden)

    def error(residual: Residual, judged: Windows) -> float:
        return root_mean_square(prediction_errors(zd, residual, judged).errors, scale)

    train, heldout = _judging_windows(parts.train), _judging_windows(parts.heldout)
    learned_from = _windows(parts.train)
    defects = prediction_errors(zd, nothing, learned_from).defects
    return {
        "train_error": error(flow, train),
        "nominal_train_error": error(nothing, train),
        "heldout_error": error(flow, heldout),
        "nominal_heldout_error": error(nothing, heldout),
        # A defect is the mean over an interval: it belongs to the middle.
        "binned_floor": floor(zd, learned_from.z[:, :2].mean(axis=1), defects, heldout, scale),
    }
