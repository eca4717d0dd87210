"""Types of arguments: what a Python caller passes is of the type that a signature says."""

import inspect
import re
import sys
import types
import typing
from collections.abc import Callable, Iterable, Mapping
from functools import cache, wraps
from pathlib import Path
from typing import Any, ParamSpec, TypeVar

import numpy as np
from typeguard import CollectionCheckStrategy, TypeCheckError, check_type

from neuralgaits._called_with import PythonType, marks_in
from neuralgaits._inputs import refuse_no_path
from neuralgaits._printable import shown
from neuralgaits.errors import InputError

P = ParamSpec("P")
Result = TypeVar("Result")


def type_checked(function: Callable[P, Result]) -> Callable[P, Result]:
    """Refuse arguments of other types than a function's signature says. Raises: InputError."""
    signature = inspect.signature(function)
    # Looked up at the first call: most programs call a few of these functions.
    hints = cache(lambda: typing.get_type_hints(function, include_extras=True))

    @wraps(function)
    def call(*args: P.args, **kwargs: P.kwargs) -> Result:
        bound = signature.bind(*args, **kwargs)
        for name, value in bound.arguments.items():
            if value is not signature.parameters[name].default:
                refuse_huge(name, value)
                bound.arguments[name] = typed(name, value, hints()[name])
        return function(*bound.args, **bound.kwargs)

    return call


def typed(name: str, value: Any, hint: Any) -> Any:
    """Return a value of the type that it is to have: NumPy's numbers as Python's, lists as tuples.

    Raises: InputError if it is of another type.
    """
    wider = next((mark for mark in marks_in(hint) if isinstance(mark, PythonType)), None)
    if wider is not None:
        if wider.kinds and not isinstance(value, wider.kinds):
            raise InputError(f"{name}: expected {wider.words}, found {shown(value)}")
        paths = value if isinstance(value, list | tuple) else [value]
        for one in paths:
            if Path in wider.elements or (Path in wider.kinds and isinstance(one, str | Path)):
                refuse_no_path(f"{name} as {wider.words}", one)
        return value
    plain = value.item() if isinstance(value, np.generic) else value
    bare = typing.get_args(hint)[0] if marks_in(hint) else hint
    for one in (plain, tuple(plain)) if isinstance(plain, list) else (plain,):
        try:
            converted = check_type(
                one, bare, collection_check_strategy=CollectionCheckStrategy.ALL_ITEMS
            )
        except TypeCheckError:
            continue
        # Python counts True as 1.
        parts = converted if isinstance(converted, list | tuple) else [converted]
        if bare is bool or not any(isinstance(part, bool) for part in parts):
            if Path in typing.get_args(bare) and isinstance(converted, str | Path):
                refuse_no_path(f"{name} as a path", converted)
            return converted
    raise InputError(f"{name}: expected {_in_words(bare)}, found {shown(value)}")


def refuse_huge(name: str, value: Any, depth: int = 0) -> None:
    """Refuse whole numbers that no float holds, in lists and mappings as well. Raises: InputError.

    Whatever computes with one, or writes it, would raise an error of its own.
    """
    parts: Iterable[Any] = ()
    if isinstance(value, int) and abs(value) > sys.float_info.max:
        raise InputError(f"{name}: expected a number of at most 308 digits, found {shown(value)}")
    if isinstance(value, list | tuple | set):
        parts = value
    elif isinstance(value, Mapping):
        parts = value.values()
    deepest = 4  # Levels of lists and mappings that are looked at: settings have two.
    for one in parts if depth < deepest else ():
        refuse_huge(name, one, depth + 1)


def given_in_python(name: str, value: Any, hint: Any) -> Any:
    """Return the value of a setting that the command line does not have: a text as its path.

    Of a function only that it can be called is looked at.

    Raises: InputError if it is of another type.
    """
    wider = next((mark for mark in marks_in(hint) if isinstance(mark, PythonType)), None)
    kinds = wider.kinds if wider else _kinds(typing.get_args(hint)[0])
    if Path in kinds and isinstance(value, str | Path):
        refuse_no_path(f"{name} as a path", value)
        return Path(value)
    if any(_fits(value, kind) for kind in kinds):
        return value
    raise InputError(f"{name}: expected {wider or _in_words(hint)}, found {shown(value)}")


def _fits(value: Any, kind: Any) -> bool:
    if typing.get_origin(kind) is Callable:
        return callable(value)
    return kind is Any or not isinstance(kind, type) or isinstance(value, kind)


def _kinds(hint: Any) -> tuple[Any, ...]:
    """Return the parts of a union; a type alone as it is."""
    union = typing.get_origin(hint) in (typing.Union, types.UnionType)
    return typing.get_args(hint) if union else (hint,)


def _in_words(hint: Any) -> str:
    """Return a type as a Python caller writes it, without None."""
    kinds = _kinds(typing.get_args(hint)[0] if marks_in(hint) else hint)
    words = (_one_in_words(one) for one in kinds if one is not types.NoneType)
    return " or ".join(
        re.sub(r"\b(typing|collections\.abc|pathlib|neuralgaits(\.\w+)*)\.", "", one)
        for one in words
    )


def _one_in_words(kind: Any) -> str:
    if typing.get_origin(kind) is typing.Literal:
        return f"one of {', '.join(map(str, typing.get_args(kind)))}"
    return inspect.formatannotation(kind)
