"""Change a robot file into a supported one, and list every change in one line.

It is for planar bipeds with features that the theory lacks: flat feet on ankles, a free joint for a
root, contact of shanks and thighs, springs, sensors, names left out. Masses stay where they are: a
foot without its joint is welded, and MuJoCo adds it to the shank. Numbers that only the user knows,
as torque limits and joint ranges, are not made up. A URDF, a robot with arms or one that moves in
space becomes its sagittal section first (`section`).
"""

import re
from collections.abc import Collection
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from neuralgaits.errors import ManyProblems, RobotError
from neuralgaits.robots.mjcf.compiled import compile_text
from neuralgaits.robots.mjcf.edit import MjcfEdit
from neuralgaits.robots.mjcf.file_problems import note_problems
from neuralgaits.robots.mjcf.kept_feet import keep_flat_feet
from neuralgaits.robots.mjcf.lenient_compilation import compile_what_can_be
from neuralgaits.robots.mjcf.loader import robot_from_text
from neuralgaits.robots.mjcf.planar_changes import AFTER_FEET, BEFORE_FEET
from neuralgaits.robots.mjcf.point_feet import give_point_feet
from neuralgaits.robots.mjcf.refuse_or_note import all_noted, attempt
from neuralgaits.robots.mjcf.section import needs_section, section
from neuralgaits.robots.mjcf.urdf import is_urdf, mjcf_of_urdf


@dataclass(frozen=True)
class PlanarText:
    """A robot file that can be loaded.

    Attributes:
        text: MJCF.
        changes: one line each; empty if the file needed none and is unchanged.
    """

    text: str
    changes: tuple[str, ...]


Feet = Literal["point", "flat"]


def planarise(
    text: str,
    name: str,
    feet: Feet = "point",
    weld: Collection[str] = (),
    folder: Path | None = None,
) -> PlanarText:
    """Change a robot file into that of a planar biped.

    Args:
        text: MJCF without includes, or a URDF.
        name: name of the robot, unless the file names its model.
        feet: "point" welds ankles and ends both legs in a sphere; "flat" keeps them.
        weld: names of joints to weld, at the file's first keyframe or at zero.
        folder: folder from which the meshes of a URDF are searched.

    Returns: `PlanarText`. Raises: RobotError if the file is not a planar biped even so, naming
    what is in the way; ManyProblems if several things are.
    """
    try:
        changed = _changed(text, name, feet, frozenset(weld), folder)
        robot_from_text(changed.text, name)
    except RobotError as error:
        problems = _problems(text, name, feet, frozenset(weld), folder)
        problems = [_in_words_of(text, one) for one in problems or (str(error),)]
        lines = [f"{name} cannot be planarised: {one}" for one in problems]
        raise (ManyProblems(lines) if len(lines) > 1 else RobotError(lines[0])) from None
    return changed


def _changed(
    text: str, name: str, feet: Feet, weld: frozenset[str], folder: Path | None
) -> PlanarText:
    """Return the file with all changes, not loaded yet. Raises: RobotError, as `planarise`."""
    before: tuple[str, ...] = ()
    urdf = is_urdf(text)
    if urdf:
        text, before = mjcf_of_urdf(text, name, folder or Path(), weld)
    if urdf or weld or needs_section(compile_text(text, name)):
        text, more = section(text, name, weld)
        before += more
    edit = MjcfEdit(text, name)
    edit.changes += before
    for step in (*BEFORE_FEET, keep_flat_feet if feet == "flat" else give_point_feet, *AFTER_FEET):
        edit.compile()
        attempt(None, step, edit)
    return PlanarText(edit.text() if edit.changes else text, tuple(edit.changes))


def _problems(
    text: str, name: str, feet: Feet, weld: frozenset[str], folder: Path | None
) -> tuple[str, ...]:
    """Return everything that is in the way of `planarise`, one line each."""
    with all_noted() as noted:
        if not is_urdf(text):
            _, text = compile_what_can_be(text, name)
        changed = attempt(None, _changed, text, name, feet, weld, folder)
        if changed is not None:
            attempt(None, note_problems, changed.text, name)
    return tuple(noted)


def _in_words_of(text: str, problem: str) -> str:
    """Return a problem with a remedy for the file that it was found in, and for this command."""
    problem = problem.replace("are treated; weld some", "are treated; weld some, by --weld JOINT")
    if is_urdf(text):
        # Problems of the MJCF that a URDF was written as, and the words for the URDF.
        for_urdf = (
            (
                r"joint (.+?) is not actuated: add .*",
                r'joint \1 has no effort limit: write effort="LIMIT" (N m) into its <limit>',
            ),
            (
                r"joint (.+?) has no range: add .*",
                r"joint \1 has no range: make it revolute, with lower and upper in its <limit>",
            ),
        )
        for pattern, words in for_urdf:
            problem = re.sub(pattern, words, problem)
    return problem
