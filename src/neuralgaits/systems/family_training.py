"""Train the controller of a family beside walkers, and leave a run folder."""

import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import jax
import numpy as np

from neuralgaits.errors import NonFiniteError
from neuralgaits.runs import RUNS_ROOT, RunFolder, finish
from neuralgaits.runs.names import ROBOT, SPEC, WEIGHTS
from neuralgaits.runs.only_writer import only_writer
from neuralgaits.systems.family_files import robot_text
from neuralgaits.systems.family_run import FamilyRun
from neuralgaits.systems.trained_system import TrainedSystem, TrainingProgress


def train_family(
    system: TrainedSystem,
    source: str | Path,
    config: Any,
    *,
    out: Path | None = None,
    root: Path = RUNS_ROOT,
    progress: TrainingProgress | None = None,
    begun: Callable[[], None] | None = None,
) -> FamilyRun:
    """Train a controller and the set that is to be proved.

    Args:
        system: system of the family.
        source: name of a built-in robot, or the path of an MJCF file.
        config: settings of the training, a `FamilyConfig` of the system; `robot` is filled in.
        out: run folder to make; a new one below `root` if None.
        root: folder of the runs.
        progress: called now and then.
        begun: called when the robot is read and compiling begins.

    Raises: RobotError if the file is none of the family; NonFiniteError on NaN in its weights.
    """
    start_time = time.perf_counter()
    text, name = robot_text(system, source)
    robot, data = system.read(text, name)
    config = replace(config, robot=robot.name)
    sources = [file.read_text(encoding="utf-8") for file in system.spec_files]
    copies = {ROBOT: text, SPEC: "\n\n".join(sources)}
    folder = RunFolder.create(config, copies, name=robot.name, seed=config.seed, root=root, out=out)
    with only_writer(folder.path):
        if begun is not None:
            begun()
        controller = system.train(robot, config, progress)
        run = FamilyRun(system, folder, config, robot, data, controller)
        if not all(np.isfinite(leaf).all() for leaf in jax.tree.leaves(controller)):
            raise NonFiniteError(
                f"expected finite weights after training, found NaN: train with another --seed; "
                f"{folder.path} stays unfinished"
            )
        folder.write_tree(WEIGHTS, controller)
        finish(folder, summary_of(run, time.perf_counter() - start_time), root)
    return run


def summary_of(run: FamilyRun, wall_s: float) -> Any:
    """Measure a trained controller at fresh random states."""
    config = run.config
    return run.system.summary(
        run=str(run.path),
        robot=config.robot,
        spec=config.spec,
        seed=config.seed,
        steps=config.steps,
        wall_s=wall_s,
        **run.system.measured(run),
    )
