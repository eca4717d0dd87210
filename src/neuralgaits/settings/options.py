"""Marks of the fields of a class of settings, and the words of a command line that give them."""

import inspect
import re
import types
import typing
from collections.abc import Callable
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

import numpy as np
import tyro
from typeguard import CollectionCheckStrategy, TypeCheckError, check_type
from tyro.conf import Fixed, Positional
from tyro.constructors import PrimitiveConstructorSpec

from neuralgaits._called_with import PythonType, marks_in
from neuralgaits._inputs import refuse_no_path
from neuralgaits.errors import InputError
from neuralgaits.runs.shell_words import named

POSITIONAL: Any = typing.get_args(Positional[int])[1]
ONLY_PYTHON: Any = typing.get_args(Fixed[int])[1]
"""Marks of words without a flag, and of settings that the command line does not have."""
_EVERY_ITEM = CollectionCheckStrategy.ALL_ITEMS


def arg(**settings: Any) -> Any:
    """Return `tyro.conf.arg` whose help omits a default of None or False."""
    return tyro.conf.arg(help_behavior_hint=_default, **settings)


def _default(label: str) -> str:
    return "" if label in ("", "None", "False") else f"(default: {label})"


def option(metavar: str, read: Callable[[str], Any], write: Callable[[Any], str]) -> Any:
    """Return the mark of a setting that has a form of its own on the command line.

    Args:
        metavar: the form, for the help.
        read: reads one word of the command line; raises InputError.
        write: writes a value as `read` reads it, every number exactly.
    """
    return PrimitiveConstructorSpec(
        nargs=1,
        metavar=metavar,
        instance_from_str=lambda words: read(words[0]),
        is_instance=lambda value: True,
        str_from_instance=lambda value: [str(value) if value is None else write(value)],
    )


def marks_of(settings: type) -> dict[str, tuple[Any, ...]]:
    """Return the marks of each field that the command line has; `ONLY_PYTHON` has no others."""
    hints = typing.get_type_hints(settings, include_extras=True)
    marks = {field.name: marks_in(hints[field.name]) for field in fields(settings)}
    return {name: those for name, those in marks.items() if ONLY_PYTHON not in those}


@dataclass(frozen=True)
class Settings:
    """Settings of a verb: values of other types than the fields say are refused."""

    def __post_init__(self) -> None:
        hints = typing.get_type_hints(type(self), include_extras=True)
        for field in fields(self):
            value = getattr(self, field.name)
            if value is not field.default and ONLY_PYTHON not in marks_in(hints[field.name]):
                object.__setattr__(self, field.name, _typed(field.name, value, hints[field.name]))


def _typed(name: str, value: Any, hint: Any) -> Any:
    """Return a value of the type that a field has: NumPy's numbers as Python's, lists as tuples.

    Raises: InputError if it is of another type.
    """
    wider = next((mark for mark in marks_in(hint) if isinstance(mark, PythonType)), None)
    if wider is not None:
        if wider.kinds and not isinstance(value, wider.kinds):
            raise InputError(f"{name}: expected {wider.words}, found {value!r:.60}")
        paths = value if isinstance(value, list | tuple) else [value]
        for one in paths:
            if Path in wider.elements or (Path in wider.kinds and isinstance(one, str | Path)):
                refuse_no_path(f"{name} as {wider.words}", one)
        return value
    plain = value.item() if isinstance(value, np.generic) else value
    bare = typing.get_args(hint)[0] if marks_in(hint) else hint
    for one in (plain, tuple(plain)) if isinstance(plain, list) else (plain,):
        try:
            found = check_type(one, bare, collection_check_strategy=_EVERY_ITEM)
        except TypeCheckError:
            continue
        # Python counts True as 1.
        parts = found if isinstance(found, list | tuple) else [found]
        if bare is bool or not any(isinstance(part, bool) for part in parts):
            return found
    raise InputError(f"{name}: expected {_in_words(bare)}, found {value!r:.60}")


def _in_words(hint: Any) -> str:
    """Return a type as a Python caller writes it, without None."""
    union = typing.get_origin(hint) in (typing.Union, types.UnionType)
    kinds = typing.get_args(hint) if union else (hint,)
    words = (_one_in_words(one) for one in kinds if one is not types.NoneType)
    return " or ".join(re.sub(r"\b(typing|collections\.abc|pathlib)\.", "", one) for one in words)


def _one_in_words(kind: Any) -> str:
    if typing.get_origin(kind) is typing.Literal:
        return f"one of {', '.join(map(str, typing.get_args(kind)))}"
    return inspect.formatannotation(kind)


def words_of(settings: Any, kind: type | None = None) -> list[str]:
    """Return settings as words of the command line, without those that have their usual value.

    Args:
        settings: object with the settings.
        kind: class whose fields to write; that of the object if None.
    """
    kind = kind or type(settings)
    marks, alone, options = marks_of(kind), list[str](), list[str]()
    for field in fields(kind):
        value = getattr(settings, field.name)
        if field.name not in marks or value is None or value == field.default:
            continue
        flag = f"--{field.name.replace('_', '-')}"
        if POSITIONAL in marks[field.name]:
            many = value if isinstance(value, tuple) else (value,)
            alone += [_word(one, marks[field.name]) for one in many]
            continue
        word = _word(value, marks[field.name])
        if value is True:
            options.append(flag)
        else:
            # A word that begins like a flag is part of its own.
            options += [f"{flag}={word}"] if word.startswith("-") else [flag, word]
    return [*alone, *options]


def _word(value: Any, marks: tuple[Any, ...]) -> str:
    for mark in marks:
        if isinstance(mark, PrimitiveConstructorSpec):
            return mark.str_from_instance(value)[0]
    if isinstance(value, Path):
        return named(value)
    return repr(value) if isinstance(value, float) else str(value)
