"""Result of `report`, as `--json` prints it."""

from collections.abc import Mapping
from dataclasses import dataclass

from neuralgaits.records.record import Record, Texts


@dataclass(frozen=True)
class Lack:
    """Part that a run does not have yet, in words, and the command that makes it."""

    what: str
    command: str


@dataclass(frozen=True, eq=False)
class ReportRecord(Record):
    """Result of writing a report.

    Attributes:
        run, report: the run and the page.
        bytes: size of the page.
        figures: names of the drawn figures.
        missing: parts that are missing.
        damaged: why a part could not be read, by file.
    """

    run: str
    report: str
    bytes: int
    figures: Texts
    missing: tuple[Lack, ...]
    damaged: Mapping[str, str]
