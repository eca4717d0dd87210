"""Walk one simulation on many workers: parts are tasks, and results are put together in order."""

import json
import tempfile
import time
from collections.abc import Iterator, Mapping
from contextlib import closing
from dataclasses import dataclass, fields, replace
from functools import lru_cache
from pathlib import Path
from typing import Any

import safetensors.numpy

from neuralgaits.analysis.run import open_run
from neuralgaits.engine import Files, Job, Settings, WorkerPool
from neuralgaits.errors import InputError
from neuralgaits.robots.mjcf.drawn_robots import DrawnRobots
from neuralgaits.robots.mjcf.loader import robot_from_text
from neuralgaits.runs import plain
from neuralgaits.runs.arrays import packed
from neuralgaits.runs.names import CONFIG, TRAINING_SUMMARY, WEIGHTS
from neuralgaits.simulation.native_walk import Choice
from neuralgaits.simulation.setup.command_schedule import RANDOM, schedule_of
from neuralgaits.simulation.setup.disturbance import PlantChanges
from neuralgaits.simulation.trained_walks import (
    TrainedWalks,
    at_first,
    from_arrays,
    to_arrays,
    walk_engine_for,
)
from neuralgaits.simulation.walk import Walk

STEPS_OF_A_PART = 1600
"""Number of walking steps of a task: some ten seconds of compiled code."""
_PLANT, _COMMANDS, _ARRAYS = "plant.xml", "commands.csv", "walks.safetensors"
OTHERWISE_SENT = frozenset({"run", "plant", "disturbance", "schedule", "drawn", "library"})
"""Fields of `TrainedWalks` that workers make again from files and numbers."""
NOT_SENT = frozenset({"threads", "joints", "courses"})
"""Fields that each worker has its own of, or that `refuse_shared` refuses beside workers."""
_SENT = tuple(one.name for one in fields(TrainedWalks) if one.name not in OTHERWISE_SENT | NOT_SENT)
"""Fields that are sent to workers as they are, as JSON: all others, a new one too."""


@dataclass(frozen=True)
class SharedWalks:
    """Walks that are shared among workers.

    Attributes:
        walks: common settings of the walks.
        choice: choice of the engine of a walk.
        command, commands: commands of a family, as in `simulate`.
    """

    walks: TrainedWalks
    choice: Choice | None
    command: Mapping[str, float] | None
    commands: str | None

    def on(self, engine: WorkerPool, episodes: int) -> Walk:
        """Walk all episodes. Raises: InputError if some could not be walked."""
        # One step tells plant and law, and leaves the compiled walk where workers here find it.
        whole = replace(self.walks, steps=1).walk(0, 1)
        start_time = time.perf_counter()
        most_episodes = 256
        count = max(1, min(most_episodes, STEPS_OF_A_PART // self.walks.steps))
        arrays: dict[str, Any] = {}
        with closing(
            engine.map(walk_part, self._jobs(episodes, count), common=self._files())
        ) as results:
            for one in results:
                if one.failure is not None:
                    raise InputError(
                        f"expected walks {one.name} to be walked, found that they were not: "
                        f"{one.failure.reason}"
                    )
                arrays[one.name] = safetensors.numpy.load(one.files[_ARRAYS])
        parts = [arrays[job.name] for job in self._jobs(episodes, count)]
        merged = from_arrays(parts, time.perf_counter() - start_time)
        if not merged.strides:
            merged = merged._replace(strides=whole.episodes.strides[:0])
        return replace(whole, episodes=merged)

    def _jobs(self, episodes: int, count: int) -> Iterator[Job]:
        walks = self.walks
        about = {name: getattr(walks, name) for name in _SENT} | {
            "plant": None if walks.plant is None else walks.plant.name,
            "disturb": plain(vars(walks.disturbance)),
            "engine": self.choice,
            "command": None if self.command is None else dict(self.command),
            "random": self.commands == RANDOM,
            "parameters": None if walks.drawn is None else dict(walks.drawn.box),
        }
        for first in range(0, episodes, count):
            here = min(count, episodes - first)
            name = f"{first}-{first + here - 1}"
            yield Job(name, about | {"part": {"first": first, "count": here}})

    def _files(self) -> dict[str, bytes]:
        """Return the files of run, plant and commands that a worker needs."""
        path = self.walks.run.path
        names = {CONFIG, TRAINING_SUMMARY, *self.walks.run.folder.copies, WEIGHTS}
        files = {f"run/{name}": (path / name).read_bytes() for name in sorted(names)}
        if self.walks.plant is not None:
            files[_PLANT] = self.walks.plant.layout.xml.encode()
        if self.commands is not None and self.commands != RANDOM:
            files[_COMMANDS] = Path(self.commands).read_bytes()
        return files


def walk_part(settings: Settings, files: Files) -> Files:
    """Walk some episodes of a simulation, as a task of a worker.

    Args:
        settings: settings of the walks; `part` has the number of the first, and how many.
        files: files of the run, and of the plant and of commands if there are any.

    Returns: `walks.safetensors` with the arrays of `to_arrays`.
    """
    about = {name: value for name, value in settings.items() if name != "part"}
    walks = _open_walks(json.dumps(about, sort_keys=True), tuple(sorted(files.items())))
    arrays = to_arrays(walks.walk(**settings["part"]))
    return {_ARRAYS: packed(arrays, {})}


@lru_cache(maxsize=1)
def _open_walks(about: str, files: tuple[tuple[str, bytes], ...]) -> TrainedWalks:
    """Open the run of these files, once for all parts of a simulation that a worker walks."""
    settings, contents = json.loads(about), dict(files)
    with tempfile.TemporaryDirectory(prefix="neuralgaits-") as folder:
        base = Path(folder)
        for name, content in contents.items():
            (base / name).parent.mkdir(exist_ok=True)
            (base / name).write_bytes(content)
        run = open_run(base / "run")
        commands = RANDOM if settings["random"] else None
        if _COMMANDS in contents:
            commands = str(base / _COMMANDS)
        schedule = schedule_of(
            run.trained.commands, settings["command"], commands, settings["seed"]
        )
        run = at_first(run, schedule.first)
        # What is read when it is first asked for is asked for now.
        _ = run.residuals
    plant, box = None, settings["parameters"]
    if _PLANT in contents:
        plant = robot_from_text(contents[_PLANT].decode(), settings["plant"])
    engine = walk_engine_for(run, settings["controller"], settings["engine"], settings["simulator"])
    sent = {name: settings[name] for name in _SENT}
    sent["adapt"] = tuple(sent["adapt"])
    return TrainedWalks(
        run=run,
        library=engine.library,
        plant=plant,
        disturbance=PlantChanges(**settings["disturb"]),
        schedule=schedule,
        drawn=None if box is None else DrawnRobots(run.robot, box, settings["seed"]),
        threads=1,
        **sent,
    )
