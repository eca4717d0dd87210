"""Results of training many seeds, independent of how they are computed."""

from abc import ABC, abstractmethod
from pathlib import Path

from neuralgaits.analysis.run import Run
from neuralgaits.errors import NeuralGaitsError
from neuralgaits.training.trainer import Trainer
from neuralgaits.training.training_loop import Progress
from neuralgaits.workflows.new_training import NewTraining


class ManySeeds(ABC):
    """Trainings that differ in their seeds.

    Attributes:
        size: number of seeds that are trained at a time.
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
        self.first, self.path, self.root = first, path, root
        self.size = self.at_a_time(count)
        self.trainer = Trainer.build(
            first.robot, first.spec, first.gait, steps=first.asked.steps, seed=first.asked.seed
        )
        self.begun: list[Run] = []
        self.done: dict[int, Run] = {}
        self.refused: dict[int, NeuralGaitsError] = {}
        self.compile_s = self.train_s = 0.0

    @staticmethod
    @abstractmethod
    def at_a_time(count: int) -> int:
        """Return the number of seeds to train at a time, of `count` in all."""

    @abstractmethod
    def train(self, numbers: range, progress: Progress | None) -> None:
        """Train seeds, and finish their folders.

        Args:
            numbers: the seeds.
            progress: called with (steps of all seeds done, in all, mean loss) now and then, from
                one thread at a time, which need not be this one.

        Raises: InputError if gaits of some seeds differ in more than the trained weights;
            KeyboardInterrupt.
        """

    def begin(self, seed: int) -> Run:
        """Return a run of this seed, with a folder of its own."""
        run = self.first.of_seed(seed).begun(self.root, self.path / str(seed))
        self.begun.append(run)
        return run
