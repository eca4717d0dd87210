"""Files that a simulation writes beside its summary: logs of its walks, a copy of its plant."""

from pathlib import Path

from neuralgaits import logs
from neuralgaits.analysis.run import Run
from neuralgaits.records.simulated import PLANT, WALK_SUMMARY
from neuralgaits.robots import registry
from neuralgaits.robots.robot_source import RobotSource
from neuralgaits.runs import write_text
from neuralgaits.runs.atomic import refuse_unwritable
from neuralgaits.runs.outputs import refuse_outputs
from neuralgaits.settings import SimulateSettings
from neuralgaits.simulation import video as films
from neuralgaits.simulation.walk import Walk


def output_files(settings: SimulateSettings, run: Run) -> tuple[list[Path], list[Path]]:
    """Return logs and videos to write. Raises: InputError if one cannot be, or is an input."""
    files = [] if settings.log is None else log_files(Path(settings.log), settings.episodes)
    refuse_unwritable(*(run.path / file for file in (WALK_SUMMARY, PLANT)), own=True)
    videos = [] if settings.video is None else [Path(settings.video)]
    named = (settings.plant, settings.commands, settings.terrain, settings.joints)
    inputs = [Path(file) for file in named if isinstance(file, str | Path)]
    refuse_outputs([*files, *videos], inputs, run=run.path)
    for file in files:
        logs.refuse_unwritable_log(file)
    for video in videos:
        films.check(video)
    return files, videos


def kept_plant(trained: Run, plant: RobotSource | None, walk: Walk) -> str | None:
    """Return the name that gives the same plant: a built-in robot, or a copy that the run keeps."""
    if plant is None or str(plant) in registry.built_in():
        return None if plant is None else str(plant)
    write_text(trained.path / PLANT, walk.plant.robot.layout.xml)
    return PLANT


def log_files(first: Path, episodes: int) -> list[Path]:
    """Return the paths of all walks' logs; each has its own file, since each has its own clock."""
    more = (first.with_stem(f"{first.stem}-{number}") for number in range(1, episodes))
    return [first, *more]
