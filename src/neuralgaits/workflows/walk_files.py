"""Files that a simulation writes beside its summary: logs of its walks, a copy of its plant."""

from pathlib import Path

from neuralgaits.analysis.run import Run
from neuralgaits.records.simulated import PLANT
from neuralgaits.robots import RobotSource, registry
from neuralgaits.runs import write_text
from neuralgaits.simulation.walk import Walk


def log_files(first: Path, episodes: int) -> list[Path]:
    """Return the paths of all walks' logs; each has its own file, since each has its own clock."""
    more = (first.with_stem(f"{first.stem}-{number}") for number in range(1, episodes))
    return [first, *more]


def kept_plant(trained: Run, plant: RobotSource | None, walk: Walk) -> str | None:
    """Return the name that gives the same plant: a built-in robot, or a copy that the run keeps."""
    if plant is None or str(plant) in registry.built_in():
        return None if plant is None else str(plant)
    write_text(trained.path / PLANT, walk.plant.robot.layout.xml)
    return PLANT
