"""Make a robot file that the theory covers from one that it does not cover yet."""

from contextlib import suppress
from dataclasses import replace
from pathlib import Path

from neuralgaits.errors import InputError, RobotError
from neuralgaits.records.inspected import RobotFacts
from neuralgaits.robots import PlanarBiped, load_robot, registry
from neuralgaits.robots.mjcf.loader import robot_text
from neuralgaits.robots.mjcf.planariser import Feet, planarise
from neuralgaits.runs.atomic import write_new
from neuralgaits.runs.shell_words import command
from neuralgaits.workflows.inspect import inspect


def planarise_file(source: str | Path, out: Path, feet: Feet = "point") -> RobotFacts:
    """Write a changed copy of a robot file, and describe the robot in it.

    Args:
        source: name of a built-in robot, or path of an MJCF file; never changed.
        out: file to make; a copy of the source if that needs no change.
        feet: of `planarise`.

    Returns: `RobotFacts` of the new file, with `written` and `changes`.
    Raises: RobotError if the file cannot be made into a planar biped, InputError if there is a file
        at `out`; nothing is written then.
    """
    text, name = robot_text(source)
    made = planarise(text, name, feet)
    write_new(out, made.text)
    changes = (*_resolved(source, text), *made.changes)
    return replace(inspect(load_robot(out)), written=str(out), changes=changes)


def robot_from(source: PlanarBiped | str | Path | None) -> PlanarBiped:
    """Return a robot, loaded if it is named; the error for a file names a fix, if there is one.

    Raises: RobotError, as `load_robot`; InputError if there is none.
    """
    if source is None:
        raise InputError(
            "expected ROBOT, found none: name one, as in "
            f"`{command('train', 'amber3m')}`, or a run to go on with by --resume RUN"
        )
    if isinstance(source, PlanarBiped):
        return source
    try:
        return load_robot(source)
    except RobotError as error:
        if "--planarise" in str(error):
            raise
        feet = _feet_that_can_be_had(source)
        if feet is None:
            raise error from None
        out = f"{Path(source).stem}-planar.xml"
        more = ("--feet", feet) if feet != "point" else ()
        line = command("inspect", str(source), "--planarise", out, *more)
        raise RobotError(f"{error}; or have a copy made that can be treated: `{line}`") from None


def _feet_that_can_be_had(source: str | Path) -> Feet | None:
    """Return the feet with which a copy of a file can be treated: flat ones if it has some."""
    kinds: tuple[Feet, ...] = ("flat", "point")
    for feet in kinds:
        with suppress(RobotError):
            planarise(*robot_text(source), feet)
            return feet
    return None


def _resolved(source: str | Path, text: str) -> tuple[str, ...]:
    """Return one line of explanation if the text differs from the file's own."""
    if str(source) in registry.built_in() or Path(source).read_text(encoding="utf-8") == text:
        return ()
    return ("includes put in place, files of meshes and textures named by their full paths",)
