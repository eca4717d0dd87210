"""Outcome of a verb: its result, and how it is judged and shown."""

from collections.abc import Callable, Mapping
from dataclasses import KW_ONLY, dataclass
from typing import Any


@dataclass(frozen=True)
class Outcome:
    """Outcome of a verb.

    Attributes:
        result: record that `--json` prints.
        good: False if the answer is no.
        table: function that shows the whole result to a person; with `brief`, what that leaves out.
        brief: function that shows its key lines, with `hint` also how to get the rest; None if
            the whole is that short.
        undecided: True if there is no answer.
        then: function to run after the answer is printed, such as serving a page; None for nothing.
    """

    result: Mapping[str, Any]
    _: KW_ONLY
    good: bool
    table: Callable[[Any], None]
    undecided: bool = False
    brief: Callable[..., None] | None = None
    then: Callable[[], None] | None = None

    def show(self, *, verbose: bool = False) -> None:
        """Print the result for a person on stdout; if `verbose`, in full above the key lines."""
        if verbose or self.brief is None:
            self.table(self.result)
        if self.brief is not None:
            # Last, so that the command to give next ends either screen.
            self.brief(self.result, hint=not verbose)
