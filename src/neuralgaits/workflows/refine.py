"""Continue training a gait on zero dynamics that logs have corrected."""

import time
from dataclasses import replace
from pathlib import Path

from neuralgaits._checks import check_disturbance
from neuralgaits.analysis.learned import LearnedResiduals
from neuralgaits.analysis.recorded_gait import refuse_residual_of_another
from neuralgaits.analysis.run import Run, open_run
from neuralgaits.errors import InputError, RunError
from neuralgaits.records.training_config import Proving
from neuralgaits.runs import RunFolder
from neuralgaits.runs.names import LEARNED_RESIDUAL, RESIDUAL, ROBOT, SPEC, START, WEIGHTS
from neuralgaits.runs.shell_words import learning
from neuralgaits.settings import RefineSettings, called_with
from neuralgaits.settings.forms import LEARNED
from neuralgaits.workflows.train import train_to_the_end


@called_with(RefineSettings)
def refine(settings: RefineSettings) -> Run:
    """Continue training a run's policy, on zero dynamics with residuals.

    With a disturbance, training lets every sample meet a corner of its bounds.

    Returns: the new run, which carries the residual and the weights it started from.
    Raises: InputError on bad settings or a residual of another gait; NonFiniteError if the loss
        turned to NaN.
    """
    start_time = time.perf_counter()
    parent = open_run(settings.run)
    if parent.spec.parameters:
        raise InputError(
            f"expected a run for one robot to refine, found {parent.path}, whose gait is for a box "
            "of them: a residual is learned of one robot; train without --parameters"
        )
    file = parent.path / LEARNED_RESIDUAL if settings.residual is None else Path(settings.residual)
    if settings.residual is None and not file.is_file():
        raise RunError(
            f"expected a residual of {parent.path}, found no {LEARNED_RESIDUAL} in it: learn one "
            f"from a robot's logs, or as in `{learning(parent.path)}`, or give --residual FILE"
        )
    learned = LearnedResiduals.read(file, parent.robot.n - 1)
    refuse_residual_of_another(parent, file)
    disturbance = settings.disturbance
    if disturbance == LEARNED:
        disturbance = (float(learned.error_bound[0]), float(learned.error_bound[1]))
    if disturbance is not None:
        check_disturbance(disturbance)
    # Fewer than the recipe has: the gait is nearly trained.
    usual_steps = round(0.7 * parent.spec.recipe.steps)
    config = replace(
        parent.config,
        seed=settings.seed,
        steps=usual_steps if settings.steps is None else settings.steps,
        rate=0.5,  # Of the recipe's.
        disturbance=disturbance,
        certify=Proving(settings.budget) if settings.certify else None,
        parent=str(parent.path),
    )
    copies = {
        ROBOT: parent.folder.copy(ROBOT),
        SPEC: parent.folder.copy(SPEC),
        START: (parent.path / WEIGHTS).read_bytes(),
        RESIDUAL: file.read_bytes(),
    }
    root = settings.root
    place = None if settings.out is None else Path(settings.out)
    folder = RunFolder.create(
        config, copies, name=parent.robot.name, seed=settings.seed, root=root, out=place
    )
    child = Run(folder, parent.robot, parent.spec, parent.trained)
    return train_to_the_end(
        child,
        progress=settings.progress,
        watch=settings.watch,
        root=root,
        start_time=start_time,
    )
