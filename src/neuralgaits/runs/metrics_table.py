"""The table of a training: one row of numbers a checkpoint, as CSV.

The whole table is rewritten each time, so a killed run leaves no half line, and a resumed
one drops rows it is about to compute again. Numbers are written so that they read back exactly.
"""

import csv
import io
import math
from collections.abc import Mapping, Sequence

from neuralgaits._digits import decimal
from neuralgaits.errors import RunError

Row = Mapping[str, float]


def to_csv(rows: Sequence[Row]) -> str:
    """Write header and rows as text; the first row names the columns.

    Raises: ValueError if rows differ.
    """
    if not rows:
        return ""
    buffer = io.StringIO()
    writer = csv.DictWriter(buffer, fieldnames=list(rows[0]), lineterminator="\n")
    writer.writeheader()
    for row in rows:
        if set(row) != set(rows[0]):
            odd = sorted(set(row) ^ set(rows[0]))
            raise ValueError(f"expected the same columns in every row, these differ: {odd}")
        writer.writerow({name: _number(value) for name, value in row.items()})
    return buffer.getvalue()


def from_csv(data: bytes, source: str) -> list[dict[str, float]]:
    """Read the rows of a table written by `to_csv`.

    Raises: RunError naming `source` if a cell is not a number or a row is short.
    """
    line = 1
    rows = []
    try:
        for cells in csv.DictReader(io.StringIO(data.decode())):
            line += 1
            rows.append({name: decimal(value) for name, value in cells.items()})
    except (TypeError, ValueError, csv.Error):
        raise RunError(
            f"expected a number in every column of {source}, line {line} has another "
            "content: restore the file or train again"
        ) from None
    step = "step"  # Column that every table of a training has.
    if any(not (row.get(step, math.nan) >= 0.0 and row[step] < math.inf) for row in rows):
        raise RunError(
            f"expected the number of a step in the column {step} of {source}, found a row "
            "without: restore the file or train again"
        )
    return rows


def _number(value: float) -> str:
    number = float(value)
    return str(int(number)) if number.is_integer() and abs(number) < 2**53 else repr(number)
