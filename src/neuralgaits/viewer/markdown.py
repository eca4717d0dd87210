"""Text of a run inside Markdown: always text, never markup. Browsers render HTML in Markdown."""

import re


def text(words: str) -> str:
    """Escape every mark of Markdown in a text."""
    return re.sub(r"([\\`*_{}\[\]()<>#|~!&])", r"\\\1", _one_line(words))


def code(words: str) -> str:
    """Return words as inline code; a backtick would end it, so it becomes an apostrophe."""
    return f"`{_one_line(words).replace('`', chr(39))}`"


def _one_line(words: str) -> str:
    # A line of its own could begin a heading, a list or a block of HTML.
    return " ".join(str(words).split())
