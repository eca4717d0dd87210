"""HTML from data: each text is escaped exactly once, where it becomes HTML.

`Html` marks text that is already escaped. A plain `str` is text and never taken for markup.
"""

import html
import math
from collections.abc import Iterable, Sequence
from typing import Any

from neuralgaits._digits import at_least, at_most


class Html(str):
    """Markup that is safe to put into the page."""

    __slots__ = ()


def text(value: Any) -> Html:
    """Return markup unchanged, and anything else escaped."""
    return value if isinstance(value, Html) else Html(html.escape(str(value)))


def join(parts: Iterable[Any]) -> Html:
    """Join parts one after another, escaping each unless it is markup."""
    return Html("".join(text(part) for part in parts))


def tag(name: str, *parts: Any, **attributes: Any) -> Html:
    """Return an element; `class_` sets `class`, and True makes an attribute without a value."""
    written = "".join(
        f" {key.rstrip('_').replace('_', '-')}"
        + ("" if value is True else f'="{html.escape(str(value))}"')
        for key, value in attributes.items()
        if value is not None and value is not False
    )
    return Html(f"<{name}{written}>{join(parts)}</{name}>")


def paragraph(*parts: Any, class_: str | None = None) -> Html:
    """Return a paragraph that holds the parts."""
    return tag("p", *parts, class_=class_)


def items(entries: Iterable[Any]) -> Html:
    """Return a bulleted list of the entries; nothing if there are none."""
    rows = [tag("li", entry) for entry in entries]
    return tag("ul", *rows) if rows else Html("")


class Section(Html):
    """A part of the page that the list of contents names."""

    __slots__ = ("name", "title")
    name: str
    title: str

    @classmethod
    def of(cls, name: str, title: str, content: Html) -> "Section":
        """Return a part whose element has its name as `id`."""
        html = cls(content)
        html.name, html.title = name, title
        return html


def section(name: str, title: str, *parts: Any) -> Section:
    """Return a section of the page under its heading."""
    return Section.of(name, title, tag("section", tag("h2", title, id=name), *parts))


def missing(*words: Any, line: str | None = None) -> Html:
    """Return a box that says what is missing, with the command that makes it."""
    return tag("div", paragraph(*words), shell([line]) if line else "", class_="missing")


def table(
    caption: str,
    head: Sequence[str],
    rows: Iterable[Sequence[Any]],
    *,
    numbers: str = "",
    cards: bool = False,
) -> Html:
    """Return a table; see `scrolling`.

    Args:
        caption: what the table shows.
        head: heads of the columns.
        rows: cells of each row.
        numbers: one letter for each column, `n` for numbers, which are right-aligned.
        cards: whether a narrow screen shows each row as a card, its cells below one another.
    """
    kinds = ["number" if kind == "n" else None for kind in numbers.ljust(len(head))]
    top = tag(
        "tr", *(tag("th", h, scope="col", class_=k) for h, k in zip(head, kinds, strict=True))
    )
    names = list(head) if cards else [None] * len(head)
    body = [
        tag(
            "tr",
            *(
                tag("td", cell, class_=kind, data_head=name or None)
                for cell, kind, name in zip(row, kinds, names, strict=True)
            ),
        )
        for row in rows
    ]
    whole = tag(
        "table",
        tag("caption", caption),
        tag("thead", top),
        tag("tbody", *body),
        class_="cards" if cards else None,
    )
    return scrolling(caption, whole)


def tightest(
    about: str,
    head: Sequence[str],
    rows: Sequence[Sequence[Any]],
    failing: int,
    *,
    numbers: str,
) -> Html:
    """Return a table of conditions: the five first and all that fail; the rest is folded away.

    Args:
        about: what the table shows of them, for its caption.
        head: heads of the columns.
        rows: cells of each condition, in the order of their margins.
        failing: number of conditions that do not hold, which come first.
        numbers: see `table`.
    """
    rows_shown = max(5, failing)
    rest, count = len(rows) - rows_shown, len(rows)
    which = (
        f"The {rows_shown} tightest of {count} conditions"
        if rest > 0
        else f"All {count} conditions"
    )
    first = table(f"{which} {about}", head, rows[:rows_shown], numbers=numbers, cards=True)
    if rest <= 0:
        return first
    more = f"{rest} more, none with a smaller margin"
    others = table(more, head, rows[rows_shown:], numbers=numbers, cards=True)
    return join([first, folded(more, others)])


def scrolling(name: str, wide: Html) -> Html:
    """Wrap wide content so that it scrolls sideways on a narrow screen, by keyboard, too.

    `assets/hints.js` shows the sentence above it if the content is cut off.
    """
    hint = tag("p", "Wider than this screen: move it sideways.", class_="hint", hidden=True)
    box = tag("div", wide, class_="scroll", tabindex=0, role="region", aria_label=name)
    return join([hint, box])


def captioned(title: str, caption: str, picture: Html) -> Html:
    """Return a picture with its title, and its caption below."""
    words = tag("figcaption", tag("b", f"{title}. "), caption)
    return tag("figure", scrolling(title, picture), words)


def folded(summary: str, *parts: Any) -> Html:
    """Return parts that are folded behind a line; a click on it opens them."""
    return tag("details", tag("summary", summary), *parts)


def facts(caption: str, rows: Iterable[tuple[Any, Any]]) -> Html:
    """Return a table of names and values; rows whose value is None are left out."""
    body = [
        tag("tr", tag("th", name, scope="row"), tag("td", value))
        for name, value in rows
        if value is not None
    ]
    whole = tag("table", tag("caption", caption), tag("tbody", *body), class_="facts")
    return scrolling(caption, whole)


def shell(lines: Iterable[str]) -> Html:
    """Return a block of commands to copy."""
    return tag("pre", tag("code", "\n".join(lines)), tabindex=0)


def number(value: Any, digits: int = 3) -> str:
    """Format a number for a reader; a dash if there is none."""
    if value is None:
        return "–"
    if isinstance(value, bool) or not isinstance(value, int | float):
        return str(value)
    if isinstance(value, int):
        return f"{value:,}".replace(",", "\u202f")
    if not math.isfinite(value):
        return str(value)
    return _signed(f"{value:.{digits}g}") if value else "0"


def bound(value: float | None, *, above: bool = False, digits: int = 3) -> str:
    """Format a proved bound for a reader, rounded to the side on which it stays true.

    Args:
        value: the bound; None gives a dash.
        above: whether it is an upper bound; otherwise it is a lower one.
        digits: number of significant digits.
    """
    if value is None:
        return "–"
    return _signed((at_most if above else at_least)(value, digits))


def _signed(written: str) -> str:
    return written.replace("-", "\u2212")
