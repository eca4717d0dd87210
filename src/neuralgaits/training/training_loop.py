"""Take gradient steps with checkpoints, for a training and each of its repairs.

The gradient itself is in `gradient_step`.
"""

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import NoReturn

import jax
import numpy as np

from neuralgaits.barriers import GaitSpec, specs
from neuralgaits.errors import NonFiniteError
from neuralgaits.records.trained import EndedInNan
from neuralgaits.records.training_config import config_of
from neuralgaits.robots.mjcf.parameters import nominal_robot
from neuralgaits.runs import RunFolder
from neuralgaits.runs.names import NAN, NAN_STATE
from neuralgaits.runs.shell_words import resuming
from neuralgaits.training.failing_conditions import (
    TORQUE_CONDITIONS,
    failing_conditions,
    missed_in_words,
)
from neuralgaits.training.loss import Loss
from neuralgaits.training.train_state import TrainState
from neuralgaits.training.trainer import VALIDATE_EVERY, Trainer

Progress = Callable[[int, int, float], None]
"""Callback with (steps done, steps in all, loss)."""
Save = Callable[[TrainState], None]
Rows = list[Mapping[str, float]]

CHECKPOINT_S = 2.0
"""Time between two checkpoints [s]."""


@dataclass
class GradientSteps:
    """The steps of one run, with the table of its losses.

    Attributes:
        folder, spec: those of the run.
        progress: callback that is called now and then.
        rows: rows of `metrics.csv`.
    """

    folder: RunFolder
    spec: GaitSpec
    progress: Progress | None
    rows: Rows = field(default_factory=list)

    def forget_after(self, step: int) -> None:
        """Read the table of a killed run, without the rows that its steps will write again."""
        for file in (NAN_STATE, NAN):
            (self.folder.path / file).unlink(missing_ok=True)
        self.rows = [row for row in self.folder.read_metrics() if row["step"] <= step]

    def take(
        self,
        trainer: Trainer,
        state: TrainState,
        save: Save,
        *,
        before: int = 0,
        deadline: float = np.inf,
    ) -> TrainState:
        """Train to the end of the trainer's steps, or to the deadline.

        If the loss or the weights turn to NaN, it continues from the best weights before that, with
        smaller steps.

        Args:
            trainer: sets the number of steps.
            state: state to continue from.
            save: writes a checkpoint.
            before: steps of the run that came before those of this trainer.
            deadline: time on the clock of `time.monotonic` [s].

        Raises: NonFiniteError where smaller steps do not help either.
        """
        saved = time.perf_counter()
        best = state
        count = 1
        while not trainer.done(state) and time.monotonic() < deadline:
            start_time, first = time.perf_counter(), int(state.step)
            ahead = min(VALIDATE_EVERY - first % VALIDATE_EVERY, trainer.steps - first)
            state, loss = trainer.step(state, min(count, ahead))
            step = int(state.step)
            jax.block_until_ready(loss)
            each = (time.perf_counter() - start_time) / (step - first)
            call_s = 0.2  # What a user who stops it, or a budget, can wait for.
            count = max(1, round(call_s / each))
            if step % VALIDATE_EVERY and not trainer.done(state):
                continue
            if not (np.isfinite(float(loss.total)) and np.isfinite(state.parameters).all()):
                smaller = trainer.restart_with_smaller_rate(best)
                if smaller is None:
                    self.refuse_nan(trainer, best, save)
                state = best = smaller
                continue
            state = trainer.validate(state)
            best = state
            self.rows.append(self.row(before + step, loss, state))
            if self.progress is not None:
                self.progress(before + step, before + trainer.steps, float(loss.total))
            if time.perf_counter() - saved > CHECKPOINT_S or trainer.done(state):
                self.folder.write_metrics(self.rows)
                save(state)
                saved = time.perf_counter()
        return state

    def row(self, step: int, loss: Loss, state: TrainState) -> dict[str, float]:
        """Return the table's row for a step: its loss, and the best validation loss so far."""
        terms = dict(zip(self._names(), np.asarray(loss.terms).tolist(), strict=True))
        head = {
            "step": step,
            "loss": float(loss.total),
            "validation_loss": float(state.best_loss),
            "effort": float(loss.effort),
        }
        return head | terms

    def _names(self) -> Sequence[str]:
        return [condition.name for condition in self.spec.trained_for]

    def refuse_nan(self, trainer: Trainer, last_good: TrainState, save: Save) -> NoReturn:
        """Save the last good state, and repeat the steps from it to the one that turned to NaN.

        Args:
            trainer: trainer of the run.
            last_good: the last good state.
            save: writes a checkpoint.

        Raises: NonFiniteError.
        """
        save(last_good)
        state, loss = trainer.step(last_good)
        while np.isfinite(float(loss.total)) and not trainer.done(state):
            state, loss = trainer.step(state)
        terms = zip(self._names(), np.asarray(loss.terms), strict=True)
        bad = [name for name, value in terms if not np.isfinite(value)]
        step, kept_step = int(state.step), int(last_good.step)
        record = EndedInNan(step=step, kept_step=kept_step, conditions=tuple(bad))
        self.folder.write_json(NAN, record)
        self.folder.write_tree(NAN_STATE, last_good)
        raise NonFiniteError(
            f"expected a finite loss and weights, found NaN or infinity at step {step}, with "
            f"smaller steps too{self._why_nan(trainer, last_good, bad)} "
            f"--seed; state of step {kept_step} kept, reproduce with "
            f"`{resuming(self.folder.path)}`"
        )

    def _why_nan(self, trainer: Trainer, last_good: TrainState, bad: Sequence[str]) -> str:
        """Say what may have led to NaN, and what helps, up to the flag of another seed.

        Args:
            trainer: trainer of the run.
            last_good: the last good state.
            bad: conditions whose loss is NaN or infinite.
        """
        if not specs.is_built_in(config_of(self.folder).spec):
            return (
                f" (conditions: {', '.join(bad) or 'none: the sum or its gradient'}): mend one "
                "whose formula, or its slope, is not finite, if there is one, or train with another"
            )
        # Formulas of the package are not what has to be mended: the gait itself runs away.
        names = failing_conditions(trainer, last_good)
        if not names:
            return ": train with another"
        at = f"; at step {int(last_good.step)}, the last finite state, {missed_in_words(names)}"
        if not any(name in TORQUE_CONDITIONS for name in names):
            return f"{at}: train with another"
        limit = float(np.max(np.asarray(nominal_robot(trainer.model).torque_limit)))
        return (
            f"{at}: the motors (at most {limit:g} N m) may be too weak for this robot: raise their "
            "limits if the real ones have more torque, or train with another"
        )
