"""Fields of a YAML tree: each must be known, there, and of its kind; all problems are noted."""

import difflib
import math
import re
from collections.abc import Callable, Mapping
from typing import Any

from neuralgaits._printable import shown
from neuralgaits.deployment.yaml_tree import YamlNode

MOST_INDEX = 255
"""Largest index of a motor or channel: more than a bus of drives has."""
LEAST = 1e-6
"""Least of the numbers above 0: with a smaller gear, single precision overflows."""


def _number(text: str) -> float:
    value = float(text)
    largest = 1e9  # C computes in single precision, too.
    if not math.isfinite(value) or abs(value) > largest or "_" in text:
        raise ValueError
    return value


def _bounded(holds: Callable[[float], bool]) -> Callable[[str], float]:
    def read(text: str) -> float:
        value = _number(text)
        if not holds(value):
            raise ValueError
        return value

    return read


def _whole_number(low: int, high: int) -> Callable[[str], int]:
    def read(text: str) -> int:
        if not re.fullmatch(r"[+-]?[0-9]{1,9}", text) or not low <= int(text) <= high:
            raise ValueError
        return int(text)

    return read


def _sign(text: str) -> int:
    if text not in ("1", "+1", "-1"):
        raise ValueError
    return int(text)


def _text(text: str) -> str:
    if not text or len(text) > 1000 or not text.isprintable():
        raise ValueError
    return text


def _sha256(text: str) -> str:
    if not re.fullmatch("[0-9a-f]{64}", text):
        raise ValueError
    return text


KINDS: Mapping[str, tuple[str, Callable[[str], Any]]] = {
    "text": ("a name", _text),
    "index": (f"a whole number from 0 to {MOST_INDEX}", _whole_number(0, MOST_INDEX)),
    "sign": ("1 or -1", _sign),
    "number": ("a number", _number),
    "positive": (
        f"a number from {LEAST:g} to {1.0 / LEAST:g}",
        _bounded(lambda value: LEAST <= value <= 1.0 / LEAST),
    ),
    "not negative": ("a number of at least 0", _bounded(lambda value: value >= 0.0)),
    "sha256": ("a sha256 of 64 hexadecimal digits", _sha256),
}
"""Kinds of scalars: words, and a reader that raises ValueError."""


class FieldReader:
    """Read fields of a file. Attributes: problems: what is wrong so far, one line each."""

    def __init__(self, file: str):
        self.problems: list[str] = []
        self._file = file

    def note(self, line: int, what: str, expected: str, found: str, remedy: str) -> None:
        """Note one problem; all of a file are raised together."""
        self.problems.append(
            f"{self._file}, line {line}: {what}: expected {expected}, found {found}: {remedy}"
        )

    def fields(
        self, node: YamlNode | None, what: str, kinds: Mapping[str, str]
    ) -> dict[str, Any] | None:
        """Return the fields of a mapping that could be read, by name; None if it is none.

        Args:
            node: the mapping; None if it was not there, which has been noted.
            what: name of the mapping, for messages.
            kinds: kinds by key: one of KINDS, `keys`, `keys or null` or `list`.
        """
        if node is None:
            return None
        if not isinstance(node.value, dict):
            self.note(node.line, what, f"the keys {', '.join(kinds)}", node.kind, "write them")
            return None
        unknown = [key for key in node.value if key not in kinds]
        meant_by = [self._unknown(node.value[key].line, what, key, kinds) for key in unknown]
        missing = [key for key in kinds if key not in node.value and key not in meant_by]
        if missing:
            self.note(node.line, what, f"the key {', '.join(missing)}", "none", "add it")
        values: dict[str, Any] = {}
        for key, kind in kinds.items():
            if key in node.value:
                self._read(values, node.value[key], f"{what}: {key}", key, kind)
        return values

    def rows(
        self, nodes: list[YamlNode] | None, what: str, kinds: Mapping[str, str]
    ) -> list[dict[str, Any]]:
        """Return the rows of a list that could be read whole."""
        tables = []
        for number, node in enumerate(nodes or ()):
            row = self.fields(node, f"{what}[{number}]", kinds)
            if row is not None and len(row) == len(kinds):
                tables.append(row)
        return tables

    def _read(self, values: dict[str, Any], node: YamlNode, what: str, key: str, kind: str) -> None:
        if kind in ("keys", "keys or null"):
            if kind == "keys or null" and node.value in ("null", "~", ""):
                values[key] = None
            else:
                values[key] = node
            return
        if kind == "list":
            most = 64  # Longest list.
            if not isinstance(node.value, list) or len(node.value) > most:
                self.note(node.line, what, f"a list of at most {most}", node.kind, "write one")
            else:
                values[key] = node.value
            return
        words, read = KINDS[kind]
        try:
            if not isinstance(node.value, str):
                raise ValueError
            values[key] = read(node.value)
        except ValueError:
            self.note(node.line, what, words, node.kind, "correct it")

    def _unknown(self, line: int, what: str, key: str, kinds: Mapping[str, str]) -> str | None:
        """Note a key that is not known. Returns: the key that was meant, or None.

        One with another unit is told which unit to use.
        """
        stem = key.partition("_")[0]
        same = [one for one in kinds if one.partition("_")[0] == stem and "_" in one]
        if same and same[0] not in key:
            close = same[0]
            remedy = f"write {close}, in that unit" if "_" in key else f"write {close}"
        else:
            close = next(iter(difflib.get_close_matches(key, list(kinds), 1)), None)
            remedy = "delete it" if close is None else f"did you mean {close}?"
        self.note(line, what, f"one of {', '.join(kinds)}", f"the key {shown(key)}", remedy)
        return close
