"""Many seeds on the cores of one machine: single trainings in parallel, compiled once.

Each reaches the same bits as alone. One program for all seeds (`jax.vmap`) was measured and is not
here: on a processor it takes as long for each seed, and it rounds sums in another order.
"""

import threading
import time
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import FIRST_EXCEPTION, Future, ThreadPoolExecutor, wait
from contextlib import suppress
from pathlib import Path

from neuralgaits._environment import cores
from neuralgaits.analysis.run import Run
from neuralgaits.errors import NeuralGaitsError, is_full
from neuralgaits.robots.mjcf.parameters import model_of
from neuralgaits.training.session import compile_steps
from neuralgaits.training.trainer import Trainer
from neuralgaits.training.training_loop import Progress
from neuralgaits.workflows.new_training import NewTraining
from neuralgaits.workflows.train import train_to_the_end


class SeedsInParallel:
    """Trainings that differ in their seeds, on threads.

    Compiled code, which takes most of the time, releases Python's lock.

    Attributes:
        size: number of seeds that are trained at a time: one for each core.
        begun: runs that have a folder, in order.
        done: finished runs by seed.
        refused: errors of seeds that could not be trained; their folders keep what was written.
        compile_s, train_s: duration of compiling, and of everything after it (s).
    """

    def __init__(self, first: NewTraining, path: Path, root: Path, count: int):
        """Build the trainer, without starting any seed.

        Args:
            first: training of any of the seeds.
            path: folder that holds the seeds' folders.
            root: folder of the runs.
            count: total number of seeds.
        """
        self.first = first
        self.path = path
        self.root = root
        self.size = min(cores(), count)
        self.trainer = Trainer.build(
            model_of(first.parts.robot, first.parts.spec.parameters),
            first.parts.spec,
            first.parts.gait,
            steps=first.config.steps,
            seed=first.config.seed,
        )
        self.begun: list[Run] = []
        self.done: dict[int, Run] = {}
        self.refused: dict[int, NeuralGaitsError] = {}
        self.compile_s = self.train_s = 0.0
        # Whether no further seed is to be trained.
        self._stopped = False
        self._lock = threading.Lock()

    def train(
        self,
        numbers: range,
        progress: Progress | None,
        begun: Callable[[], None] | None = None,
    ) -> None:
        """Train seeds, and finish their folders.

        Args:
            numbers: the seeds.
            progress: called with (steps of all seeds done, in all, mean loss) now and then, from
                one thread at a time, which need not be this one.
            begun: called before compiling.

        Raises: InputError if gaits of some seeds differ in more than the trained weights;
            KeyboardInterrupt.
        """
        start_time = time.perf_counter()
        if begun is not None:
            begun()
        # Threads that meet in a call compile it twice.
        compile_steps(self.trainer, self.trainer.init(self.first.parts.gait))
        compiled = time.perf_counter()
        self.compile_s = compiled - start_time
        left = iter(numbers)
        seed_progress = _SeedProgress(progress, self.first.config.steps, len(numbers))
        pool = ThreadPoolExecutor(self.size)
        threads = [pool.submit(self._work, left, seed_progress) for _ in range(self.size)]
        try:
            wait(threads, return_when=FIRST_EXCEPTION)
        finally:
            # Whether it is Ctrl-C here or an exception there, the others are to end.
            self._stopped |= any(not thread.done() for thread in threads)
            _until_ended(threads)
            pool.shutdown()
        _raise_of(threads)
        self.train_s = time.perf_counter() - compiled

    def _work(self, left: Iterator[int], seed_progress: "_SeedProgress") -> None:
        """Train one seed after another, until none is left."""
        try:
            while (run := self._next(left)) is not None:
                self._train(run, seed_progress)
        except BaseException:
            self._stopped = True
            raise

    def _next(self, left: Iterator[int]) -> Run | None:
        with self._lock:
            number = None if self._stopped else next(left, None)
            if number is None:
                return None
            run = self.first.of_seed(number).begun(self.root, self.path / str(number))
            self.begun.append(run)
            return run

    def _train(self, run: Run, seed_progress: "_SeedProgress") -> None:
        seed, start_time = run.config.seed, time.perf_counter()
        trainer = self.trainer.of_seed(seed, run.trained)

        def tell(step: int, _: int, loss: float) -> None:
            with self._lock:
                if self._stopped:
                    raise KeyboardInterrupt
                try:
                    seed_progress.step(seed, step, loss)
                except BaseException:
                    self._stopped = True
                    raise

        try:
            self.done[seed] = train_to_the_end(
                run,
                progress=tell,
                watch=None,
                root=self.root,
                start_time=start_time,
                trainer=trainer,
            )
        except NeuralGaitsError as error:
            if is_full(error):
                raise
            self.refused[seed] = error
            with self._lock:
                seed_progress.refused(seed)


class _SeedProgress:
    """Progress of all seeds: the sum of their steps, and the mean of their last losses."""

    def __init__(self, progress: Progress | None, steps: int, seeds: int):
        self.progress = progress
        self.every = steps
        self.seeds = seeds
        self.last: dict[int, tuple[int, float]] = {}

    def step(self, seed: int, step: int, loss: float) -> None:
        """Record that a seed has reached a step, with its loss."""
        self.last[seed] = step, loss
        self._tell()

    def refused(self, seed: int) -> None:
        """Drop a refused seed from the progress."""
        self.last.pop(seed, None)
        self.seeds -= 1
        self._tell()

    def _tell(self) -> None:
        if self.progress is not None and self.last:
            steps, losses = zip(*self.last.values(), strict=True)
            self.progress(sum(steps), self.every * self.seeds, sum(losses) / len(losses))


def _until_ended(threads: Sequence[Future[None]]) -> None:
    """Wait until all threads have ended, however often Ctrl-C is pressed."""
    while not all(thread.done() for thread in threads):
        with suppress(KeyboardInterrupt):
            wait(threads)


def _raise_of(threads: Sequence[Future[None]]) -> None:
    """Raise the error that stopped a thread; otherwise KeyboardInterrupt, if any was stopped."""
    errors = [error for thread in threads if (error := thread.exception()) is not None]
    for error in errors:
        if not isinstance(error, KeyboardInterrupt):
            raise error
    if errors:
        raise KeyboardInterrupt
