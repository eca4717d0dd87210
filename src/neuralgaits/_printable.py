"""Names that are not UTF-8, as text that can be printed and written.

A path is bytes. Python keeps those that its encoding does not know as halves of characters, which
no file and no terminal takes. Every path that is shown goes through `printable` or the
error handler `PRINTABLE`; functions that open a file use the path itself.
"""

import codecs
import math
import os
import re
import unicodedata
from numbers import Integral

PRINTABLE = "neuralgaits-printable"
"""Name of the error handler, for `str.encode` and for streams."""
_SHOWN = 60
"""Characters that a message shows of what is longer."""


def printable(text: str | os.PathLike[str]) -> str:
    r"""Return a text that UTF-8 can hold; a byte that is not valid UTF-8 becomes \xff, say.

    Under a locale that knows ASCII only, a name in UTF-8 is still read correctly.
    """
    whole = os.fspath(text)
    try:
        whole.encode()
    except UnicodeEncodeError:
        pass
    else:
        return whole
    try:
        return whole.encode("utf-8", "surrogateescape").decode("utf-8", "backslashreplace")
    except UnicodeEncodeError:  # A half that stands for no byte.
        return whole.encode("utf-8", "backslashreplace").decode()


def visible(text: str) -> str:
    """Return a text without characters that move a cursor or turn the direction of others."""
    return "".join(
        repr(c)[1:-1] if unicodedata.category(c) in ("Cc", "Cf", "Zl", "Zp") else c for c in text
    )


def shortened(text: str) -> str:
    """Return a message without most of each word, or quoted text, that is too long for one.

    A folder's or a file's name in a path counts as one word, so paths that can be there stay whole.
    """
    # No file's name is longer than 255 characters, and no path, which may be quoted, than 4096.
    too_long = r"""(?<!\w)(["'])(?:(?!\1).){4097,}\1|[^\s/"'`]{256,}"""
    return re.sub(too_long, lambda long: f"{long[0][:_SHOWN]}... ({len(long[0])} characters)", text)


def shown(value: object) -> str:
    """Return any value of a caller's for a message, in a few characters.

    Python writes no whole number of more than 4300 digits, and an object's own text may fail.
    """
    if isinstance(value, Integral) and not isinstance(value, bool):
        value = int(value)  # NumPy's text of one says its type, too.
    largest = 10**20  # First whole number that a message gives by its number of digits.
    if isinstance(value, int) and abs(value) >= largest:
        # A logarithm may be rounded up.
        power = math.floor(math.log10(abs(value)))
        return f"a number of {power + (abs(value) >= 10**power)} digits"
    try:
        return f"{value!r:.{_SHOWN}}"
    except Exception:
        return f"an object of type {type(value).__name__:.{_SHOWN}}"


def _escaped(error: UnicodeError) -> tuple[bytes, int]:
    """Replace characters that an encoding lacks by printable text, escaped where necessary."""
    if not isinstance(error, UnicodeEncodeError):
        raise error
    text = printable(error.object[error.start : error.end])
    # Bytes: the encoder of UTF-8 takes no other text than ASCII in their place.
    return text.encode(error.encoding, "backslashreplace"), error.end


codecs.register_error(PRINTABLE, _escaped)


def counted(count: int, noun: str) -> str:
    """Write a count with its noun, as in `1 step` and `2 steps`."""
    return f"{count} {noun}{'' if count == 1 else 's'}"
