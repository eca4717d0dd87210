"""Robot files with faults put into them, each with what is to be said of it."""

from collections.abc import Callable, Iterable, Mapping

import pytest

from neuralgaits.errors import RobotError

Fault = tuple[str, str, str]
"""Text of a file, what to put in its place, and what the refusal is to say."""


def refusal_of(read: Callable[[str, str], object], text: str, faults: Iterable[Fault]) -> str:
    """Return what is said of a file with these faults."""
    for old, new, _ in faults:
        assert old in text
        text = text.replace(old, new, 1)
    with pytest.raises(RobotError) as caught:
        read(text, "odd")
    return str(caught.value)


def all_said(read: Callable[[str, str], object], text: str, faults: Mapping[str, Fault]) -> bool:
    """Return whether all faults of a file are said at once."""
    words = refusal_of(read, text, faults.values())
    return all(said in words for _, _, said in faults.values())
