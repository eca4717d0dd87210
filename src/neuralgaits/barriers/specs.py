"""The built-in gait specifications by name, and a user's own from FILE.py:NAME."""

import ast
import importlib.util
import sys
from collections.abc import Callable
from functools import partial, wraps
from pathlib import Path
from typing import Any, ParamSpec

from neuralgaits._inputs import no_file_at
from neuralgaits._names import meant
from neuralgaits._printable import shown
from neuralgaits.barriers import commanded_spec as _commanded_spec
from neuralgaits.barriers import flat_feet as _flat_feet
from neuralgaits.barriers import hzd as _hzd
from neuralgaits.barriers import paper as _paper
from neuralgaits.barriers import robust as _robust
from neuralgaits.barriers import rugged as _rugged
from neuralgaits.barriers import spec_file_errors
from neuralgaits.barriers import walking as _walking
from neuralgaits.barriers.spec import GaitSpec
from neuralgaits.barriers.spec_file_errors import PREFIX
from neuralgaits.errors import InputError, NeuralGaitsError, SpecError
from neuralgaits.gait.commands import Commands
from neuralgaits.robots import PlanarBiped
from neuralgaits.robots.parameter_box import Box

__all__ = [
    "DESCRIPTIONS",
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


def _of_robot(make: Callable[P, GaitSpec], name: str | None = None) -> Callable[P, GaitSpec]:
    """Refuse anything but a robot as the first argument of a spec, and flat feet if it has a name.

    A spec of point feet says nothing of soles: its gaits would tip. Raises: InputError, SpecError.
    """

    @wraps(make)
    def call(*args: P.args, **kwargs: P.kwargs) -> GaitSpec:
        if args or "robot" in kwargs:
            robot = args[0] if args else kwargs["robot"]
            _refuse_no_robot(robot)
            if name is not None and getattr(robot, "feet", None) is not None:
                raise _flat_footed_refused(name, robot)
        return make(*args, **kwargs)

    return call


def _flat_footed_refused(name: str, robot: Any) -> SpecError:
    return SpecError(
        f"spec {name}: expected a robot on point feet, found flat feet at {robot.name}: leave "
        "--spec out, or give the robot point feet with "
        "`neuralgaits inspect FILE --planarise OUT.xml`"
    )


def _refuse_no_robot(robot: object) -> None:
    if not isinstance(robot, PlanarBiped):
        raise InputError(
            f"robot: expected a PlanarBiped, found {shown(robot)}: load one, as in "
            'load_robot("amber3m")'
        )


at_speed = _of_robot(_commanded_spec.at_speed, "at_speed")
authors = _of_robot(_paper.authors, "authors")
commanded = _of_robot(_commanded_spec.commanded, "commanded")
flat_footed = _of_robot(_flat_feet.flat_footed)
hzd = _of_robot(_hzd.hzd, "hzd")
paper = _of_robot(_paper.paper, "paper")
paper_walks = _of_robot(_paper.paper_walks, "paper_walks")
robust = _of_robot(_robust.robust, "robust")
rugged = _of_robot(_rugged.rugged, "rugged")


@wraps(_walking.walking)
def _walking_on_its_feet(robot: PlanarBiped, *args: Any, **kwargs: Any) -> GaitSpec:
    """Return the default spec of a robot: the one of flat feet, if it has some."""
    if robot.feet is None:
        return _walking.walking(robot, *args, **kwargs)
    if args or kwargs:
        raise _flat_footed_refused("walking with settings of its own", robot)
    return _flat_feet.flat_footed(robot)


walking = _of_robot(_walking_on_its_feet)

_BUILT_IN = {
    "walking": walking,
    "walking-mlp": partial(walking, policy="mlp"),
    _flat_feet.NAME: flat_footed,
    "rugged": rugged,
    "paper": paper,
    "paper-walks": paper_walks,
    "authors": authors,
}
DESCRIPTIONS = {
    "walking": "default: walks physically, provable; hybrid invariance by construction",
    "walking-mlp": "the same for a free network, which learns to match through the impact",
    _flat_feet.NAME: "default for robots with flat feet, whose soles stay flat on the floor",
    "rugged": "faster, with lifted feet: for pushes, slopes and floors that it does not know of",
    "paper": "Table 1 of the paper, the paper's optimiser settings (ReLU, not provable)",
    "paper-walks": "Table 1, and the least that makes it walk (ReLU, not provable)",
    "authors": "conditions and schedule of the authors' code (ReLU, not provable)",
}
GIVEN = _hzd.NAME
"""Name of the spec of given gaits, which cannot be trained."""
_A_FUNCTION = (
    "write a function robot -> GaitSpec, as in `def own(robot): return specs.walking(robot)`"
)
"""Remedy where a file has no spec."""
IN_NO_FILE = "# A GaitSpec made in Python"
"""First words of the file that a run keeps of a spec that no file defines."""


def is_built_in(name: str) -> bool:
    """Return whether a spec comes with the package."""
    return name in DESCRIPTIONS or name == GIVEN


def for_robot(name: str, robot: PlanarBiped) -> str:
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
    robot: PlanarBiped,
    commands: Commands = (),
    speed: float | None = None,
    parameters: Box | None = None,
    degree: int | None = None,
) -> GaitSpec:
    """Return the spec of that name for a robot.

    Args:
        name: one of `DESCRIPTIONS`, or FILE.py:NAME where NAME is a `GaitSpec` or a function robot
            -> GaitSpec.
        robot: the robot the spec is for.
        commands: that the gait receives at each touchdown; for "walking" only.
        speed: mean speed to aim at (m/s); for "walking" only, without commands.
        parameters: box of robots that it is meant for; for "walking" only, without one speed.
        degree: of the polynomials of a given gait; for "hzd" only, and needed there.

    Raises: InputError on anything but a robot, SpecError on names and settings that do not fit.
    """
    _refuse_no_robot(robot)
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
    if commands or speed is not None:
        if name != "walking":
            raise SpecError(
                f"expected spec walking for a gait with a speed or commands, found {name!r}: leave "
                "--spec out, or build a spec with specs.commanded in a file of your own"
            )
        return commanded(robot, commands) if commands else at_speed(robot, float(speed or 0.0))
    if name in _BUILT_IN:
        return _BUILT_IN[name](robot)
    return _from_file(name, robot)


def _from_file(name: str, robot: PlanarBiped) -> GaitSpec:
    """Return the spec at FILE.py:NAME. Raises: SpecError if there is none."""
    path, separator, attribute = name.rpartition(":")
    if not separator and name.endswith(".py"):
        raise SpecError(f"unknown spec {name!r}: expected FILE.py:NAME, {_nameless(name)}")
    if not separator or not path.endswith(".py"):
        hint = meant(name, _BUILT_IN)
        hint = f"{hint} " if hint else ""
        raise SpecError(
            f"unknown spec {name!r}: {hint}expected one of {', '.join(_BUILT_IN)}, or FILE.py:NAME"
        )
    module = _module(path)
    with spec_file_errors.blamed():  # A module may have a `__getattr__`.
        defined = hasattr(module, attribute)
    if not defined:
        known = _defined(path)
        hint = meant(attribute, known)
        there = f": {hint}{' ' if hint else ''}there is {', '.join(known)}" if known else ""
        raise SpecError(f"spec {name!r}: {path} defines no {attribute!r}{there}")
    value = getattr(module, attribute)
    spec = _applied(name, value, robot) if callable(value) else value
    if not isinstance(spec, GaitSpec):
        remedy = f"name a GaitSpec of {path}, or {_A_FUNCTION}"
        if callable(value):
            remedy = f"let {attribute} return one, as in `return specs.walking(robot)`"
        found = f"expected a GaitSpec, found {type(spec).__name__}"
        raise SpecError(f"spec {name!r}: {found}: {remedy}")
    return spec


def _nameless(path: str) -> str:
    """Return what was found where a file is named without a spec in it, and what to do."""
    file = Path(path)
    if not file.is_file():
        return f"found no name, and {no_file_at(file, 'no such file')}: name a file that is there"
    if known := _defined(path):
        return f"found no name; add that of its function or spec, as in {path}:{known[0]}"
    return f"found no name, and no function of one robot in it: {_A_FUNCTION}"


def _defined(path: str) -> list[str]:
    """Return the public functions of one argument of a file, those of a `robot` first.

    They are taken from its text: it is not run.
    """
    try:
        body = ast.parse(Path(path).read_bytes()).body
    except (OSError, SyntaxError, ValueError):
        return []
    functions = [one for one in body if isinstance(one, ast.FunctionDef) and _takes_one(one.args)]
    functions.sort(key=lambda one: "robot" not in ast.unparse(one.args).lower())
    return [one.name for one in functions if not one.name.startswith("_")]


def _takes_one(of: ast.arguments) -> bool:
    """Return whether a function can be called with one argument."""
    places, needed = len(of.posonlyargs) + len(of.args), None in of.kw_defaults
    return not needed and places - len(of.defaults) <= 1 and (places > 0 or of.vararg is not None)


def _applied(name: str, function: Callable, robot: PlanarBiped):
    try:
        with spec_file_errors.blamed():
            return function(robot)
    except NeuralGaitsError:
        raise
    except Exception as error:  # None of its lines has run: it cannot be called like that.
        why = spec_file_errors.reason(error)
        raise SpecError(f"spec {name!r}: expected a function of one robot, found {why}") from error


def source_path(name: str) -> Path:
    """Return the Python file that defines a spec, to be copied into a run."""
    if name == GIVEN:
        return Path(str(_hzd.__file__))
    if name in _BUILT_IN:
        for module in (_rugged, _flat_feet):
            if name == module.NAME:
                return Path(str(module.__file__))
        module = _walking if name.startswith("walking") else _paper
        return Path(str(module.__file__))
    return Path(name.rpartition(":")[0])


def _module(path: str):
    file = Path(path)
    if not file.is_file():
        raise SpecError(f"spec file {path}: {no_file_at(file, 'no such file')}")
    specification = importlib.util.spec_from_file_location(f"{PREFIX}{file.stem}", file)
    if specification is None or specification.loader is None:
        raise SpecError(f"spec file {path}: expected a Python file")
    module = importlib.util.module_from_spec(specification)
    # Dataclasses look their module up while they are made.
    sys.modules[specification.name] = module
    try:
        with spec_file_errors.blamed():
            specification.loader.exec_module(module)
    except NeuralGaitsError:
        raise
    except Exception as error:  # Of the file itself, none of whose lines has run.
        raise spec_file_errors.misread(error, file) from error
    return module
