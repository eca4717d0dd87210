"""Shapes of JSON data: the names and kinds of values that its writer put there.

A file can be whole and still hold something else: an edit by hand, another version, a disc that
gave way. Readers compare their data with a shape first, and need not doubt it later.
"""

from collections.abc import Callable, Mapping
from typing import Any

Shape = Callable[[Any], str | None] | Mapping[str, Any]
"""Check of a value that returns a complaint, in words that follow "found", or None; or the fields
of an object with a shape for each."""


def complaint(value: Any, shape: Shape) -> str | None:
    """Return the first fault of a value, and its place; None if there is none."""
    if callable(shape):
        return shape(value)
    if not isinstance(value, dict):
        return _mismatch("an object", value)
    for name, part in shape.items():
        optional = name.endswith("?")
        key = name.removesuffix("?")
        if key not in value:
            if optional:
                continue
            return f"there is no {key}"
        if wrong := complaint(value[key], part):
            return _located(key, wrong)
    return None


def _located(place: str, wrong: str) -> str:
    return f"in {place}: {wrong}"


def _mismatch(expected: str, value: Any) -> str:
    text = str(value)
    return f"expected {expected}, found {text[:40]!r}"


def kind(expected: str, *types: type) -> Callable[[Any], str | None]:
    """Return the shape of a value of one of these types; True is no number."""

    def check(value: Any) -> str | None:
        fits = isinstance(value, types) and (bool in types or not isinstance(value, bool))
        return None if fits else _mismatch(expected, value)

    return check


NUMBER = kind("a number", int, float)
TEXT = kind("text", str)
FLAG = kind("true or false", bool)


def whole(low: int, high: int) -> Callable[[Any], str | None]:
    """Return the shape of a whole number in a range."""

    def check(value: Any) -> str | None:
        fits = isinstance(value, int) and not isinstance(value, bool) and low <= value <= high
        return None if fits else _mismatch(f"a whole number from {low} to {high}", value)

    return check


def _share(value: Any) -> str | None:
    fits = NUMBER(value) is None and 0.0 <= value <= 1.0
    return None if fits else _mismatch("a number from 0 to 1", value)


SHARE = _share
"""Shape of a part of a whole."""


def _positive(value: Any) -> str | None:
    fits = NUMBER(value) is None and 0.0 < value < float("inf")
    return None if fits else _mismatch("a number above 0", value)


POSITIVE = _positive
"""Shape of a finite number above 0."""
COUNT = whole(0, 2**53)
"""Shape of any count in this program's files."""


def one_of(*words: Any) -> Callable[[Any], str | None]:
    """Return the shape of a value that equals one of these."""

    def check(value: Any) -> str | None:
        fits = any(type(value) is type(word) and value == word for word in words)
        return None if fits else _mismatch(f"one of {', '.join(map(str, words))}", value)

    return check


def may(shape: Shape) -> Callable[[Any], str | None]:
    """Return a shape that also allows null."""
    return lambda value: None if value is None else complaint(value, shape)


def list_of(shape: Shape, *lengths: int) -> Callable[[Any], str | None]:
    """Return the shape of a list of values of a shape, of one of these lengths if any are given."""

    def check(value: Any) -> str | None:
        if not isinstance(value, list) or (lengths and len(value) not in lengths):
            many = " or ".join(map(str, lengths))
            return _mismatch(f"a list of {many}" if lengths else "a list", value)
        for number, item in enumerate(value):
            if wrong := complaint(item, shape):
                return _located(f"entry {number + 1}", wrong)
        return None

    return check


def same_length(shape: Shape, *names: str) -> Callable[[Any], str | None]:
    """Return the shape of an object in which some lists must have the same length."""

    def check(value: Any) -> str | None:
        if wrong := complaint(value, shape):
            return wrong
        counts = [len(value[name]) for name in names]
        different = ", ".join(map(str, counts))
        return None if len(set(counts)) == 1 else f"{', '.join(names)} have {different} entries"

    return check


def table_of(shape: Shape) -> Callable[[Any], str | None]:
    """Return the shape of an object whose values all have a shape, under any names."""

    def check(value: Any) -> str | None:
        if not isinstance(value, dict):
            return _mismatch("an object", value)
        for name, item in value.items():
            if wrong := complaint(item, shape):
                return _located(name[:40], wrong)
        return None

    return check
