"""A family of systems beside walkers: what the rest of the house asks of it."""

import importlib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from neuralgaits.certificate.proof_file.check import CheckResult
from neuralgaits.certificate.proof_file.reader import Claims


@dataclass(frozen=True)
class SystemFamily:
    """A family of systems.

    Attributes:
        name: name in configs of runs and models of proof files.
        words: its name in a sentence, with an article.
        built_in: what each robot that comes with it is, by name.
        recognises: whether a robot, by name or path, is meant for this family.
        assumptions: assumptions of its proofs.
        with_levels: adds what follows for trajectories to the result of a checked proof file.
    """

    name: str
    words: str
    built_in: Mapping[str, str]
    recognises: Callable[[str | Path], bool]
    assumptions: tuple[str, ...]
    with_levels: Callable[[CheckResult, Claims], CheckResult]


def imported_when_called(place: str) -> Callable[[str | Path], bool]:
    """Return a family's test of robots at MODULE:FUNCTION, a module that brings MuJoCo."""
    module, _, name = place.partition(":")

    def recognises(robot: str | Path) -> bool:
        return getattr(importlib.import_module(module), name)(robot)

    return recognises


@dataclass(frozen=True)
class Screen:
    """Lines that a command ends with.

    Attributes:
        answer: first word of the sentence, green if the answer is yes, yellow if there is none.
        sentence: rest of it.
        table: column names and rows; None for no table.
        facts: names and values, one a line.
    """

    answer: str = ""
    sentence: str = ""
    table: tuple[tuple[str, ...], Sequence[tuple[str, ...]]] | None = None
    facts: Sequence[tuple[str, Any]] = ()


@dataclass(frozen=True)
class VerbResult:
    """Result of a verb of a family.

    Attributes:
        result: record that `--json` prints.
        good: whether the answer is yes.
        screen: the result for a person.
        undecided: whether there is no answer.
        run: an opened run, or a live page that is being served, that the Python call returns in
            place of the record; None for the record.
    """

    result: Any
    good: bool
    screen: Screen
    undecided: bool = False
    run: Any = None

    @property
    def returned(self) -> Any:
        """Opened run or page if there is one, else the record."""
        return self.result if self.run is None else self.run


def _nothing(*_: Any) -> None:
    """Show no progress."""


class ProgressCallbacks:
    """Callbacks of a verb for its progress.

    Attributes:
        trained: called with (step, steps, loss).
        proved: called with (share, boxes).
        begun: called when the settings are checked.
    """

    def __init__(
        self,
        *,
        trained: Callable[[int, int, float], None] | None = None,
        proved: Callable[[float, int], None] | None = None,
        begun: Callable[[], None] | None = None,
    ):
        """Take callbacks; None for one that nobody wants."""
        self.trained, self.proved = trained or _nothing, proved or _nothing
        self.begun = begun or _nothing
