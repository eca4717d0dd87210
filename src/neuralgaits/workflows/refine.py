"""Continue training a gait on zero dynamics that logs have corrected."""

import time
from dataclasses import replace
from pathlib import Path
from typing import Literal

from neuralgaits._settings import (
    check_disturbance,
    check_proof_budget,
    check_seed,
    check_steps,
)
from neuralgaits.analysis.learned import Learned
from neuralgaits.analysis.run import Run, open_run
from neuralgaits.errors import InputError, RunError
from neuralgaits.records.training_config import Proving
from neuralgaits.runs import RUNS_ROOT, RunFolder
from neuralgaits.runs.names import FITTED, RESIDUAL, ROBOT, SPEC, START, WEIGHTS
from neuralgaits.runs.shell_words import learning
from neuralgaits.training.training_loop import Progress
from neuralgaits.workflows.proof_rounds import Watch
from neuralgaits.workflows.train import train_to_the_end

STEPS_SHARE = 0.7
"""Gradient steps, as a share of those of the recipe: the gait is nearly trained."""
RATE = 0.5
"""Learning rate, as a share of that of the recipe."""


def refine(
    run: Run | str | Path,
    *,
    residual: str | Path | None = None,
    seed: int = 0,
    steps: int | None = None,
    out: str | Path | None = None,
    disturbance: tuple[float, float] | Literal["learned"] | None = None,
    certify: bool = False,
    budget: float | None = None,
    progress: Progress | None = None,
    watch: Watch | None = None,
    root: Path = RUNS_ROOT,
) -> Run:
    """Continue training a run's policy, on zero dynamics with residuals.

    Args:
        run: run whose policy and tube training starts from, its folder, or `latest`.
        residual: file of `fit`; that of the run if None.
        seed: seed of samples.
        steps: gradient steps; a share of those of the recipe if None.
        out: the new run's folder; `runs/ROBOT/<UTC time>-<seed>` if None.
        disturbance: bounds on the disturbance of dz besides the residual (m/s, N m); training lets
            every sample meet a corner of them. "learned": the remaining error of the residual on
            held-out strides, see `fit`.
        certify: prove the conditions on the corrected dynamics (level 1), and continue training
            where that fails, as `train` does.
        budget: seconds for proofs and further training; None for no limit.
        progress: called with (step, steps, loss) now and then.
        watch: callbacks about the progress of the proof.
        root: folder of the runs.

    Returns: the new run, which carries the residual and the weights it started from.
    Raises: InputError on bad settings or a residual that does not fit; NonFiniteError if the loss
        turned to NaN.
    """
    start_time = time.perf_counter()
    parent = open_run(run)
    if parent.spec.parameters:
        raise InputError(
            f"expected a run for one robot to refine, found {parent.path}, whose gait is for a box "
            "of them: a residual is learned of one robot; train without --parameters"
        )
    file = parent.path / FITTED if residual is None else Path(residual)
    if residual is None and not file.is_file():
        raise RunError(
            f"expected a residual of {parent.path}, found no {FITTED} in it: learn one from a "
            f"robot's logs, or as in `{learning(parent.path)}`, or give --residual FILE"
        )
    learned = Learned.read(file, parent.robot)
    if disturbance == "learned":
        disturbance = (float(learned.error_bound[0]), float(learned.error_bound[1]))
    if disturbance is not None:
        check_disturbance(disturbance)
    check_seed(seed)
    check_steps(steps)
    check_proof_budget(certify, budget)
    config = replace(
        parent.asked,
        seed=seed,
        steps=round(STEPS_SHARE * parent.spec.recipe.steps) if steps is None else steps,
        rate=RATE,
        disturbance=disturbance,
        certify=Proving(budget) if certify else None,
        parent=str(parent.path),
    )
    copies = {
        ROBOT: parent.folder.copy(ROBOT),
        SPEC: parent.folder.copy(SPEC),
        START: (parent.path / WEIGHTS).read_bytes(),
        RESIDUAL: file.read_bytes(),
    }
    place = None if out is None else Path(out)
    folder = RunFolder.create(
        config, copies, name=parent.robot.name, seed=seed, root=root, out=place
    )
    child = Run(folder, parent.robot, parent.spec, parent.trained)
    return train_to_the_end(child, progress=progress, watch=watch, root=root, start_time=start_time)
