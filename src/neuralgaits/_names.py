"""Rules for names: no two look alike, and none moves a cursor.

A slash marks the premises of a theorem, as in set/inertia; a condition or region has none.
"""

import difflib
from collections.abc import Iterable

LONGEST_NAME = 200
"""Largest number of characters; paths of robot files are names, too."""


def why_no_name(name: object) -> str | None:
    """Return why a text cannot name a condition or a region, or None if it can."""
    if not isinstance(name, str):
        return f"{name!r}, which is no text"
    if not name or name != name.strip():
        return f"{name!r}, which is empty or begins or ends with a space"
    if len(name) > LONGEST_NAME or "  " in name:
        return f"{name[:60]!r}, which is too long or has blanks in a row"
    if not name.isprintable():
        return f"{name!r}, which has characters that cannot be printed"
    if "," in name:
        return f"{name!r}, which has a comma: names stand in lists"
    if "/" in name:
        return f"{name!r}, which has a slash: names with one are premises of the theorems"
    return None


def meant(name: object, names: Iterable[str]) -> str:
    """Return a question that asks for the name most like an unknown one; empty if none is."""
    # Of the dashes of options nothing follows.
    bare = {one.lstrip("-"): one for one in names}
    close = [bare[one] for one in difflib.get_close_matches(str(name).lstrip("-"), bare, 1)]
    return f"did you mean {close[0]}?" if close else ""
