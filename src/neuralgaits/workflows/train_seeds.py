"""Train many seeds in one command, and leave an ordinary run folder for each."""

import time
from dataclasses import dataclass
from pathlib import Path

import jax

from neuralgaits.analysis.run import Run
from neuralgaits.errors import Interrupted
from neuralgaits.records.trained import SeedsSummary, SeedSummary
from neuralgaits.runs import to_json, write_text
from neuralgaits.runs.atomic import refuse_unwritable
from neuralgaits.runs.claim import claim, filled
from neuralgaits.runs.latest import SEEDS, name_latest
from neuralgaits.runs.shell_words import LATEST, command, resuming
from neuralgaits.settings import TrainSeedsSettings, called_with
from neuralgaits.workflows.new_training import new_training
from neuralgaits.workflows.seeds_in_parallel import SeedsInParallel


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
    summary: SeedsSummary


@called_with(TrainSeedsSettings)
def train_seeds(settings: TrainSeedsSettings) -> Seeds:
    """Train a policy for each of many seeds, with programs that are compiled once.

    Each seed reaches the same weights as `train`, bit for bit. Settings are those of `train`.

    Returns: `Seeds`; a seed whose training ends in NaN, or that a later stage refuses, is in
        `summary.refused`.

    Raises: InputError on bad settings; Interrupted for KeyboardInterrupt.
    """
    start_time = time.perf_counter()
    numbers, root = range(*settings.seeds), settings.root
    first = new_training(settings, numbers[0], settings.doubted)
    place = None if settings.out is None else Path(settings.out)
    refuse_unwritable(root / LATEST, own=True)
    file_name = "seeds.json"
    path = claim(
        place, root / SEEDS, first.config.robot, numbers[0], what="the runs", config=file_name
    )
    # Runs are finished or gone on with one by one: nothing in here is replaced from now on.
    filled(path)
    many = SeedsInParallel(first, path, root, len(numbers))
    try:
        many.train(numbers, settings.progress, settings.begun)
    except KeyboardInterrupt as stop:
        if len(many.done) + len(many.refused) < len(numbers):
            raise _interruption(many, numbers) from stop
        # It came behind the last step of all.
    summary = _summary(many, numbers, time.perf_counter() - start_time)
    write_text(path / file_name, to_json(summary))
    runs = tuple(many.done[number] for number in numbers if number in many.done)
    if runs:
        # Whichever was the last to finish.
        name_latest(runs[-1].folder, root)
    return Seeds(path, runs, summary)


def _summary(many: SeedsInParallel, numbers: range, wall_s: float) -> SeedsSummary:
    config = many.first.config
    return SeedsSummary(
        folder=str(many.path),
        robot=config.robot,
        spec=config.spec,
        conditions=len(many.first.parts.spec.conditions),
        steps=config.steps,
        seeds=tuple(_row(many, number) for number in numbers),
        batch=many.size,
        devices=len(jax.devices()),
        compile_s=many.compile_s,
        train_s=many.train_s,
        wall_s=wall_s,
    )


def _row(many: SeedsInParallel, number: int) -> SeedSummary:
    if number in many.refused:
        line = " ".join(str(many.refused[number]).split())
        return SeedSummary(number, str(many.path / str(number)), refused=line)
    summary = many.done[number].summary
    return SeedSummary(summary.seed, summary.run, summary.loss, tuple(summary.broken))


def _interruption(many: SeedsInParallel, numbers: range) -> Interrupted:
    """Return the interruption, which names runs to resume and seeds that were not started."""
    unfinished = [one for one in many.begun if one.config.seed not in many.done | many.refused]
    later = numbers[len(many.begun) :]
    rest = [f"and so with each of {len(unfinished) - 1} more"] if len(unfinished) > 1 else []
    if many.refused:
        rest.append(f"refused, see nan.json: {', '.join(map(str, sorted(many.refused)))}")
    if not unfinished:
        robot = many.first.config.robot
        again = command("train", robot, "--seeds", f"{later[0]}:{later[-1] + 1}")
        more = "; ".join(["and the settings that were given, in another folder", *rest])
        return Interrupted(again, f" {more}")
    if len(later) > 1:
        rest.append(f"seeds {later[0]} to {later[-1]} were not begun")
    elif later:
        rest.append(f"seed {later[0]} was not begun")
    return Interrupted(resuming(unfinished[0].path), "".join(f"; {part}" for part in rest))
