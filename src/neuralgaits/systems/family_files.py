"""Robot files of families beside walkers: the built-in one, and a user's."""

from pathlib import Path
from typing import Any

from neuralgaits._printable import printable
from neuralgaits.errors import InputError
from neuralgaits.records.installed import BuiltIn, CatalogueEntry
from neuralgaits.robots.mjcf.text import standalone_text
from neuralgaits.runs.atomic import write_new
from neuralgaits.runs.shell_words import command
from neuralgaits.systems.trained_system import TrainedSystem


def robot_text(system: TrainedSystem, source: str | Path) -> tuple[str, str]:
    """Return the MJCF text of a built-in robot or of a file, and a name for it.

    Raises: RobotError if the file cannot be read.
    """
    if str(source) in system.family.built_in and not Path(str(source)).exists():
        return system.robot_file.read_text(encoding="utf-8"), str(source)
    path = Path(source)
    return standalone_text(path), printable(path.stem)


def inspect_robot(system: TrainedSystem, source: str | Path) -> Any:
    """Describe a robot file. Raises: RobotError with all that is wrong with it."""
    return system.robot_facts(*system.read(*robot_text(system, source)))


def write_robot(system: TrainedSystem, name: str, out: Path | None) -> BuiltIn:
    """Write a built-in robot's file. Raises: InputError if there is a file, or no name."""
    if out is None:
        line = command("robots", name, "--out", f"{name}.xml")
        raise InputError(f"expected a file to write {name} to, found none: write `{line}`")
    write_new(out, system.robot_file.read_text(encoding="utf-8"))
    return BuiltIn((CatalogueEntry(name, system.family.built_in[name]),), (), str(out))
