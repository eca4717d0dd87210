"""A user's own spec: FILE.py:NAME, read from its file, with every mistake in it said by line."""

import ast
import importlib.util
import sys
from collections.abc import Callable, Iterable
from pathlib import Path

from neuralgaits._inputs import no_file_at
from neuralgaits._names import meant
from neuralgaits.barriers import spec_file_errors
from neuralgaits.barriers.spec import GaitSpec
from neuralgaits.barriers.spec_file_errors import PREFIX
from neuralgaits.errors import NeuralGaitsError, SpecError
from neuralgaits.robots import PlanarBiped

_A_FUNCTION = (
    "write a function robot -> GaitSpec, as in `def own(robot): return specs.walking(robot)`"
)
"""Remedy where a file has no spec."""


def spec_from_file(name: str, robot: PlanarBiped, built_in: Iterable[str]) -> GaitSpec:
    """Return the spec at FILE.py:NAME.

    Args:
        name: name of the spec.
        robot: robot that it is for.
        built_in: names that a misspelt one may have meant.

    Raises: SpecError if there is none.
    """
    path, separator, attribute = name.rpartition(":")
    if not separator and name.endswith(".py"):
        raise SpecError(f"unknown spec {name!r}: expected FILE.py:NAME, {_nameless(name)}")
    if not separator or not path.endswith(".py"):
        hint = meant(name, built_in)
        hint = f"{hint} " if hint else ""
        raise SpecError(
            f"unknown spec {name!r}: {hint}expected one of {', '.join(built_in)}, or FILE.py:NAME"
        )
    module = _module(path)
    with spec_file_errors.blamed():  # A module may have a `__getattr__`.
        defined = hasattr(module, attribute)
    if not defined:
        names = _defined(path)
        hint = meant(attribute, names)
        there = f": {hint}{' ' if hint else ''}there is {', '.join(names)}" if names else ""
        raise SpecError(f"spec {name!r}: {path} defines no {attribute!r}{there}")
    value = getattr(module, attribute)
    spec = _applied(name, value, robot) if callable(value) else value
    if not isinstance(spec, GaitSpec):
        remedy = f"name a GaitSpec of {path}, or {_A_FUNCTION}"
        if callable(value):
            remedy = f"let {attribute} return one, as in `return specs.walking(robot)`"
        message = f"expected a GaitSpec, found {type(spec).__name__}"
        raise SpecError(f"spec {name!r}: {message}: {remedy}")
    return spec


def _nameless(path: str) -> str:
    """Return what was found where a file is named without a spec in it, and what to do."""
    file = Path(path)
    if not file.is_file():
        return f"found no name, and {no_file_at(file, 'no such file')}: name a file that is there"
    if names := _defined(path):
        return f"found no name; add that of its function or spec, as in {path}:{names[0]}"
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
