"""Structures of `c/walk.h` for one robot: ctypes for shared data, NumPy for records.

The headers are read, so that each structure is written once. Sizes are compared with the library's
own when it is loaded.
"""

import ctypes
import re
from collections.abc import Iterator, Mapping
from ctypes import Structure, c_char_p, c_double, c_int, c_uint32, c_void_p
from functools import cache, lru_cache
from importlib import resources
from typing import Any, NamedTuple

import numpy as np

from neuralgaits.export import output_folder


class StructLayout(NamedTuple):
    """Types of the C structures for one robot."""

    scene: type[Structure]
    """Type of the C structure `ng_scene`."""
    walk: type[Structure]
    """Type of the C structure `ng_walk`."""
    schedule: type[Structure]
    """Type of the C structure `ng_schedule`."""
    record: np.dtype
    """Type of the C structure `ng_record`."""


@lru_cache
def layout_of(leg_joints: int, actuated: int, commands: int = 0, step: int = 0) -> StructLayout:
    """Return the types of a robot and a gait.

    Args:
        leg_joints: number of joints of a leg.
        actuated: number of actuated joints of both legs.
        commands: number of the gait's commands.
        step: how many numbers the gait computes once a step.
    """
    sizes = {
        "NG_LEGS": 2,
        "NG_LEG_JOINTS": leg_joints,
        "NG_ACTUATED": actuated,
        "NG_COORDINATES": actuated + 1,
        "NG_COMMANDS": commands,
        "NG_STEP": step,
    }
    text = _headers()
    if not commands:
        for_commands = r"^#if NG_COMMANDS$.*?^#endif"
        text = re.sub(for_commands, "", text, flags=re.DOTALL | re.MULTILINE)
    without_directives = re.sub(r"^\s*#.*$", "", text, flags=re.MULTILINE)
    types: dict[str, Any] = {
        "int": c_int,
        "uint32_t": c_uint32,
        "double": c_double,
        "ng_real": c_double,
    }
    declaration = r"\b(struct|enum)\b\s*(\w*)\s*\{([^}]*)\}\s*(\w*)\s*;"
    for kind, tag, body, name in re.findall(declaration, without_directives):
        if kind == "enum":
            types[name] = c_int
        else:
            fields = list(_fields(body, types, sizes))
            types[name or tag] = type(name or tag, (Structure,), {"_fields_": fields})
    return StructLayout(
        types["ng_scene"], types["ng_walk"], types["ng_schedule"], np.dtype(types["ng_record"])
    )


@cache
def _headers() -> str:
    """Return the headers that declare the structures, without comments."""
    shipped = output_folder.shipped() | output_folder.adaptation()
    folder = resources.files("neuralgaits.simulation.native") / "c"
    texts = [shipped[name] for name in ("controller.h", "estimator.h", "adapt.h")]
    texts += [(folder / name).read_text(encoding="utf-8") for name in ("clf_qp.h", "walk.h")]
    return re.sub(r"/\*.*?\*/", "", "\n".join(texts), flags=re.DOTALL)


def _fields(
    body: str, types: Mapping[str, Any], sizes: Mapping[str, int]
) -> Iterator[tuple[str, Any]]:
    """Yield name and type of each field of a structure.

    Args:
        body: text between the braces.
        types: types by their names in C.
        sizes: sizes of arrays by their names in C.
    """
    for declaration in filter(None, map(str.strip, body.split(";"))):
        if function := re.search(r"\(\*(\w+)\)\(", declaration):
            yield function[1], c_void_p
            continue
        kind, variables = declaration.removeprefix("const ").split(maxsplit=1)
        for star, name, lengths in re.findall(r"(\*?)\s*(\w+)((?:\[\w+\])*)", variables):
            if star:
                yield name, c_char_p if kind == "char" else c_void_p
                continue
            own = types[kind]
            for length in reversed(re.findall(r"\w+", lengths)):
                own = own * (sizes[length] if length in sizes else int(length))
            yield name, own


def pointer(array: np.ndarray | None) -> c_void_p:
    """Return the address of an array's first element; null without one."""
    return c_void_p(None) if array is None else c_void_p(array.ctypes.data)


def address(function: Any) -> int:
    """Return the address of a function of a loaded library."""
    value = ctypes.cast(function, c_void_p).value
    assert value is not None
    return value
