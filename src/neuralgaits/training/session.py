"""Run one training on disk: from its last checkpoint, or its untrained gait, to its last step."""

import time
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from typing import NamedTuple

import jax

from neuralgaits.analysis.run import Run
from neuralgaits.gait.gaits import Gait
from neuralgaits.gait.policies.commanded_gait import AnyGait
from neuralgaits.gait.posture import posture_path
from neuralgaits.robots.mjcf.parameters import model_of
from neuralgaits.runs.names import START, STATE
from neuralgaits.training.posture_start import start_from_posture
from neuralgaits.training.train_state import TrainState
from neuralgaits.training.trainer import Trainer
from neuralgaits.training.training_loop import GradientSteps, Progress


class Session(NamedTuple):
    """A training after its last step."""

    trainer: Trainer
    steps: GradientSteps
    """Gradient steps, from which a training can continue."""
    state: TrainState
    compile_s: float
    train_s: float

    @property
    def gait(self) -> AnyGait:
        """The gait with the best weights."""
        return self.trainer.gait(self.state.best)


def take_all_steps(run: Run, progress: Progress | None, trainer: Trainer | None = None) -> Session:
    """Take all gradient steps that a run's config requests, with checkpoints.

    Args:
        run: unfinished run with the untrained gait.
        progress: called with (step, steps, loss) now and then.
        trainer: a compiled trainer that fits the run and its seed, if there is one.

    Raises: NonFiniteError.
    """
    if trainer is None:
        trainer = trainer_of(run)
    state = start_of(run, trainer)
    compiling = time.perf_counter()
    compile_steps(trainer, state)
    training = time.perf_counter()
    steps = GradientSteps(run.folder, run.spec, progress)
    steps.forget_after(int(state.step))
    state = steps.take(trainer, state, lambda state: run.folder.write_tree(STATE, state))
    return Session(trainer, steps, state, training - compiling, time.perf_counter() - training)


def trainer_of(run: Run) -> Trainer:
    """Return the trainer for a run's config, not compiled yet."""
    config = run.config
    return Trainer.build(
        model_of(run.robot, run.spec.parameters),
        run.spec,
        run.trained,
        steps=config.steps,
        seed=config.seed,
        residuals=run.residuals,
        disturbance=config.disturbance,
        rate=config.rate,
    )


def compile_steps(trainer: Trainer, state: TrainState) -> None:
    """Compile steps and validation, at once where there are two cores; results are thrown away."""
    with ThreadPoolExecutor(1) as beside:
        validated = beside.submit(trainer.validate, state)
        if not trainer.done(state):
            jax.block_until_ready(trainer.step(state))
        validated.result()


def start_of(run: Run, trainer: Trainer) -> TrainState:
    """Return the last checkpoint if there is one, else the initial state."""
    if (run.path / STATE).is_file():
        return run.folder.read_tree(STATE, trainer.init(run.trained))
    config = run.config
    recipe = run.spec.recipe
    gait = run.trained
    cold = START not in run.folder.copies
    if cold and config.init == "posture" and recipe.posture_steps and isinstance(gait, Gait):
        # This is also the key of gradient step 1 (`gradient_step.py`), which is harmless: here the
        # key is only split, there samples are drawn from it and from keys folded out of it, so no
        # number is drawn twice. Another key would change gaits that a seed names.
        key = jax.random.fold_in(jax.random.key(config.seed), 1)
        gait = start_from_posture(partial(posture_path, run.robot), gait, recipe.posture_steps, key)
    return trainer.init(gait)
