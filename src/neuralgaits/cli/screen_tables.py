"""Tables and sentences for a person, on stdout: whole words, within the terminal's width."""

import re
from collections.abc import Iterable, Sequence
from typing import Any

from rich.console import Console
from rich.table import Table
from rich.text import Text

from neuralgaits._printable import visible
from neuralgaits.cli.invocation import as_called
from neuralgaits.runs.shell_words import PROGRAM

Words = str | Text
ROWS = 12
"""Most rows of a table; a sentence sums up the rest."""
_GAP = 2
"""Spaces between two columns of a table."""


def show_sentence(*parts: Words, indent: int = 0, hang: int = 0) -> None:
    """Print text; continuation lines are indented by `hang`.

    Words that are too long are not broken, nor is text between backticks, so that it can be copied.
    """
    console = Console(highlight=False)
    text = Text.assemble(*(part if isinstance(part, Text) else as_called(part) for part in parts))
    lines: list[tuple[int, int]] = []
    for word in re.finditer(r"(?:`[^`]*`|\S)+", text.plain):
        room = console.width - indent - (hang if len(lines) > 1 else 0)
        if lines and word.end() - lines[-1][0] <= room:
            lines[-1] = (lines[-1][0], word.end())
        else:
            # What stands in front of the first word is meant, as a label that is filled up.
            lines.append((word.start() if lines else 0, word.end()))
    for number, (start, end) in enumerate(lines):
        margin = " " * (indent + (hang if number else 0))
        console.print(Text.assemble(margin, text[start:end]), soft_wrap=True)


def show_table(head: Sequence[str], rows: Iterable[Sequence[Words]]) -> None:
    """Print a table; if words do not fit, print each row's cells below one another.

    It prints nothing if there are no rows. Columns without content are left out: their room is for
    the others.
    """
    console = Console(highlight=False)
    cells = [
        [cell if isinstance(cell, Text) else Text(as_called(cell)) for cell in row] for row in rows
    ]
    if not cells:
        return
    filled = [number for number in range(len(head)) if any(row[number].plain for row in cells)]
    head, cells = [head[n] for n in filled], [[row[n] for n in filled] for row in cells]
    columns = [
        (Text(name), *column) for name, column in zip(head, zip(*cells, strict=True), strict=True)
    ]
    words = [" ".join(text.plain for text in column).split() for column in columns]
    # Of every column, its longest word.
    widths = [max(map(len, column), default=0) for column in words]
    if sum(widths) + _GAP * (len(widths) - 1) > console.width:
        for row in cells:
            for number, (name, cell) in enumerate(zip(head, row, strict=True)):
                if cell.plain:
                    label = f"{name}: " if name else ""
                    show_sentence(label, cell, indent=_GAP if number else 0, hang=_GAP)
        return
    table = Table(box=None, pad_edge=False, header_style="bold")
    # Shared out here: left to itself, the library cuts words off where room is short.
    natural = [
        max(text.cell_len for text in column) - width
        for column, width in zip(columns, widths, strict=True)
    ]
    spare = console.width - sum(widths) - _GAP * (len(widths) - 1)
    for name, width, more in zip(head, widths, _shared_out(spare, natural), strict=True):
        table.add_column(name, width=width + more)
    for row in cells:
        table.add_row(*row)
    console.print(table)


def show_break() -> None:
    """Print the empty line between two tables."""
    Console(highlight=False).print()


def _shared_out(spare: int, wanted: Sequence[int]) -> list[int]:
    """Share room out between columns; who wants little gets it, so that few columns wrap."""
    shares = [0] * len(wanted)
    by_need = sorted(range(len(wanted)), key=lambda place: wanted[place])
    for done, place in enumerate(by_need):
        shares[place] = min(wanted[place], spare // (len(wanted) - done))
        spare -= shares[place]
    return shares


def show_facts(facts: Iterable[tuple[str, Any]]) -> None:
    """Print labels with values, one pair on each line; paths and commands are not broken."""
    pairs = [(label, value if isinstance(value, Text) else number(value)) for label, value in facts]
    width = max((len(label) for label, _ in pairs), default=0) + _GAP
    for label, value in pairs:
        if str(value).startswith(f"{PROGRAM} "):
            line = Text(f"{label.ljust(width)}{as_called(str(value))}")
            Console(highlight=False).print(line, soft_wrap=True)
        else:
            show_sentence(label.ljust(width), value, hang=width)


def number(value: Any) -> str:
    """Format a value for a person: four digits, lists with commas, - for None."""
    if isinstance(value, float):
        return f"{value:.4g}"
    if isinstance(value, list | tuple):
        return ", ".join(number(item) for item in value)
    return "-" if value is None else visible(str(value))


def short(value: float | None) -> str:
    """Format a number with three digits, - for None."""
    return "-" if value is None else f"{value:.3g}"


def verdict(word: str) -> Text:
    """Return a verdict in its colour."""
    colours = {
        "proved": "green",
        # Not green: what is consistent with itself may be about nothing.
        "consistent": "cyan",
        "refuted": "red",
        "rejected": "red",
        "undecided": "yellow",
    }
    return Text(word, colours[word])
