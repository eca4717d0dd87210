"""Refusal of a robot file: at the first problem, or with all of them noted.

A loader stops at the first problem. `inspect` reads on behind one, with numbers that are not there
as NaN, and so names every problem of a file at once.
"""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from typing import TypeVar

from neuralgaits.errors import RobotError

T = TypeVar("T")
_NOTED: ContextVar[dict[str, None] | None] = ContextVar("noted", default=None)
"""Problems so far, in order and each once; None where the first one is raised."""


def refuse(problem: str) -> None:
    """Raise RobotError with a problem, or note it and return if all are to be noted."""
    noted = _NOTED.get()
    if noted is None:
        raise RobotError(problem)
    noted[problem] = None


def notes_problems() -> bool:
    """Return whether problems are noted, so that numbers that are not there are NaN."""
    return _NOTED.get() is not None


def is_noted(start: str) -> bool:
    """Return whether a problem that begins with these words is noted."""
    return any(problem.startswith(start) for problem in _NOTED.get() or ())


def attempt(fallback: T, read: Callable[..., T], *args: object) -> T:
    """Return what a function reads; where problems are noted, a fallback if it refuses.

    What is read behind a problem may make no sense, as a link without a length: an error there says
    nothing more than the problem.
    """
    noted = _NOTED.get()
    if noted is None:
        return read(*args)
    try:
        return read(*args)
    except RobotError as error:
        refuse(str(error))
    except (ArithmeticError, LookupError, ValueError, AssertionError):
        if not noted:
            raise
    return fallback


@contextmanager
def all_noted() -> Iterator[dict[str, None]]:
    """Note problems instead of raising the first.

    Yields: a dict whose keys are the problems so far, in order.
    """
    noted: dict[str, None] = {}
    token = _NOTED.set(noted)
    try:
        yield noted
    finally:
        _NOTED.reset(token)
