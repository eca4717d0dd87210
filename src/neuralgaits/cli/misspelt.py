"""Words of a command line that were meant otherwise: one line that says what there is.

The parser would refuse them too, with the help of every verb that has an option like it.
"""

import dataclasses
import types
import typing
from collections.abc import Mapping, Sequence
from typing import Annotated, Any

from tyro.conf import Positional

from neuralgaits._names import meant
from neuralgaits.errors import InputError

_NUMBERS = {float: "a number", int: "a whole number"}
_POSITIONAL = typing.get_args(Positional[int])[1]
_COMMON = ("--help", "--verbose")


def refuse_misspelt(words: Sequence[str], verbs: Mapping[str, type]) -> None:
    """Look for a verb and options that are not there or twice, and for numbers that are none.

    Args:
        words: of the command line, the program's name left out.
        verbs: classes of settings by the verb's name.

    Raises: InputError naming the word, and what may have been meant.
    """
    if not words or words[0].startswith("-"):
        return
    verb, *rest = words
    if verb not in verbs:
        if hint := meant(verb, verbs):
            raise InputError(f"no command {verb}; {hint}")
        raise InputError(f"no command {verb}: expected one of {', '.join(verbs)}")
    kinds, seen = _options(verbs[verb]), set()
    for place, word in enumerate(rest):
        if word == "--":
            return
        if not word.startswith("--"):
            continue
        name, separator, value = word.partition("=")
        name = name.replace("_", "-")
        if name not in kinds and name not in _COMMON:
            hint = meant(name, kinds) or f"see `neuralgaits {verb} --help`"
            raise InputError(f"unknown option {name} of {verb}; {hint}")
        if name in seen:
            # The parser would take the last one and say nothing.
            raise InputError(
                f"expected {name} once, found it twice: leave one out, or join NAME=... by commas"
            )
        seen.add(name)
        if separator or place + 1 < len(rest):
            _refuse_no_number(name, kinds.get(name), value if separator else rest[place + 1])


def _refuse_no_number(name: str, kind: type | None, value: str) -> None:
    if kind is None or kind not in _NUMBERS:
        return
    try:
        kind(value)
    except ValueError:
        raise InputError(f"{name}: expected {_NUMBERS[kind]}, found {value!r}") from None


def _options(settings: type) -> dict[str, type | None]:
    """Options of a verb, each with the type of its value where that is a plain one."""
    found: dict[str, type | None] = {}
    hints = typing.get_type_hints(settings, include_extras=True)
    for field in dataclasses.fields(settings):
        kind, marks = _unwrapped(hints[field.name])
        if dataclasses.is_dataclass(kind):
            found |= _options(typing.cast(type, kind))
        elif _POSITIONAL not in marks:
            found[f"--{field.name.replace('_', '-')}"] = kind
    return found


def _unwrapped(hint: Any) -> tuple[type | None, tuple[Any, ...]]:
    """The type in an annotation, None taken out, and the marks around it."""
    marks: tuple[Any, ...] = ()
    while typing.get_origin(hint) is Annotated:
        hint, *more = typing.get_args(hint)
        marks += tuple(more)
    if typing.get_origin(hint) in (typing.Union, types.UnionType):
        kinds = [one for one in typing.get_args(hint) if one is not types.NoneType]
        hint = kinds[0] if len(kinds) == 1 else None
    return hint if isinstance(hint, type) else None, marks
