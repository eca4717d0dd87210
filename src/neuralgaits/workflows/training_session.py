"""One training on disk: checkpoints while it runs, a whole run folder when it ends."""

import time
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

import jax
import numpy as np

from neuralgaits.analysis.run import learned_of, residuals_of
from neuralgaits.barriers import Gait, GaitSpec
from neuralgaits.errors import Interrupted
from neuralgaits.gait import Residuals
from neuralgaits.programs import Program
from neuralgaits.records.asked import asked_of
from neuralgaits.records.trained import Trained, Violations
from neuralgaits.robots import PlanarBiped
from neuralgaits.runs import RunFolder, finish, write_text
from neuralgaits.runs.commands import resuming
from neuralgaits.runs.names import PROGRAM, START, STATE, WEIGHTS
from neuralgaits.training import Trainer, TrainState, start_from_posture
from neuralgaits.training.gradient_steps import GradientSteps, Progress
from neuralgaits.workflows.proof_rounds import ProofRounds, Watch
from neuralgaits.workflows.provable import after_impact, trace_spec

FRESH_SAMPLES_SEED = 2**31
"""Seed of the samples the summary is measured on; no run can have it."""


@dataclass(frozen=True)
class TrainingSession:
    """One training, from its folder to its summary."""

    folder: RunFolder
    robot: PlanarBiped
    spec: GaitSpec
    progress: Progress | None
    watch: Watch
    began: float

    def run(self, root: Path, gait: Gait) -> Gait:
        """Train from the last checkpoint, or from the untrained gait, to the end.

        Returns: the trained gait; the folder is finished.
        Raises: NonFiniteError; Interrupted for KeyboardInterrupt.
        """
        try:
            return self._run(root, gait)
        except KeyboardInterrupt as stop:
            raise Interrupted(resuming(self.folder.path)) from stop

    def _run(self, root: Path, gait: Gait) -> Gait:
        asked = asked_of(self.folder)
        residuals = residuals_of(learned_of(self.folder, self.robot))
        trainer = Trainer.build(
            self.robot,
            self.spec,
            gait,
            steps=asked.steps,
            seed=asked.seed,
            residuals=residuals,
            disturbance=asked.disturbance,
            rate=asked.rate,
        )
        state = self._start(trainer, gait)
        compiling = time.perf_counter()
        # Two programs to compile and at least two cores: results are thrown away.
        with ThreadPoolExecutor(1) as beside:
            validated = beside.submit(trainer.validate, state)
            if not trainer.done(state):
                jax.block_until_ready(trainer.step(state))
            validated.result()
        training = time.perf_counter()
        steps = GradientSteps(self.folder, self.spec, self.progress)
        steps.forget_after(int(state.step))
        state = steps.take(trainer, state, self._save)
        done = time.perf_counter()
        gait, proof = trainer.gait(state.best), None
        if asked.certify is None:
            self.folder.write_tree(WEIGHTS, gait)
        else:
            rounds = ProofRounds(self.folder, self.robot, self.spec, steps, self.watch)
            gait, proof = rounds.run(trainer, gait, asked.certify.budget_s)
        report = trainer.report(gait, seed=FRESH_SAMPLES_SEED)
        program = self._keep_program(gait, residuals)
        summary = Trained(
            run=str(self.folder.path),
            robot=asked.robot,
            spec=asked.spec,
            seed=asked.seed,
            steps=int(state.step) + (0 if proof is None else proof.repair_steps),
            loss=report.loss,
            conditions={name: violations(margins) for name, margins in report.margins.items()},
            provable=program is not None,
            program_hash=None if program is None else program.hash,
            after_impact=after_impact(self.robot, gait, residuals),
            certificate=proof,
            compile_s=training - compiling,
            train_s=done - training,
            wall_s=time.perf_counter() - self.began,
        )
        finish(self.folder, summary, root)
        return gait

    def _save(self, state: TrainState) -> None:
        self.folder.write_tree(STATE, state)

    def _keep_program(self, gait: Gait, residuals: Residuals) -> Program | None:
        """Save the Program of the trained gait: what every other interpreter reads."""
        if asked_of(self.folder).not_provable_because is not None:
            return None
        program = trace_spec(self.spec, self.robot, gait, residuals)
        write_text(self.folder.path / PROGRAM, program.to_json())
        return program

    def _start(self, trainer: Trainer, gait: Gait) -> TrainState:
        """The last checkpoint if there is one, else the beginning."""
        if (self.folder.path / STATE).is_file():
            return self.folder.read_tree(STATE, trainer.init(gait))
        asked, recipe = asked_of(self.folder), self.spec.recipe
        cold = START not in self.folder.copies
        if cold and asked.init == "posture" and recipe.posture_steps:
            key = jax.random.fold_in(jax.random.key(asked.seed), 1)
            gait = start_from_posture(self.robot, gait, recipe.posture_steps, key)
        return trainer.init(gait)


def violations(margins: np.ndarray) -> Violations:
    """What margins of samples say of a condition."""
    below = np.maximum(-margins, 0.0)
    return Violations(float(np.mean(below)), float(np.max(below)), float(np.min(margins)))
