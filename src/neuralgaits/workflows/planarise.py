"""A robot file that can be treated, from one that cannot yet."""

from dataclasses import replace
from pathlib import Path

from neuralgaits.records.inspected import RobotFacts
from neuralgaits.robots import load_robot, registry
from neuralgaits.robots.mjcf.loader import robot_text
from neuralgaits.robots.mjcf.planarise import planarise
from neuralgaits.runs.atomic import write_new
from neuralgaits.workflows.inspect import inspect


def planarise_file(source: str | Path, out: Path) -> RobotFacts:
    """Write a changed copy of a robot file, and describe the robot in it.

    Args:
        source: name of a built-in robot, or path of an MJCF file; never changed.
        out: file to make; a copy of the source if that needs no change.

    Returns: `RobotFacts` of the new file, with `written` and `changes`.
    Raises: RobotError if the file cannot be made into a planar biped, InputError if there is a file
        at `out`; nothing is written then.
    """
    text, name = robot_text(source)
    made = planarise(text, name)
    write_new(out, made.text)
    changes = (*_resolved(source, text), *made.changes)
    return replace(inspect(load_robot(out)), written=str(out), changes=changes)


def _resolved(source: str | Path, text: str) -> tuple[str, ...]:
    """One line if the text is not the file's own word for word."""
    if str(source) in registry.built_in() or Path(source).read_text(encoding="utf-8") == text:
        return ()
    return ("includes put in place, files of meshes and textures named by their full paths",)
