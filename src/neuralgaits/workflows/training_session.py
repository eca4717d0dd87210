"""One training on disk: checkpoints while it runs, a whole run folder when it ends."""

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import NoReturn

import jax
import numpy as np

from neuralgaits.barriers import Gait, GaitSpec
from neuralgaits.errors import NonFiniteError
from neuralgaits.interpreters import Program
from neuralgaits.robots import PlanarBiped
from neuralgaits.runs import RunFolder, finish, write_text
from neuralgaits.training import VALIDATE_EVERY, Loss, Trainer, TrainState, start_from_posture
from neuralgaits.workflows.provable import after_impact, trace_spec
from neuralgaits.workflows.run import PROGRAM, STATE, WEIGHTS

Progress = Callable[[int, int, float], None]
CHECKPOINT_S = 2.0
"""Seconds between two checkpoints."""
FRESH_SAMPLES_SEED = 2**31
"""Seed of the samples the summary is measured on; no run can have it."""
NAN_STATE = "nan.safetensors"


@dataclass(frozen=True)
class TrainingSession:
    """One training, from its folder to its summary."""

    folder: RunFolder
    robot: PlanarBiped
    spec: GaitSpec
    progress: Progress | None
    began: float

    def run(self, root: Path, gait: Gait) -> Gait:
        """Train from the last checkpoint, or from the untrained gait, to the end.

        Returns: the trained gait; the folder is finished. Raises: NonFiniteError.
        """
        config = self.folder.config
        trainer = Trainer.build(
            self.robot, self.spec, gait, steps=config["steps"], seed=config["seed"]
        )
        state, rows = self._start(trainer, gait)
        compiling = time.perf_counter()
        trainer.validate(state)
        if not trainer.done(state):
            jax.block_until_ready(trainer.step(state))
        training = time.perf_counter()
        state = self._loop(trainer, state, rows)
        done = time.perf_counter()
        gait = trainer.gait(state.best)
        self.folder.write_tree(WEIGHTS, gait)
        report = trainer.report(gait, seed=FRESH_SAMPLES_SEED)
        program = self._keep_program(gait)
        summary = {
            "run": str(self.folder.path),
            "robot": config["robot"],
            "spec": config["spec"],
            "seed": config["seed"],
            "steps": int(state.step),
            "loss": report.loss,
            "conditions": {name: violations(margins) for name, margins in report.margins.items()},
            "provable": program is not None,
            "program_hash": None if program is None else program.hash,
            "after_impact": after_impact(self.robot, gait),
            "compile_s": training - compiling,
            "train_s": done - training,
            "wall_s": time.perf_counter() - self.began,
        }
        finish(self.folder, summary, root)
        return gait

    def _keep_program(self, gait: Gait) -> Program | None:
        """Save the Program of the trained gait: what every other interpreter reads."""
        if self.folder.config["not_provable_because"] is not None:
            return None
        program = trace_spec(self.spec, self.robot, gait)
        write_text(self.folder.path / PROGRAM, program.to_json())
        return program

    def _start(self, trainer: Trainer, gait: Gait) -> tuple[TrainState, list[Mapping[str, float]]]:
        """The last checkpoint if there is one, else the beginning."""
        if (self.folder.path / STATE).is_file():
            state = self.folder.read_tree(STATE, trainer.init(gait))
            rows = [row for row in self.folder.read_metrics() if row["step"] <= int(state.step)]
            return state, list(rows)
        config, recipe = self.folder.config, self.spec.recipe
        if config["init"] == "posture" and recipe.posture_steps:
            key = jax.random.fold_in(jax.random.key(config["seed"]), 1)
            gait = start_from_posture(self.robot, gait, recipe.posture_steps, key)
        return trainer.init(gait), []

    def _loop(
        self, trainer: Trainer, state: TrainState, rows: list[Mapping[str, float]]
    ) -> TrainState:
        saved = time.perf_counter()
        kept = state
        while not trainer.done(state):
            state, loss = trainer.step(state)
            step = int(state.step)
            if step % VALIDATE_EVERY and not trainer.done(state):
                continue
            if not (np.isfinite(float(loss.total)) and np.isfinite(state.parameters).all()):
                self._refuse_nan(trainer, kept)
            state = trainer.validate(state)
            kept = state
            rows.append(self._row(step, loss, state))
            if self.progress is not None:
                self.progress(step, trainer.steps, float(loss.total))
            if time.perf_counter() - saved > CHECKPOINT_S or trainer.done(state):
                self.folder.write_metrics(rows)
                self.folder.write_tree(STATE, state)
                saved = time.perf_counter()
        return state

    def _row(self, step: int, loss: Loss, state: TrainState) -> dict[str, float]:
        names = [condition.name for condition in self.spec.conditions]
        terms = dict(zip(names, np.asarray(loss.terms).tolist(), strict=True))
        head = {
            "step": step,
            "loss": float(loss.total),
            "validation_loss": float(state.best_loss),
            "effort": float(loss.effort),
        }
        return head | terms

    def _refuse_nan(self, trainer: Trainer, kept: TrainState) -> NoReturn:
        """Save the last good state, and walk on from it to the step that turned to NaN."""
        self.folder.write_tree(STATE, kept)
        self.folder.write_tree(NAN_STATE, kept)
        state, loss = trainer.step(kept)
        while np.isfinite(float(loss.total)) and not trainer.done(state):
            state, loss = trainer.step(state)
        names = [condition.name for condition in self.spec.conditions]
        bad = [n for n, v in zip(names, np.asarray(loss.terms), strict=True) if not np.isfinite(v)]
        raise NonFiniteError(
            f"loss or weights are not finite at step {int(state.step)} (conditions: "
            f"{', '.join(bad) or 'none: the sum or its gradient'}); state of step "
            f"{int(kept.step)} kept, reproduce with "
            f"`neuralgaits train {self.folder.config['robot']} --resume {self.folder.path}`"
        )


def violations(margins: np.ndarray) -> dict[str, float]:
    """Mean and largest violation of margins >= 0, and the smallest margin."""
    below = np.maximum(-margins, 0.0)
    return {
        "mean_violation": float(np.mean(below)),
        "max_violation": float(np.max(below)),
        "min_margin": float(np.min(margins)),
    }
