"""The built-in gait specifications by name, and a user's own from FILE.py:NAME."""

import importlib.util
import sys
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from neuralgaits.barriers import paper as _paper
from neuralgaits.barriers import walking as _walking
from neuralgaits.barriers.paper import authors, paper
from neuralgaits.barriers.spec import GaitSpec
from neuralgaits.barriers.walking import walking
from neuralgaits.errors import NeuralGaitsError, SpecError

if TYPE_CHECKING:
    from neuralgaits.robots import PlanarBiped

__all__ = ["DESCRIPTIONS", "authors", "load", "paper", "source_path", "walking"]

_BUILT_IN = {
    "walking": walking,
    "walking-mlp": partial(walking, policy="mlp"),
    "paper": paper,
    "authors": authors,
}
DESCRIPTIONS = {
    "walking": "default: walks physically, provable; hybrid invariance by construction",
    "walking-mlp": "the same for a free network, which learns to match through the impact",
    "paper": "Table 1 of the paper, the paper's optimiser settings (ReLU, not provable)",
    "authors": "conditions and schedule of the authors' code (ReLU, not provable)",
}


def load(name: str, robot: "PlanarBiped") -> GaitSpec:
    """The spec of that name for a robot.

    Args:
        name: "walking", "paper", "authors", or FILE.py:NAME where NAME is a `GaitSpec` or a
            function robot -> GaitSpec.
        robot: the robot the spec is for.
    """
    if name in _BUILT_IN:
        return _BUILT_IN[name](robot)
    path, separator, attribute = name.rpartition(":")
    if not separator or not path.endswith(".py"):
        raise SpecError(
            f"unknown spec {name!r}: expected one of {', '.join(_BUILT_IN)}, or FILE.py:NAME"
        )
    value = getattr(_module(path), attribute, None)
    if value is None:
        raise SpecError(f"spec {name!r}: {path} defines no {attribute!r}")
    spec = _applied(name, value, robot) if callable(value) else value
    if not isinstance(spec, GaitSpec):
        raise SpecError(f"spec {name!r}: expected a GaitSpec, found {type(spec).__name__}")
    return spec


def _applied(name: str, function: Callable, robot: "PlanarBiped"):
    try:
        return function(robot)
    except NeuralGaitsError:
        raise
    except Exception as error:  # The user's function may raise anything.
        reason = " ".join(str(error).split())
        raise SpecError(f"spec {name!r}: {type(error).__name__}: {reason}") from error


def source_path(name: str) -> Path:
    """The Python file that defines a spec, to be copied into a run."""
    modules = {"walking": _walking, "walking-mlp": _walking, "paper": _paper, "authors": _paper}
    if name in modules:
        return Path(str(modules[name].__file__))
    return Path(name.rpartition(":")[0])


def _module(path: str):
    file = Path(path)
    if not file.is_file():
        raise SpecError(f"spec file {path}: no such file")
    specification = importlib.util.spec_from_file_location(f"neuralgaits_user_{file.stem}", file)
    if specification is None or specification.loader is None:
        raise SpecError(f"spec file {path}: expected a Python file")
    module = importlib.util.module_from_spec(specification)
    # Dataclasses look their module up while they are made.
    sys.modules[specification.name] = module
    try:
        specification.loader.exec_module(module)
    except Exception as error:  # The user's file may raise anything.
        raise SpecError(f"spec file {path}: {type(error).__name__}: {error}") from error
    return module
