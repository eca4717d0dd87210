"""Train a cart-pole's controller and leave a run folder."""

import time
from dataclasses import replace
from pathlib import Path

import jax
import numpy as np

from neuralgaits.errors import InputError, NonFiniteError
from neuralgaits.runs import RUNS_ROOT, RunFolder, finish
from neuralgaits.runs.names import ROBOT, SPEC, WEIGHTS
from neuralgaits.runs.only_writer import only_writer
from neuralgaits.systems.cartpole import balancing as conditions
from neuralgaits.systems.cartpole.cartpole_run import (
    WIDEST,
    CartPoleConfig,
    CartPoleRun,
    CartPoleTrained,
    volume,
    widths,
)
from neuralgaits.systems.cartpole.cartpole_training import (
    HIDDEN,
    Progress,
    of_samples,
    train_controller,
)
from neuralgaits.systems.cartpole.mjcf import cartpole_text, read_cartpole

STEPS, RATE = 3000, 0.05
"""Gradient steps, and the required decay of the set's radius [1/s], if not given."""
FRESH_SEED, FRESH = 2**31, 2**16
"""Seed and number of the states on which the summary is measured; no run can have that seed."""


def train_cartpole(
    source: str | Path,
    *,
    seed: int = 0,
    steps: int | None = None,
    width: int | None = None,
    out: Path | None = None,
    root: Path = RUNS_ROOT,
    progress: Progress | None = None,
) -> CartPoleRun:
    """Train a controller and the set that is to be proved.

    Args:
        source: the built-in `cartpole`, or the path of an MJCF file.
        seed: of weights and samples.
        steps: gradient steps; `STEPS` if None.
        width: of the network's hidden layer; `HIDDEN` if None.
        out: run folder to make; a new one below `root` if None.
        root: folder of the runs.
        progress: called now and then.

    Raises: RobotError if the file is no cart-pole; InputError on bad settings; NonFiniteError if
        the training ends in NaN.
    """
    start_time = time.perf_counter()
    config = CartPoleConfig(
        robot="",
        seed=seed,
        steps=STEPS if steps is None else steps,
        width=HIDDEN if width is None else width,
        rate=RATE,
    )
    if not 1 <= config.width <= WIDEST:
        raise InputError(f"hidden: expected a width from 1 to {WIDEST}, found {config.width}")
    text, name = cartpole_text(source)
    robot, data = read_cartpole(text, name)
    config = replace(config, robot=robot.name)
    spec = Path(conditions.__file__).read_text(encoding="utf-8")
    copies = {ROBOT: text, SPEC: spec}
    folder = RunFolder.create(config, copies, name=robot.name, seed=seed, root=root, out=out)
    with only_writer(folder.path):
        controller = train_controller(
            robot,
            seed=seed,
            steps=config.steps,
            rate=config.rate,
            width=config.width,
            progress=progress,
        )
        run = CartPoleRun(folder, config, robot, data, controller)
        if not all(np.isfinite(leaf).all() for leaf in jax.tree.leaves(controller)):
            raise NonFiniteError(
                f"expected finite weights after training, found NaN: train with another --seed; "
                f"{folder.path} stays unfinished"
            )
        folder.write_tree(WEIGHTS, controller)
        finish(folder, summary_of(run, time.perf_counter() - start_time), root)
    return run


def summary_of(run: CartPoleRun, wall_s: float) -> CartPoleTrained:
    """Measure a trained controller at fresh random states."""
    robot, controller, config = run.robot, run.controller, run.config
    found = of_samples(robot, controller, config.rate, jax.random.key(FRESH_SEED), FRESH)
    return CartPoleTrained(
        run=str(run.path),
        robot=config.robot,
        spec=config.spec,
        seed=config.seed,
        steps=config.steps,
        margins={name: float(np.min(rows)) for name, rows in found.items()},
        samples=FRESH,
        widths=widths(controller),
        volume=volume(controller),
        wall_s=wall_s,
    )
