"""Make a robot file that the theory covers from one that it does not cover yet."""

from collections.abc import Callable, Collection
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path

from neuralgaits._printable import printable
from neuralgaits.errors import InputError, ManyProblems, RobotError
from neuralgaits.records.inspected import RobotFacts
from neuralgaits.robots import PlanarBiped, RobotSource, load_robot, registry
from neuralgaits.robots.mjcf.file_problems import problems_of_file
from neuralgaits.robots.mjcf.loader import robot_from_text, robot_text
from neuralgaits.robots.mjcf.planariser import Feet, planarise
from neuralgaits.robots.mjcf.text import urdf_text
from neuralgaits.runs.atomic import write_new
from neuralgaits.runs.shell_words import command
from neuralgaits.workflows.inspect import inspect


@dataclass(frozen=True)
class PlanarCopy:
    """A copy of a robot file that the theory covers.

    Attributes:
        robot: the robot in it.
        text: MJCF, with the changes in a comment at the top.
        changes: what is different from the source, a line each.
        warnings: what is unusual about the copy, or lost in it, a line each.
    """

    robot: PlanarBiped
    text: str
    changes: tuple[str, ...]
    warnings: tuple[str, ...]


def planar_copy(source: str | Path, feet: Feet = "point", weld: Collection[str] = ()) -> PlanarCopy:
    """Return a changed copy of a robot file; the arguments are those of `planarise_file`.

    Raises: RobotError if the file cannot be made into a planar biped.
    """
    dropped: list[str] = []
    text, name, folder = _text_of(source, dropped)
    copy = planarise(text, name, feet, weld, folder)
    resolved = () if folder is not None else _resolved(source, text, dropped)
    warnings = _about_cut_feet(text, name, weld, folder) if feet == "point" else ()
    robot = robot_from_text(copy.text, name)
    warnings = (*inspect(robot).warnings, *warnings)
    return PlanarCopy(robot, copy.text, (*resolved, *copy.changes), warnings)


def planarise_file(
    source: str | Path, out: Path, feet: Feet = "point", weld: Collection[str] = ()
) -> RobotFacts:
    """Write a changed copy of a robot file, and describe the robot in it.

    Args:
        source: name of a built-in robot, or path of an MJCF or URDF file; never changed.
        out: file to make; a copy of the source if that needs no change.
        feet: see `planarise`.
        weld: joints to weld, as in `planarise`.

    Returns: `RobotFacts` of the new file, with `written` and `changes`.
    Raises: RobotError if the file cannot be made into a planar biped, InputError if there is a file
        at `out`; nothing is written then.
    """
    copy = planar_copy(source, feet, weld)
    write_new(out, copy.text)
    facts = inspect(load_robot(out))
    return replace(facts, written=str(out), changes=copy.changes, warnings=copy.warnings)


def _about_cut_feet(
    text: str, name: str, weld: Collection[str], folder: Path | None
) -> tuple[str, ...]:
    """Return a line if a robot has large flat feet that become points; () otherwise."""
    with suppress(RobotError):
        robot = robot_from_text(planarise(text, name, "flat", weld, folder).text, name)
        if robot.feet is not None:
            sole = float(robot.feet.heel + robot.feet.toe)
            # A shorter sole may as well be a point.
            if sole > 0.1 * robot.leg_length:
                return (
                    f"soles of {1e3 * sole:.3g} mm, {sole / robot.leg_length:.2g} of the leg, are "
                    "cut to points, and their ankles' motors are lost: --feet flat keeps them",
                )
    return ()


def robot_from(
    source: RobotSource | None,
    feet: Feet | None = None,
    weld: Collection[str] = (),
    say: Callable[[str], None] | None = None,
) -> PlanarBiped:
    """Return a robot, loaded if it is named; an error names all problems of a file and a fix.

    Args:
        source: the robot, its name or the path of its file.
        feet: feet of a changed copy of the file; None for the file as it is.
        weld: joints to weld in that copy.
        say: called with a line about its changes, and with each of its warnings.

    Raises: RobotError as `load_robot`, ManyProblems with all problems of a file that has several;
        InputError if there is none.
    """
    if source is None:
        raise InputError(
            "expected ROBOT, found none: name one, as in "
            f"`{command('train', 'amber3m')}`, or a run to go on with by --resume RUN"
        )
    if isinstance(source, PlanarBiped):
        return source
    if feet is not None:
        copy = planar_copy(source, feet, weld)
        if say is not None:
            things = f"{len(copy.changes)} thing{'' if len(copy.changes) == 1 else 's'}"
            say(f"changed: {things} in {source}, listed in robot.xml of the run")
            for line in copy.warnings:
                say(f"warning: {line}")
        return copy.robot
    try:
        return load_robot(source)
    except RobotError as error:
        problems = list(_problems(source)) or [str(error)]
        line = None if any("--planarise" in one for one in problems) else _command_for_copy(source)
        if len(problems) > 1:
            raise ManyProblems([*problems, *([line] if line else [])]) from None
        raise RobotError(problems[0] + (f"; or {line}" if line else "")) from None


def _problems(source: str | Path) -> tuple[str, ...]:
    """Return the problems of a robot file; of a URDF, those that are in the way of a copy."""
    path = Path(source)
    try:
        text = _urdf_at(path)
    except RobotError as error:
        return (str(error),)
    if text is None:
        return problems_of_file(source)
    return _problems_of_urdf(source, text, printable(path.stem), path.parent)


def _problems_of_urdf(source: str | Path, text: str, name: str, folder: Path) -> tuple[str, ...]:
    """Return what is in the way of a copy; that the file is no MJCF, if nothing is."""
    try:
        planarise(text, name, folder=folder)
    except ManyProblems as error:
        return error.problems
    except RobotError as error:
        return (str(error),)
    return problems_of_file(source)


def _text_of(source: str | Path, dropped: list[str] | None = None) -> tuple[str, str, Path | None]:
    """Return the text of a robot and a name for it, and the folder of a URDF; else None.

    The names of pictures that are not there are appended to `dropped`.
    """
    path = Path(source)
    text = _urdf_at(path)
    if text is not None:
        return text, printable(path.stem), path.parent
    return (*robot_text(source, [] if dropped is None else dropped), None)


def _urdf_at(path: Path) -> str | None:
    """Return the text of a URDF at a path; None if something else or nothing is there.

    Raises: RobotError if a file there is unreadable or not XML.
    """
    if str(path) in registry.built_in() or not path.is_file():
        return None
    return urdf_text(path)


def _command_for_copy(source: str | Path) -> str | None:
    """Return words with the command that makes a copy that can be treated; None if none can."""
    feet = _feet_that_can_be_had(source)
    if feet is None:
        return None
    out = f"{Path(source).stem}-planar.xml"
    more = ("--feet", feet) if feet != "point" else ()
    line = command("inspect", str(source), "--planarise", out, *more)
    return f"have a copy made that can be treated: `{line}`"


def _feet_that_can_be_had(source: str | Path) -> Feet | None:
    """Return the feet with which a copy of a file can be treated: flat ones if it has some."""
    kinds: tuple[Feet, ...] = ("flat", "point")
    for feet in kinds:
        with suppress(RobotError):
            text, name, folder = _text_of(source)
            planarise(text, name, feet, folder=folder)
            return feet
    return None


def _resolved(source: str | Path, text: str, dropped: list[str]) -> tuple[str, ...]:
    """Return lines of explanation if the text differs from the file's own."""
    if str(source) in registry.built_in() or Path(source).read_text(encoding="utf-8") == text:
        return ()
    lines = ("includes put in place, files of meshes and textures named by their full paths",)
    most_names = 4  # Number of files that a line names.
    if dropped:
        more = f" and {len(dropped) - most_names} more" if len(dropped) > most_names else ""
        listed = ", ".join(dropped[:most_names])
        lines += (f"pictures not there, left out: {listed}{more}; masses are as given",)
    return lines
