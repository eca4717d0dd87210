"""Train many seeds as one compiled program: a stack of states, one for each run on disk.

This is how accelerators train them; a processor takes them side by side, see
`workflows/side_by_side.py`. The loop over gradient steps is that of a single training under
`vmap`, and the decisions between them (the best weights, smaller steps after NaN) are made seed by
seed by the same functions. So a seed gets the same result as alone, up to the rounding of sums in
single precision.
"""

import time
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from typing import Any, TypeVar

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jax.sharding import Mesh, NamedSharding, PartitionSpec

from neuralgaits._types import Array
from neuralgaits.analysis.run import Run
from neuralgaits.errors import NonFiniteError
from neuralgaits.gait.policies.commanded_gait import AnyGait
from neuralgaits.runs.names import STATE
from neuralgaits.training.loss import Loss
from neuralgaits.training.session import start_of
from neuralgaits.training.trainer import (
    VALIDATE_EVERY,
    FreshMargins,
    OverSeeds,
    Trainer,
    TrainState,
)
from neuralgaits.training.training_loop import AT_ONCE_S, CHECKPOINT_S, GradientSteps, Progress

Row = TypeVar("Row")
Tree = TypeVar("Tree")
SAVING_SHARE = 0.03
"""Share of the time that may go into checkpoints, which are many small files."""


@dataclass(eq=False)
class SeedRun:
    """Run of one seed of a batch.

    Attributes:
        run: unfinished; its gait is the untrained one.
        steps: the table of its losses.
        state: as it stands.
        kept: the last that was looked at.
        refused: why it is given up; None if it is not.
    """

    run: Run
    steps: GradientSteps
    state: TrainState
    kept: TrainState
    refused: NonFiniteError | None = None

    @property
    def seed(self) -> int:
        """Seed of the run's weights and samples."""
        return self.run.asked.seed

    def save(self, state: TrainState) -> None:
        """Write a checkpoint from which a single training can continue."""
        self.run.folder.write_metrics(self.steps.rows)
        self.run.folder.write_tree(STATE, state)


@dataclass
class SeedBatch:
    """Train batches of one size, one after the other, with programs that are compiled once.

    Attributes:
        trainer: trainer of any of the seeds; trainings differ only in keys and weights.
        size: seeds of a batch, a multiple of the number of devices; a smaller one is filled up
            with its last seed.
        members: members of the batch that was trained last.
        compile_s: compile time for that batch [s].
    """

    trainer: Trainer
    size: int
    members: list[SeedRun] = field(default_factory=list)
    compile_s: float = 0.0
    _over: OverSeeds | None = None
    _keys: Any = None
    _count: int = 1
    """Number of steps taken in one call."""

    def train(self, runs: Sequence[Run], progress: Progress | None) -> list[SeedRun]:
        """Take all steps of at most `size` runs.

        Args:
            runs: unfinished runs that differ only in their seeds.
            progress: called with (steps of all seeds done, in all, mean loss) now and then.

        Returns: each at its last step, or refused.

        Raises: InputError if gaits of some seeds differ in more than trained parameters.
        """
        self.members = [self._begun(run) for run in runs]
        keys = [jax.random.key(one.seed) for one in self.members]
        self._keys = self._put(jnp.stack(self._filled(keys)))
        self.compile_s = self._compile() if self._over is None else 0.0
        self._take(progress)
        return self.members

    def report(self, gaits: Sequence[AnyGait], *, seed: int) -> list[FreshMargins]:
        """Return `Trainer.report` of one gait for each seed."""
        found = zip(*self._look(_stack(self._filled(list(gaits))), seed, 0.0), strict=True)
        fresh = [self.trainer.margins_by_condition(float(loss), margins) for loss, margins in found]
        return fresh[: len(gaits)]

    def _begun(self, run: Run) -> SeedRun:
        trainer = self.trainer.of_seed(run.asked.seed, run.trained)
        state = jax.tree.map(np.asarray, start_of(run, trainer))
        return SeedRun(run, GradientSteps(run.folder, run.spec, None), state, state)

    def _compile(self) -> float:
        """Compile both programs, at once where there are two cores; results are thrown away."""
        start_time = time.perf_counter()
        self._over = self.trainer.over_seeds()
        with ThreadPoolExecutor(1) as beside:
            states = self._stacked([one.state for one in self.members])
            looked = beside.submit(self._validation_losses, states.parameters)
            self._advance(states, 1)
            looked.result()
        return time.perf_counter() - start_time

    def _take(self, progress: Progress | None) -> None:
        saved, saving = time.perf_counter(), 0.0
        while going := [one for one in self.members if self._goes_on(one)]:
            losses = self._block(going)
            self._look_at(going, losses)
            if progress is not None:
                self._tell(progress)
            ended = not any(self._goes_on(one) for one in going)
            now = time.perf_counter()
            if ended or now - saved > max(CHECKPOINT_S, saving / SAVING_SHARE):
                for one in self.members if ended else going:
                    if one.refused is None:
                        one.save(one.kept)
                saved = time.perf_counter()
                saving = saved - now

    def _goes_on(self, one: SeedRun) -> bool:
        return one.refused is None and not self.trainer.done(one.state)

    def _block(self, going: Sequence[SeedRun]) -> Loss:
        """Take steps until some seed is due for validation. Returns: losses of all seeds."""
        firsts = [int(one.state.step) for one in going]
        ahead = min(
            min(VALIDATE_EVERY - first % VALIDATE_EVERY, self.trainer.steps - first)
            for first in firsts
        )
        stacked, loss = self._stacked([one.state for one in self.members]), None
        while ahead:
            start_time, now = time.perf_counter(), min(self._count, ahead)
            stacked, loss = self._advance(stacked, now)
            ahead -= now
            # As many at once as a user who stops it can wait for.
            each = (time.perf_counter() - start_time) / now
            self._count = max(1, round(AT_ONCE_S / each))
        states, losses = jax.tree.map(np.asarray, (stacked, loss))
        for number, one in enumerate(self.members):
            # What a seed that has ended does beside the others is forgotten.
            if self._goes_on(one):
                one.state = _row(states, number)
        return losses

    def _look_at(self, going: Sequence[SeedRun], losses: Loss) -> None:
        """Keep the best weights of each seed that is due, or step back after NaN."""
        looked: list[tuple[int, Loss]] = []
        for number, one in enumerate(self.members):
            done = self.trainer.done(one.state)
            if one not in going or (int(one.state.step) % VALIDATE_EVERY and not done):
                continue
            loss = _row(losses, number)
            if np.isfinite(loss.total) and np.isfinite(one.state.parameters).all():
                looked.append((number, loss))
                continue
            smaller = self.trainer.restart_with_smaller_rate(one.kept)
            if smaller is None:
                one.refused = self._refused(number)
            else:
                one.state = one.kept = jax.tree.map(np.asarray, smaller)
        if not looked:
            return
        parameters = [one.state.parameters for one in self.members]
        found = self._validation_losses(self._put(np.stack(self._filled(parameters))))
        for number, loss in looked:
            one = self.members[number]
            state = self.trainer.keep_if_best(one.state, float(found[number]))
            one.state = one.kept = jax.tree.map(np.asarray, state)
            one.steps.rows.append(one.steps.row(int(state.step), loss, state))

    def _refused(self, number: int) -> NonFiniteError | None:
        """Explain why a seed is given up; its folder keeps the last good state."""
        one = self.members[number]

        def step(state: TrainState) -> tuple[TrainState, Loss]:
            states = [other.kept for other in self.members]
            states[number] = state
            moved, losses = self._advance(self._stacked(states), 1)
            return _row(jax.tree.map(np.asarray, (moved, losses)), number)

        try:
            one.steps.refuse_nan(self.trainer, step, one.kept, one.save)
        except NonFiniteError as error:
            return error

    def _tell(self, progress: Progress) -> None:
        left = [one for one in self.members if one.refused is None]
        last = [one.steps.rows[-1]["loss"] for one in left if one.steps.rows]
        if last:
            done = sum(int(one.state.step) for one in left)
            progress(done, self.trainer.steps * len(left), float(np.mean(last)))

    def _advance(self, stacked: TrainState, count: int) -> tuple[TrainState, Loss]:
        """Take steps of all seeds in one call."""
        assert self._over is not None
        parameters, optimizer, loss = self._over.step(
            stacked.parameters,
            stacked.optimizer,
            self._keys,
            stacked.step,
            jnp.int32(count),
            stacked.rate,
        )
        jax.block_until_ready(loss)
        moved = stacked._replace(
            step=stacked.step + count, parameters=parameters, optimizer=optimizer
        )
        return moved, loss

    def _validation_losses(self, parameters: Array) -> np.ndarray:
        """Return validation losses of the parameters of all seeds, [S, P]. Returns: [S]."""
        assert self._over is not None
        return self._look(self._over.gaits(parameters), 0, 1.0)[0]

    def _look(self, gaits: AnyGait, seed: int, share: float) -> tuple[np.ndarray, np.ndarray]:
        """Return losses and margins of gaits in one tree. Returns: [S], [S, N, K]."""
        assert self._over is not None
        key, share_of = jax.random.key(seed), jnp.asarray(share)
        loss, margins = self._over.look(self._put(gaits), key, share_of)
        return np.asarray(loss.total), np.asarray(margins)

    def _stacked(self, states: Sequence[TrainState]) -> TrainState:
        return self._put(_stack(self._filled(list(states))))

    def _filled(self, rows: list[Row]) -> list[Row]:
        return rows + [rows[-1]] * (self.size - len(rows))

    def _put(self, stacked: Tree) -> Tree:
        """Put a tree on all devices, with an equal share of the seeds on each."""
        devices = jax.devices()
        if len(devices) == 1:
            return stacked
        shares = NamedSharding(Mesh(np.array(devices), ("seeds",)), PartitionSpec("seeds"))
        return jax.tree.map(
            lambda leaf: jax.device_put(leaf, shares) if eqx.is_array(leaf) else leaf, stacked
        )


def _stack(rows: list[Row]) -> Row:
    """Stack trees into one whose arrays have an axis in front."""
    return jax.tree.map(
        lambda *leaves: np.stack(leaves) if eqx.is_array(leaves[0]) else leaves[0], *rows
    )


def _row(stacked: Row, number: int) -> Row:
    return jax.tree.map(lambda leaf: leaf[number], stacked)
