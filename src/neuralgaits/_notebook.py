"""HTML of an object in a notebook: a heading and a small table, all text escaped."""

import html
from collections.abc import Iterable, Sequence

TIGHTEST = 5
"""Number of conditions that a notebook shows."""


def table(title: str, rows: Iterable[Sequence[object]], head: Sequence[str] = ()) -> str:
    """Return an HTML table; colours are the notebook's own.

    Args:
        title: one line above it.
        rows: rows of cells.
        head: names of the columns; none for names and values.
    """
    top = f"<thead><tr>{_cells('th', head)}</tr></thead>" if head else ""
    body = "".join(f"<tr>{_cells('td', row)}</tr>" for row in rows)
    return f"<p><b>{html.escape(title)}</b></p><table>{top}<tbody>{body}</tbody></table>"


def _cells(kind: str, row: Sequence[object]) -> str:
    style = "text-align:left"
    return "".join(f'<{kind} style="{style}">{html.escape(str(cell))}</{kind}>' for cell in row)
