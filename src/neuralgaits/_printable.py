"""Names that are no UTF-8, as text that can be printed and written.

A path is bytes. Python keeps those that its encoding does not know as halves of characters, which
no file and no terminal takes. Everything that is shown of a path goes through `printable` or the
error handler `PRINTABLE`; what opens a file uses the path itself.
"""

import codecs
import os

PRINTABLE = "neuralgaits-printable"
"""Name of the error handler, for `str.encode` and for streams."""


def printable(text: str | os.PathLike[str]) -> str:
    r"""Return a text that UTF-8 can hold: a byte that is none of it becomes \xff, say.

    Under a locale that knows ASCII only, a name in UTF-8 is read as it is meant.
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


def _escaped(error: UnicodeError) -> tuple[bytes, int]:
    """Handle what an encoding does not know: printable text, escaped where that is not known."""
    if not isinstance(error, UnicodeEncodeError):
        raise error
    text = printable(error.object[error.start : error.end])
    # Bytes: the encoder of UTF-8 takes no other text than ASCII in their place.
    return text.encode(error.encoding, "backslashreplace"), error.end


codecs.register_error(PRINTABLE, _escaped)
