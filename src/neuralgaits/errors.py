"""All errors that a caller can meet: one root, few leaves, and Ctrl-C.

A message is one line and says what was expected, what was found, and what to do. On the command
line an error exits with 2; NonFiniteError, MismatchError and ConvergenceError exit with 1.
"""

import errno
import os
from collections.abc import Sequence

from neuralgaits._printable import shortened


class NeuralGaitsError(Exception):
    """Root of all errors raised on purpose by this package."""

    def __str__(self) -> str:
        """Return the message, with long words from the caller's input shortened."""
        return shortened(super().__str__())


class InputError(NeuralGaitsError):
    """The caller passed something that cannot be used: a value, shape, name or flag."""


class RobotError(InputError):
    """A robot file is malformed, or describes a robot that no family of systems can treat."""


class ManyProblems(RobotError):
    """A robot file has several problems.

    Attributes:
        problems: all of them, one line each.
    """

    def __init__(self, problems: Sequence[str]):
        super().__init__("; ".join(problems))
        self.problems = tuple(problems)


class SpecError(InputError):
    """A gait specification is unknown, malformed, or cannot be traced into a Program."""


class RunError(InputError):
    """A run folder is missing, half-written, from another version, or inconsistent."""


class TimeLimitError(RunError):
    """Code of a run, which a process of its own executes, did not end within its time limit."""


class MismatchError(NeuralGaitsError):
    """Exported code does not compile, or does not do what Python does."""


def reason(error: Exception) -> str:
    """Return why a file could not be used, without the number and path that Python adds."""
    words = error.strerror if isinstance(error, OSError) else None
    return words or str(error)


def is_full(error: BaseException) -> bool:
    """Return whether an error means that the disk was full, whichever library raised it."""
    if isinstance(error, OSError):
        # A full disk, a full quota, or a limit of one user.
        full = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG)
        return error.errno in full
    return os.strerror(errno.ENOSPC) in str(error)


class Interrupted(KeyboardInterrupt):
    """Ctrl-C during work that can be resumed.

    Attributes:
        command: command line that resumes it.
        more: text after the message.
    """

    def __init__(self, command: str, more: str = ""):
        super().__init__(command)
        self.command = command
        self.more = more


class NonFiniteError(NeuralGaitsError):
    """A computation met NaN or infinity; the message names the file that reproduces it."""


class ConvergenceError(NeuralGaitsError):
    """A solver ended without a solution; the message says how."""
