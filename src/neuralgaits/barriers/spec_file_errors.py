"""Mistakes in a user's own spec file, in one line: file and line, mistake, known names.

An exception raised while a line of such a file runs is for the user to mend: at its import, while
it builds a spec, or when a condition of it is evaluated, however deep below. The modules that
`specs` makes of such files have names that no other module has, which identify their frames.
"""

import contextlib
import difflib
import re
import traceback
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import jax

from neuralgaits.barriers import functions
from neuralgaits.errors import NeuralGaitsError, SpecError
from neuralgaits.gait import Point

PREFIX = "neuralgaits_user_"
"""Prefix of the names of modules that are made of users' files."""


@contextlib.contextmanager
def blamed() -> Iterator[None]:
    """Turn an exception of a user's file into a SpecError; leave all other exceptions unchanged.

    `sys.exit` in such a file is a mistake, too: it would end the command without an answer. Only
    Ctrl-C passes through.
    """
    try:
        yield
    except (NeuralGaitsError, KeyboardInterrupt):
        raise
    except BaseException as error:
        place = mistake(error)
        if place is None:
            raise
        raise place from error


def mistake(error: BaseException) -> SpecError | None:
    """Return an exception as a mistake in a user's file; None if no line of one was running."""
    frames = [
        (frame.f_code.co_filename, line)
        for frame, line in traceback.walk_tb(error.__traceback__)
        if str(frame.f_globals.get("__name__", "")).startswith(PREFIX)
    ]
    if not frames:
        return None
    file, line = frames[-1]
    return SpecError(f"{file}:{line}: {reason(error)}; mend that line")


def misread(error: Exception, file: Path) -> SpecError:
    """Describe a file that is not Python, or not text."""
    if not isinstance(error, SyntaxError):
        return SpecError(f"{file}: {reason(error)}; mend it")
    return SpecError(f"{file}:{error.lineno or 1}: {type(error).__name__}: {error.msg}; mend it")


def miswritten(name: str, error: BaseException, file: Path | None) -> SpecError:
    """Describe a badly built condition whose fault appears when package code evaluates it.

    Args:
        name: name of the condition.
        error: error that was raised.
        file: file that defines it, if any: the line is the first with the condition's name.
    """
    where = ""
    if file is not None:
        lines = file.read_text(encoding="utf-8", errors="replace").splitlines()
        quoted = (f'"{name}"', f"'{name}'")
        numbers = [n for n, line in enumerate(lines, 1) if any(q in line for q in quoted)]
        where = f"{file}:{numbers[0]}: " if numbers else f"{file}: "
    return SpecError(
        f"{where}condition {name!r} cannot be evaluated: {reason(error)}; expected a function of "
        "one Point that returns numbers, and bounds that are numbers"
    )


def reason(error: BaseException) -> str:
    """Describe an error in the words of Python, with the names that are available."""
    name, owner = getattr(error, "name", None), getattr(error, "obj", None)
    if isinstance(error, AttributeError) and name and owner is not None:
        return _without(owner, str(name))
    lines = [line.strip() for line in str(error).splitlines() if line.strip()]
    tracer = re.compile(r"'\w*Tracer'")  # Text of an array while JAX traces.
    longest = 300  # Largest number of characters of a foreign message; JAX writes paragraphs.
    message = tracer.sub("'array'", lines[0])[:longest].rstrip(".") if lines else ""
    return f"{type(error).__name__}: {message}" if message else type(error).__name__


def _without(owner: Any, name: str) -> str:
    """Describe an attribute that does not exist."""
    names = [one for one in dir(owner) if not one.startswith("_")]
    close = difflib.get_close_matches(name, names, 1)
    message = f"{_kind(owner)} has no {name!r}"
    if not isinstance(owner, Point):
        return f"{message}, did you mean {close[0]!r}?" if close else message
    hint = f"did you mean {close[0]!r}? " if close else ""
    if hasattr(functions, name):
        hint = f"write functions.{name}(p); "
    return f"{message}, {hint}it has {', '.join(names)}"


def _kind(owner: Any) -> str:
    if isinstance(owner, jax.Array):
        return "an array"
    if isinstance(owner, type):
        return f"class {owner.__name__}"
    if hasattr(owner, "__spec__") and hasattr(owner, "__name__"):
        return f"module {owner.__name__}"
    return f"a {type(owner).__name__}"
