"""A CSV file as header and numbers; a broken row is refused by file, row and column."""

import csv
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from neuralgaits._inputs import MOST_LOG_BYTES, refuse_unreadable
from neuralgaits._types import Float, Int
from neuralgaits.errors import InputError, reason

REPAIR = "delete the row: a missing row counts as a gap"


@dataclass(frozen=True, eq=False)
class Sheet:
    """Header and numbers of a CSV file.

    Attributes:
        path: path of the file.
        header: cells of the first row; empty if that row holds numbers.
        numbers: numbers of all other rows, empty lines left out; none is NaN or infinite. [k, c]
        rows: number of each row in the file, counted from 1. [k]
    """

    path: Path
    header: tuple[str, ...]
    numbers: Float[np.ndarray, "k c"]
    rows: Int[np.ndarray, " k"]


@dataclass(frozen=True)
class Text:
    """Cells of a CSV file, or of what was made a table.

    Attributes:
        path: path of the file.
        header: cells of the first row; empty if that row holds numbers.
        cells: cells of the other rows, each row with its number in the file.
        head: place of the header, for messages.
    """

    path: Path
    header: tuple[str, ...]
    cells: list[tuple[int, list[str]]]
    head: str = "row 1"

    @property
    def header_place(self) -> str:
        """Place of the header, with the file, for messages."""
        return f"log {self.path}, {self.head}"

    @property
    def width(self) -> int:
        """Number of cells in the first row below the header, 0 if there is none."""
        return len(self.cells[0][1]) if self.cells else 0


def text_of(path: Path) -> Text:
    """Read the cells of a file. Raises: InputError if there is no text to read."""
    refuse_unreadable(path, MOST_LOG_BYTES)
    try:
        with path.open(newline="", encoding="utf-8-sig") as file:
            reader = csv.reader(file, skipinitialspace=True)
            rows = [(reader.line_num, _trimmed(row)) for row in reader]
    except (OSError, ValueError, csv.Error) as error:
        raise InputError(
            f"log {path}: expected a CSV file of a walk, found none that can be read "
            f"({reason(error)}): name the file that the robot wrote"
        ) from None
    rows = [(line, row) for line, row in rows if row]
    if not rows:
        raise InputError(f"log {path}: expected a header and rows, found an empty file")
    first = rows[0][1]
    header = () if all(_is_number(cell) for cell in first) else tuple(first)
    return Text(path, header, rows[1:] if header else rows)


def sheet_of(text: Text, names: tuple[str, ...]) -> Sheet:
    """Return the numbers of a file whose columns have these names.

    Raises: InputError naming file, row and column for a row of another width or a cell that is no
    finite number.
    """
    width = len(names)
    for row, cells in text.cells:
        if len(cells) != width:
            raise InputError(
                f"log {text.path}, row {row}, column {min(len(cells), width) + 1}: expected "
                f"{width} columns, found {len(cells)}: {REPAIR}"
            )
    rows = np.array([row for row, _ in text.cells], dtype=int)
    try:
        numbers = np.array([cells for _, cells in text.cells], dtype=np.float64)
        numbers = numbers.reshape(-1, width)
    except ValueError:
        numbers = None
    if numbers is None or not np.all(np.isfinite(numbers)):
        row, column, cell = _first_bad(text)
        raise InputError(
            f"log {text.path}, row {row}, column {names[column]}: expected a finite number, "
            f"found {cell!r}: {REPAIR}"
        )
    return Sheet(text.path, text.header, numbers, rows)


def _trimmed(row: list[str]) -> list[str]:
    """Strip blanks around cells, and an empty cell after a comma at the end of a line."""
    cells = [cell.strip() for cell in row]
    return cells[:-1] if cells and not cells[-1] else cells


def _is_number(cell: str) -> bool:
    try:
        float(cell)
    except ValueError:
        return False
    return True


def _first_bad(text: Text) -> tuple[int, int, str]:
    for row, cells in text.cells:
        for column, cell in enumerate(cells):
            if not _is_number(cell) or not np.isfinite(float(cell)):
                return row, column, cell[:40]
    raise AssertionError("every cell is a finite number")
