"""Reading the attributes of a JAX equation: calls, source lines, data types."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import jax
import numpy as np

CALLS = frozenset(
    {
        "checkpoint",
        "closed_call",
        "core_call",
        "custom_jvp_call",
        "custom_vjp_call",
        "custom_vjp_call_jaxpr",
        "jit",
        "pjit",
        "remat",
        "remat2",
    }
)
"""Primitives that only call a function."""


def called(equation: Any, operands: Sequence[Any]) -> tuple[Any, Sequence[Any], list] | None:
    """Return the function an equation calls: its jaxpr, constants and arguments, or None."""
    name, params = equation.primitive.name, equation.params
    if name == "cond" and isinstance(operands[0], np.ndarray):
        # The branch is known: a switch between platforms, of which the default is taken.
        branch = params["branches"][int(operands[0])]
        return branch.jaxpr, branch.consts, list(operands[1:])
    if name not in CALLS:
        return None
    jaxpr = next(params[key] for key in ("jaxpr", "call_jaxpr", "fun_jaxpr") if key in params)
    inner = getattr(jaxpr, "jaxpr", jaxpr)
    return inner, getattr(jaxpr, "consts", ()), list(operands)


def default_platform(platforms: Sequence[Any]) -> int:
    """Return the index of the entry of `platforms` that holds for no platform in particular."""
    return next(i for i, entry in enumerate(platforms) if entry is None)


def function_file(equation: Any) -> str:
    """Return the file of the function that an equation calls; empty if none, or unknown."""
    jaxpr = equation.params.get("jaxpr")
    jaxpr = getattr(jaxpr, "jaxpr", jaxpr)
    place = getattr(getattr(jaxpr, "debug_info", None), "func_src_info", None) or ""
    return place.partition(" at ")[2].rpartition(":")[0]


def calls_library(equation: Any) -> bool:
    """Return whether an equation calls a function of JAX itself."""
    return function_file(equation).startswith(str(Path(jax.__file__).parent))


def contracts_nothing(product: Any) -> bool:
    """Return whether a `dot_general` sums over no element at all."""
    (axes, _), _ = product.params["dimension_numbers"]
    shape = product.invars[0].aval.shape
    return any(shape[axis] == 0 for axis in axes)


def frames(equation: Any) -> list[tuple[str, int]]:
    """Return the (file, line) that made an equation, innermost first; empty if JAX has none."""
    traceback = getattr(getattr(equation, "source_info", None), "traceback", None)
    result = []
    for frame in getattr(traceback, "frames", ()):
        line = getattr(frame, "line_num", None) or getattr(frame, "start_line", 0)
        result.append((getattr(frame, "file_name", "<unknown>"), line))
    return result
