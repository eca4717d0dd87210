"""HTML from data: every text is escaped where it becomes HTML, and nowhere else.

`Html` marks what is escaped already. A plain `str` is text and never taken for markup.
"""

import html
import math
from collections.abc import Iterable, Sequence
from typing import Any

from neuralgaits._digits import at_least, at_most


class Html(str):
    """Markup, safe to put into the page."""

    __slots__ = ()


def text(value: Any) -> Html:
    """Markup as it is, anything else escaped."""
    return value if isinstance(value, Html) else Html(html.escape(str(value)))


def join(parts: Iterable[Any]) -> Html:
    """Parts one after another, each escaped unless it is markup."""
    return Html("".join(text(part) for part in parts))


def tag(name: str, *parts: Any, **attributes: Any) -> Html:
    """An element; `class_` is the attribute class, True an attribute without value."""
    written = "".join(
        f" {key.rstrip('_').replace('_', '-')}"
        + ("" if value is True else f'="{html.escape(str(value))}"')
        for key, value in attributes.items()
        if value is not None and value is not False
    )
    return Html(f"<{name}{written}>{join(parts)}</{name}>")


def paragraph(*parts: Any, class_: str | None = None) -> Html:
    """A paragraph."""
    return tag("p", *parts, class_=class_)


def items(entries: Iterable[Any]) -> Html:
    """A list with a dot before each entry; nothing if there are none."""
    rows = [tag("li", entry) for entry in entries]
    return tag("ul", *rows) if rows else Html("")


def section(name: str, title: str, *parts: Any) -> Html:
    """A part of the page that the list of contents names."""
    return tag("section", tag("h2", title, id=name), *parts)


def table(
    caption: str,
    head: Sequence[str],
    rows: Iterable[Sequence[Any]],
    *,
    numbers: str = "",
    cards: bool = False,
) -> Html:
    """A table; see `scrolling`.

    Args:
        caption: what it shows.
        head: of the columns.
        rows: of cells.
        numbers: one letter a column, `n` for numbers, which are set to the right.
        cards: on a narrow screen each row is a card, its cells below one another with their heads.
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


def scrolling(name: str, wide: Html) -> Html:
    """Something that may be wider than a narrow screen: it scrolls sideways, by keys too.

    `assets/hints.js` shows the sentence above it where something is cut.
    """
    hint = tag("p", "Wider than this screen: move it sideways.", class_="hint", hidden=True)
    box = tag("div", wide, class_="scroll", tabindex=0, role="region", aria_label=name)
    return join([hint, box])


def captioned(title: str, caption: str, picture: Html) -> Html:
    """A picture with its title and what is to be seen below it."""
    words = tag("figcaption", tag("b", f"{title}. "), caption)
    return tag("figure", scrolling(title, picture), words)


def folded(said: str, *parts: Any) -> Html:
    """Parts behind a line that opens them."""
    return tag("details", tag("summary", said), *parts)


def facts(caption: str, rows: Iterable[tuple[Any, Any]]) -> Html:
    """Names and values."""
    body = [
        tag("tr", tag("th", name, scope="row"), tag("td", value))
        for name, value in rows
        if value is not None
    ]
    return scrolling(caption, tag("table", tag("caption", caption), tag("tbody", *body)))


def shell(lines: Iterable[str]) -> Html:
    """Commands to copy."""
    return tag("pre", tag("code", "\n".join(lines)), tabindex=0)


def number(value: Any, digits: int = 3) -> str:
    """A number as a person writes it; a dash if there is none."""
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
    """A proved bound as a person writes it, rounded to the side on which it stays true.

    Args:
        value: a lower bound; a dash if it is None.
        above: it is an upper bound.
        digits: significant ones.
    """
    if value is None:
        return "–"
    return _signed((at_most if above else at_least)(value, digits))


def _signed(written: str) -> str:
    return written.replace("-", "\u2212")
