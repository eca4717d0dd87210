"""Outcome of a verb: its result, and how it is judged and shown."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class Outcome:
    """Outcome of a verb.

    Attributes:
        result: record that `--json` prints.
        good: False if the answer is no.
        table: function that shows the whole result to a person.
        brief: function that shows its key lines; None if the whole is that short.
        undecided: True if there is no answer.
        then: function to run after the answer is printed, such as serving a page; None for nothing.
    """

    result: Mapping[str, Any]
    good: bool
    table: Callable[[Any], None]
    undecided: bool = False
    brief: Callable[[Any], None] | None = None
    then: Callable[[], None] | None = None

    def show(self, *, verbose: bool = False) -> None:
        """Print the result for a person on stdout, in full if `verbose`."""
        show = self.table if verbose or self.brief is None else self.brief
        show(self.result)
