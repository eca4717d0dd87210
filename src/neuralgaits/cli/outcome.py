"""A verb's answer: what is printed, and how it is judged."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class Outcome:
    """A verb's answer.

    Attributes:
        result: what `--json` prints.
        good: False if the answer is no.
        table: shows the result to a person.
        brief: shows its few most important lines; None if the whole is that short.
        undecided: True if there is no answer.
        then: what goes on once the answer is printed, as a page that is served; None for nothing.
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
