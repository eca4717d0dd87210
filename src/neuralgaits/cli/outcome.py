"""A verb's answer: what is printed, and how it is judged."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class Outcome:
    """A verb's answer.

    Attributes:
        result: what `--json` prints.
        good: False if the answer is no.
        table: shows the result to a person.
        undecided: True if there is no answer.
    """

    result: dict[str, Any]
    good: bool
    table: Callable[[dict[str, Any]], None]
    undecided: bool = False

    def show(self) -> None:
        """Print the result for a person on stdout."""
        self.table(self.result)
