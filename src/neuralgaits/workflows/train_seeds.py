"""Train many seeds in one command, and leave an ordinary run folder for each."""

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

import jax

from neuralgaits._settings import check_seeds
from neuralgaits.analysis.run import Run
from neuralgaits.analysis.walking_speeds import gait_doubt
from neuralgaits.barriers import GaitSpec
from neuralgaits.barriers.commanded_spec import Interval
from neuralgaits.barriers.spec import Init
from neuralgaits.errors import Interrupted
from neuralgaits.records.trained import TrainedSeed, TrainedSeeds
from neuralgaits.robots import PlanarBiped
from neuralgaits.runs import RUNS_ROOT, to_json, write_text
from neuralgaits.runs.atomic import refuse_unwritable
from neuralgaits.runs.claim import claim, filled
from neuralgaits.runs.latest import SEEDS, name_latest
from neuralgaits.runs.shell_words import LATEST, command, resuming
from neuralgaits.training.training_loop import Progress
from neuralgaits.workflows.many_seeds import ManySeeds
from neuralgaits.workflows.new_training import new_training
from neuralgaits.workflows.seed_batches import SeedBatches
from neuralgaits.workflows.side_by_side import SideBySide

SUMMARY = "seeds.json"
"""Name of the table of seeds, in the folder that holds their runs."""


@dataclass(frozen=True)
class Seeds:
    """Results of training many seeds.

    Attributes:
        path: the folder that holds their runs.
        runs: runs of the trained seeds, in order.
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
    doubted: Callable[[str], None] | None = None,
    root: Path = RUNS_ROOT,
) -> Seeds:
    """Train a policy for each of many seeds, with programs that are compiled once.

    On a processor, each seed reaches the same weights as `train`, bit for bit. Accelerators train
    batches of seeds as one program, and reach the same weights up to rounding.

    Args:
        robot: robot of `load_robot`.
        spec: as in `train`, like all following arguments except `seeds`, `out` and `progress`.
        seeds: first seed, and the one after the last.
        init: "posture" or "random".
        hidden: widths of the hidden layers; those of the spec if None.
        steps: gradient steps of each seed; those of the recipe if None.
        out: folder that holds a run folder for each seed, named after its number;
            `runs/seeds/ROBOT/<UTC time>-<first seed>` if None.
        speed: mean speed (m/s), or a range of commanded speeds.
        step_length: range of the commanded distances of footholds (m).
        step_height: range of the commanded heights of footholds above the stance foot (m).
        slope: range of the commanded slopes of the ground (rad).
        parameters: box of robots that the gaits are meant for.
        progress: called with (steps of all seeds done, in all, mean loss) now and then, from one
            thread at a time, which need not be the caller's.
        doubted: called with one line, before the training, if no such gait is likely.
        root: folder of the runs.

    Returns: `Seeds`; a seed whose training ends in NaN, or that a later stage refuses, is in
        `summary.refused`.

    Raises: InputError on bad settings; Interrupted for KeyboardInterrupt.
    """
    start_time = time.perf_counter()
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
    numbers = range(*seeds)
    refuse_unwritable(root / LATEST)
    path = claim(place, root / SEEDS, robot.name, seeds[0], what="the runs", config=SUMMARY)
    # Runs are finished or gone on with one by one: nothing in here is replaced from now on.
    filled(path)
    way = SeedBatches if as_one_program() else SideBySide
    doubt = gait_doubt(robot, speed, step_length)
    if doubt is not None and doubted is not None:
        doubted(doubt)
    many = way(first, path, root, len(numbers))
    try:
        many.train(numbers, progress)
    except KeyboardInterrupt as stop:
        if len(many.done) + len(many.refused) < len(numbers):
            raise _stopped(many, numbers) from stop
        # It came behind the last step of all.
    summary = _summary(many, numbers, time.perf_counter() - start_time)
    write_text(path / SUMMARY, to_json(summary))
    runs = tuple(many.done[number] for number in numbers if number in many.done)
    if runs:
        # Whichever was the last to finish.
        name_latest(runs[-1].folder, root)
    return Seeds(path, runs, summary)


def as_one_program() -> bool:
    """Return whether to train batches as one program: on accelerators, or on several devices."""
    return jax.default_backend() != "cpu" or len(jax.devices()) > 1


def _summary(many: ManySeeds, numbers: range, wall_s: float) -> TrainedSeeds:
    asked = many.first.asked
    return TrainedSeeds(
        folder=str(many.path),
        robot=asked.robot,
        spec=asked.spec,
        conditions=len(many.first.spec.conditions),
        steps=asked.steps,
        seeds=tuple(_row(many, number) for number in numbers),
        batch=many.size,
        devices=len(jax.devices()),
        compile_s=many.compile_s,
        train_s=many.train_s,
        wall_s=wall_s,
    )


def _row(many: ManySeeds, number: int) -> TrainedSeed:
    if number in many.refused:
        line = " ".join(str(many.refused[number]).split())
        return TrainedSeed(number, str(many.path / str(number)), refused=line)
    found = many.done[number].summary
    return TrainedSeed(found.seed, found.run, found.loss, tuple(found.broken))


def _stopped(many: ManySeeds, numbers: range) -> Interrupted:
    """Return the interruption, which names runs to resume and seeds that were not started."""
    left = [one for one in many.begun if one.asked.seed not in many.done | many.refused]
    later = numbers[len(many.begun) :]
    rest = [f"and so with each of {len(left) - 1} more"] if len(left) > 1 else []
    if many.refused:
        rest.append(f"refused, see nan.json: {', '.join(map(str, sorted(many.refused)))}")
    if not left:
        robot = many.first.asked.robot
        again = command("train", robot, "--seeds", f"{later[0]}:{later[-1] + 1}")
        more = "; ".join(["and the settings that were given, in another folder", *rest])
        return Interrupted(again, f" {more}")
    if len(later) > 1:
        rest.append(f"seeds {later[0]} to {later[-1]} were not begun")
    elif later:
        rest.append(f"seed {later[0]} was not begun")
    return Interrupted(resuming(left[0].path), "".join(f"; {part}" for part in rest))
