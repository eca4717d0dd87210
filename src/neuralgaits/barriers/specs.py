"""The built-in gait specifications by name, and a user's own from FILE.py:NAME."""

from collections.abc import Callable
from functools import partial, wraps
from pathlib import Path
from types import ModuleType
from typing import Any, NamedTuple, ParamSpec

from neuralgaits.barriers import commanded_spec as _commanded_spec
from neuralgaits.barriers import flat_feet as _flat_feet
from neuralgaits.barriers import hzd as _hzd
from neuralgaits.barriers import paper as _paper
from neuralgaits.barriers import robust as _robust
from neuralgaits.barriers import rugged as _rugged
from neuralgaits.barriers import walking as _walking
from neuralgaits.barriers.spec import GaitSpec
from neuralgaits.barriers.spec_files import spec_from_file
from neuralgaits.errors import SpecError
from neuralgaits.gait.commands import Commands
from neuralgaits.robots import PlanarBiped
from neuralgaits.robots.parameter_box import Box
from neuralgaits.robots.robot_file import RobotFile
from neuralgaits.robots.robot_source import planar_biped

__all__ = [
    "BUILT_IN",
    "at_speed",
    "authors",
    "commanded",
    "flat_footed",
    "for_robot",
    "hzd",
    "is_built_in",
    "load",
    "paper",
    "paper_walks",
    "robust",
    "rugged",
    "source_path",
    "walking",
]

P = ParamSpec("P")


def _robot_checked(
    make: Callable[P, GaitSpec], *, flat_feet: bool = False
) -> Callable[P, GaitSpec]:
    """Refuse anything but a robot as the first argument of a spec, and flat feet unless allowed.

    A spec of point feet says nothing of soles: its gaits would tip. Raises: InputError, SpecError.
    """

    @wraps(make)
    def call(*args: P.args, **kwargs: P.kwargs) -> GaitSpec:
        if args or "robot" in kwargs:
            robot = planar_biped(args[0] if args else kwargs["robot"])
            if robot.feet is not None and not flat_feet:
                raise _flat_footed_refused(make.__name__, robot)
        return make(*args, **kwargs)

    return call


def _flat_footed_refused(name: str, robot: Any) -> SpecError:
    return SpecError(
        f"spec {name}: expected a robot on point feet, found flat feet at {robot.name}: leave "
        "--spec out, or give the robot point feet with "
        "`neuralgaits inspect FILE --planarise OUT.xml`"
    )


at_speed = _robot_checked(_commanded_spec.at_speed)
authors = _robot_checked(_paper.authors)
commanded = _robot_checked(_commanded_spec.commanded)
flat_footed = _robot_checked(_flat_feet.flat_footed, flat_feet=True)
hzd = _robot_checked(_hzd.hzd)
paper = _robot_checked(_paper.paper)
paper_walks = _robot_checked(_paper.paper_walks)
robust = _robot_checked(_robust.robust)
rugged = _robot_checked(_rugged.rugged)


@wraps(_walking.walking)
def _walking_on_its_feet(robot: PlanarBiped, *args: Any, **kwargs: Any) -> GaitSpec:
    """Return the default spec of a robot: the one of flat feet, if it has some."""
    if robot.feet is None:
        return _walking.walking(robot, *args, **kwargs)
    if args or kwargs:
        raise _flat_footed_refused("walking with settings of its own", robot)
    return _flat_feet.flat_footed(robot)


walking = _robot_checked(_walking_on_its_feet, flat_feet=True)


class BuiltInSpec(NamedTuple):
    """A spec that comes with the package and that gaits are trained for."""

    make: Callable[[PlanarBiped], GaitSpec]
    """Make it for a robot."""
    description: str
    """Words about it, as `robots` shows them."""
    module: ModuleType
    """Module that defines it."""


BUILT_IN = {
    "walking": BuiltInSpec(
        walking,
        "default: walks physically, provable; hybrid invariance by construction",
        _walking,
    ),
    "walking-mlp": BuiltInSpec(
        partial(walking, policy="mlp"),
        "the same for a free network, which learns to match through the impact",
        _walking,
    ),
    _flat_feet.NAME: BuiltInSpec(
        flat_footed,
        "default for robots with flat feet, whose soles stay flat on the floor",
        _flat_feet,
    ),
    _rugged.NAME: BuiltInSpec(
        rugged,
        "faster, with lifted feet: for pushes, slopes and floors that it does not know of",
        _rugged,
    ),
    "paper": BuiltInSpec(
        paper,
        "Table 1 of the paper, the paper's optimiser settings (ReLU, not provable)",
        _paper,
    ),
    "paper-walks": BuiltInSpec(
        paper_walks, "Table 1, and the least that makes it walk (ReLU, not provable)", _paper
    ),
    "authors": BuiltInSpec(
        authors, "conditions and schedule of the authors' code (ReLU, not provable)", _paper
    ),
}
"""Specs by the names that `train --spec` takes."""
GIVEN = _hzd.NAME
"""Name of the spec of given gaits, which cannot be trained."""
FILELESS_SPEC = "# A GaitSpec made in Python"
"""First words of the file that a run keeps of a spec that no file defines."""


def is_built_in(name: str) -> bool:
    """Return whether a spec comes with the package."""
    return name in BUILT_IN or name == GIVEN


def for_robot(name: str, robot: RobotFile) -> str:
    """Return the name of the spec that suits a robot: "walking" is another one on flat feet.

    Raises: SpecError for a built-in spec of point feet, and a robot with flat ones.
    """
    if robot.feet is None or name == _flat_feet.NAME or not is_built_in(name):
        return name
    if name == "walking":
        return _flat_feet.NAME
    raise _flat_footed_refused(name, robot)


def load(
    name: str,
    robot: RobotFile,
    commands: Commands = (),
    speed: float | None = None,
    parameters: Box | None = None,
    degree: int | None = None,
) -> GaitSpec:
    """Return the spec of that name for a robot.

    Args:
        name: one of `BUILT_IN`, or FILE.py:NAME where NAME is a `GaitSpec` or a function robot
            -> GaitSpec.
        robot: the robot the spec is for.
        commands: commands that the gait receives at each touchdown; for "walking" only.
        speed: mean speed to aim at (m/s); for "walking" only, without commands.
        parameters: box of robots that it is meant for; for "walking" only, without one speed.
        degree: degree of the polynomials of a given gait; for "hzd" only, and needed there.

    Raises: InputError on anything but a robot, SpecError on names and settings that do not fit.
    """
    robot = planar_biped(robot)
    if robot.feet is not None and (commands or speed is not None or parameters):
        raise SpecError(
            f"expected one gait without a speed, commands or --parameters for a robot with flat "
            f"feet, found one at {robot.name}: leave them out, or give the robot point feet with "
            "`neuralgaits inspect FILE --planarise OUT.xml`"
        )
    name = for_robot(name, robot)
    if name == GIVEN:
        if degree is None or parameters or commands or speed is not None:
            raise SpecError(
                f"expected a spec to train for, found {name!r}, which is of gaits that are given: "
                "`neuralgaits optimise` and `neuralgaits import-gait` make runs of them"
            )
        return hzd(robot, degree)
    if parameters:
        if name != "walking" or speed is not None:
            raise SpecError(
                "expected spec walking, without one speed, for a gait with --parameters, found "
                f"{name!r}{'' if speed is None else ', with one'}: leave the others out, or give "
                "a range of speeds"
            )
        return robust(robot, parameters, commands)
    if (commands or speed is not None) and name != "walking":
        raise SpecError(
            f"expected spec walking for a gait with a speed or commands, found {name!r}: leave "
            "--spec out, or build a spec with specs.commanded in a file of your own"
        )
    if commands:
        return commanded(robot, commands, speed=speed)
    if speed is not None:
        return at_speed(robot, float(speed))
    if name in BUILT_IN:
        return BUILT_IN[name].make(robot)
    return spec_from_file(name, robot, BUILT_IN)


def source_path(name: str) -> Path:
    """Return the Python file that defines a spec, to be copied into a run."""
    if name == GIVEN:
        return Path(str(_hzd.__file__))
    if name in BUILT_IN:
        return Path(str(BUILT_IN[name].module.__file__))
    return Path(name.rpartition(":")[0])
