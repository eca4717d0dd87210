"""Many seeds on accelerators, in batches that are each trained as one program."""

import math
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from functools import partial

import jax

from neuralgaits.errors import NeuralGaitsError, is_full
from neuralgaits.gait.policies.commanded_gait import AnyGait, CommandedGait
from neuralgaits.runs import finish
from neuralgaits.runs.names import WEIGHTS
from neuralgaits.training.calibration import calibrated
from neuralgaits.training.seed_batch import SeedBatch, SeedRun
from neuralgaits.training.training_loop import Progress
from neuralgaits.workflows.many_seeds import ManySeeds
from neuralgaits.workflows.train import FRESH_SAMPLES_SEED, summary_of

AT_ONCE = 32
"""Seeds of a batch for each device; 16 take as long for each seed, and memory is bounded."""


class SeedBatches(ManySeeds):
    """Trainings under `vmap`, with a share of each batch on every device."""

    @staticmethod
    def at_a_time(count: int) -> int:
        """Return the number of seeds of a batch."""
        return batch_size(count, len(jax.devices()))

    def train(self, numbers: range, progress: Progress | None) -> None:
        """Train seeds in batches; see `ManySeeds.train`."""
        self._batch = SeedBatch(self.trainer, self.size)
        for at in range(0, len(numbers), self.size):
            self._train(numbers[at : at + self.size], len(numbers), progress)

    def _train(self, numbers: range, count: int, progress: Progress | None) -> None:
        steps, before = self.first.asked.steps, len(self.begun)
        runs = [self.begin(number) for number in numbers]

        def tell(step: int, _: int, loss: float) -> None:
            if progress is not None:
                progress(steps * before + step, steps * count, loss)

        start_time = time.perf_counter()
        members = self._batch.train(runs, tell)
        train_s = time.perf_counter() - start_time - self._batch.compile_s
        self.compile_s += self._batch.compile_s
        self.train_s += train_s
        self._finish(members, start_time, train_s)

    def _finish(self, members: Sequence[SeedRun], start_time: float, train_s: float) -> None:
        """Evaluate each gait on fresh samples, and finish its folder."""
        batch = self._batch
        report = partial(batch.report, seed=FRESH_SAMPLES_SEED)
        best = [batch.trainer.gait(one.state.best) for one in members]
        self.refused |= {one.seed: one.refused for one in members if one.refused is not None}
        gaits: list[AnyGait] = []
        for one, gait in zip(members, best, strict=True):
            if isinstance(gait, CommandedGait) and one.seed not in self.refused:
                with self._refusal(one):
                    gait = calibrated(gait, one.run.robot, one.run.residuals)
            gaits.append(gait)
        fresh = report(gaits)
        aimed = report(best) if self.first.spec.aims else fresh
        for number, one in enumerate(members):
            if one.seed in self.refused:
                continue
            run = replace(one.run, trained=gaits[number])
            with self._refusal(one):
                run.folder.write_tree(WEIGHTS, run.trained)
                found = summary_of(
                    run,
                    fresh[number],
                    aimed[number],
                    state=one.state,
                    compile_s=batch.compile_s,
                    train_s=train_s,
                    start_time=start_time,
                )
                finish(run.folder, found, self.root)
                self.done[one.seed] = run

    @contextmanager
    def _refusal(self, one: SeedRun) -> Iterator[None]:
        """Record the error of a refused seed, so that the others continue."""
        try:
            yield
        except NeuralGaitsError as error:
            if is_full(error):
                raise
            self.refused[one.seed] = error


def batch_size(count: int, devices: int) -> int:
    """Return the size of all batches: the fewest batches, shared evenly by the devices.

    Args:
        count: number of seeds.
        devices: number of devices that share a batch.
    """
    batches = math.ceil(count / (AT_ONCE * devices))
    return devices * math.ceil(count / batches / devices)
