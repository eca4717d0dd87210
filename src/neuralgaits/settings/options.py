"""Marks of the fields of a class of settings, and the words of a command line that give them."""

import typing
from collections.abc import Callable
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

import tyro
from tyro.conf import Fixed, Positional
from tyro.constructors import PrimitiveConstructorSpec

from neuralgaits._argument_types import given_in_python, refuse_huge, typed
from neuralgaits._called_with import marks_in
from neuralgaits.runs.shell_words import named

POSITIONAL: Any = typing.get_args(Positional[int])[1]
ONLY_PYTHON: Any = typing.get_args(Fixed[int])[1]
"""Marks of words without a flag, and of settings that the command line does not have."""


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
            name = field.name
            value = getattr(self, field.name)
            hint = hints[field.name]
            if value is field.default:
                continue
            refuse_huge(name, value)
            check = given_in_python if ONLY_PYTHON in marks_in(hint) else typed
            object.__setattr__(self, name, check(name, value, hint))


def words_of(settings: Any, kind: type | None = None) -> list[str]:
    """Return settings as words of the command line, without those that have their usual value.

    Args:
        settings: object with the settings.
        kind: class whose fields to write; that of the object if None.
    """
    kind = kind or type(settings)
    marks = marks_of(kind)
    alone = list[str]()
    options = list[str]()
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
