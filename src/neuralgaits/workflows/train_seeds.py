"""Train many seeds as one program, and leave an ordinary run folder of each."""

import math
import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

import jax

from neuralgaits._settings import check_seeds
from neuralgaits.analysis.run import Run
from neuralgaits.barriers import GaitSpec
from neuralgaits.barriers.commanded import Interval
from neuralgaits.barriers.regions import AnyGait, CommandedGait
from neuralgaits.barriers.spec import Init
from neuralgaits.errors import Interrupted, NeuralGaitsError, is_full
from neuralgaits.records.trained import Trained, TrainedSeed, TrainedSeeds
from neuralgaits.robots import PlanarBiped
from neuralgaits.runs import RUNS_ROOT, finish, to_json, write_text
from neuralgaits.runs.claim import claim, filled
from neuralgaits.runs.commands import command, resuming
from neuralgaits.runs.latest import SEEDS
from neuralgaits.runs.names import WEIGHTS
from neuralgaits.training.calibration import calibrated
from neuralgaits.training.gradient_steps import Progress
from neuralgaits.training.seed_batch import OneOfMany, SeedBatch
from neuralgaits.training.trainer import Trainer
from neuralgaits.workflows.parts.new_training import NewTraining, new_training
from neuralgaits.workflows.train import FRESH_SAMPLES_SEED, summary_of

AT_ONCE = 32
"""Seeds of a batch for each device: a step of 16 takes as long a seed, and memory is bounded."""
SUMMARY = "seeds.json"
"""Table of the seeds, in the folder that holds their runs."""


@dataclass(frozen=True)
class Seeds:
    """Many seeds and what came of them.

    Attributes:
        path: the folder that holds their runs.
        runs: of those that are trained, in order.
        summary: what `train --seeds --json` prints.
    """

    path: Path
    runs: tuple[Run, ...]
    summary: TrainedSeeds


def train_seeds(
    robot: PlanarBiped,
    spec: str | GaitSpec = "walking",
    *,
    seeds: tuple[int, int],
    init: Init = "posture",
    hidden: tuple[int, ...] | None = None,
    steps: int | None = None,
    out: str | Path | None = None,
    speed: float | Interval | None = None,
    step_length: Interval | None = None,
    step_height: Interval | None = None,
    slope: Interval | None = None,
    parameters: Mapping[str, float] | None = None,
    progress: Progress | None = None,
    root: Path = RUNS_ROOT,
) -> Seeds:
    """Train a policy for each of many seeds, in batches of one compiled program.

    Args:
        robot: of `load_robot`.
        spec: as in `train`, with all that follows but `seeds`, `out` and `progress`.
        seeds: the first, and the one after the last.
        init: "posture" or "random".
        hidden: widths of the hidden layers; the spec's if None.
        steps: gradient steps of each seed; the recipe's if None.
        out: folder that holds a run folder for each seed, named after its number;
            `runs/seeds/ROBOT/<UTC time>-<first seed>` if None.
        speed: mean speed to walk at (m/s), or a range of them.
        step_length: range of footholds' distances to be told (m).
        step_height: range of their heights above the stance foot (m).
        slope: range of slopes of the ground (rad).
        parameters: box of robots that the gaits are meant for.
        progress: called with (steps of all seeds done, in all, mean loss) now and then.
        root: folder of the runs.

    Returns: `Seeds`; a seed whose training ends in NaN, or which a later part refuses, is among
        its `summary.refused`.

    Raises: InputError on bad settings; Interrupted for KeyboardInterrupt.
    """
    began = time.perf_counter()
    check_seeds(seeds)
    first = new_training(
        robot,
        spec,
        seed=seeds[0],
        init=init,
        hidden=hidden,
        steps=steps,
        speed=speed,
        step_length=step_length,
        step_height=step_height,
        slope=slope,
        parameters=parameters,
    )
    place = None if out is None else Path(out)
    name, numbers = robot.name, range(*seeds)
    path = claim(place, root / SEEDS, name, seeds[0], what="the runs", config=SUMMARY)
    # Runs are finished or gone on with one by one: nothing in here is replaced from now on.
    filled(path)
    return _ManySeeds(first, numbers, path, root, progress, began).trained()


class _ManySeeds:
    """The batches of a command, and what is known of their seeds so far."""

    def __init__(
        self,
        first: NewTraining,
        numbers: range,
        path: Path,
        root: Path,
        progress: Progress | None,
        began: float,
    ):
        self.first, self.numbers, self.path, self.root = first, numbers, path, root
        self.progress, self.began = progress, began
        self.begun: list[Run] = []
        self.done: list[Run] = []
        self.rows: list[TrainedSeed] = []
        self.compile_s = self.train_s = 0.0

    def trained(self) -> Seeds:
        """Train, report and finish each of them."""
        devices = len(jax.devices())
        size = batch_size(len(self.numbers), devices)
        trainer = Trainer.build(
            self.first.robot,
            self.first.spec,
            self.first.gait,
            steps=self.first.asked.steps,
            seed=self.first.asked.seed,
        )
        batch = SeedBatch(trainer, size)
        try:
            for at in range(0, len(self.numbers), size):
                self._train(batch, self.numbers[at : at + size])
        except KeyboardInterrupt as stop:
            raise self._stopped() from stop
        summary = TrainedSeeds(
            folder=str(self.path),
            robot=self.first.asked.robot,
            spec=self.first.asked.spec,
            conditions=len(self.first.spec.conditions),
            steps=self.first.asked.steps,
            seeds=tuple(self.rows),
            batch=size,
            devices=devices,
            compile_s=self.compile_s,
            train_s=self.train_s,
            wall_s=time.perf_counter() - self.began,
        )
        write_text(self.path / SUMMARY, to_json(summary))
        return Seeds(self.path, tuple(self.done), summary)

    def _train(self, batch: SeedBatch, numbers: range) -> None:
        runs = []
        for number in numbers:
            run = self.first.of_seed(number).begun(self.root, self.path / str(number))
            runs.append(run)
            self.begun.append(run)
        steps = self.first.asked.steps
        before, every = steps * (len(self.begun) - len(runs)), steps * len(self.numbers)
        began = time.perf_counter()
        members = batch.train(runs, self._tell(before, every))
        train_s = time.perf_counter() - began - batch.compile_s
        self.compile_s += batch.compile_s
        self.train_s += train_s
        self._finish(batch, members, train_s)

    def _tell(self, before: int, every: int) -> Progress | None:
        progress = self.progress
        if progress is None:
            return None
        return lambda step, _, loss: progress(before + step, every, loss)

    def _finish(self, batch: SeedBatch, members: Sequence[OneOfMany], train_s: float) -> None:
        """Look at each gait on fresh samples, and finish its folder."""
        report = partial(batch.report, seed=FRESH_SAMPLES_SEED)
        best = [batch.trainer.gait(one.state.best) for one in members]
        gaits: list[AnyGait] = []
        reasons: list[NeuralGaitsError | None] = [one.refused for one in members]
        for number, (one, gait) in enumerate(zip(members, best, strict=True)):
            if isinstance(gait, CommandedGait) and reasons[number] is None:
                with _refusal(reasons, number):
                    gait = calibrated(gait, one.run.robot, one.run.residuals)
            gaits.append(gait)
        fresh = report(gaits)
        aimed = report(best) if self.first.spec.aims else fresh
        for number, one in enumerate(members):
            run = replace(one.run, trained=gaits[number])
            if reasons[number] is None:
                with _refusal(reasons, number):
                    run.folder.write_tree(WEIGHTS, run.trained)
                    found = summary_of(
                        run,
                        fresh[number],
                        aimed[number],
                        state=one.state,
                        compile_s=batch.compile_s,
                        train_s=train_s,
                        began=self.began,
                    )
                    finish(run.folder, found, self.root)
                    self.done.append(run)
                    self.rows.append(_row(found))
                    continue
            self.rows.append(_refused_row(run, reasons[number]))

    def _stopped(self) -> Interrupted:
        """What can be gone on with: a run that was begun, and the seeds that were not."""
        left = [run for run in self.begun if not run.folder.finished]
        later = self.numbers[len(self.begun) :]
        rest = f"seeds {later[0]} to {later[-1]} were not begun" if later else ""
        if not left:
            again = command(
                "train", self.first.asked.robot, "--seeds", f"{later[0]}:{later[-1] + 1}"
            )
            return Interrupted(again, " and the settings that were given")
        others = f", and so with each of {len(left) - 1} more" if len(left) > 1 else ""
        return Interrupted(resuming(left[0].path), f"{others}{rest and '; ' + rest}")


def batch_size(count: int, devices: int) -> int:
    """Seeds of each batch: as few batches as can be, of one size, shared evenly by the devices.

    Args:
        count: of seeds.
        devices: that share a batch.
    """
    batches = math.ceil(count / (AT_ONCE * devices))
    return devices * math.ceil(count / batches / devices)


@contextmanager
def _refusal(reasons: list[NeuralGaitsError | None], number: int) -> Iterator[None]:
    """Keep what refuses a seed, so that the others go on."""
    try:
        yield
    except NeuralGaitsError as error:
        if is_full(error):
            raise
        reasons[number] = error


def _row(found: Trained) -> TrainedSeed:
    return TrainedSeed(found.seed, found.run, found.loss, tuple(found.broken))


def _refused_row(run: Run, reason: NeuralGaitsError | None) -> TrainedSeed:
    line = " ".join(str(reason).split())
    return TrainedSeed(run.asked.seed, str(run.path), refused=line)
