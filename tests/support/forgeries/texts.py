"""Files that say two things at once, or more than the format knows."""

import json
from collections.abc import Callable
from typing import Any

from support.forgeries.base import LOOSE, UNREADABLE, Case, Content, Table, Theme, refused

THEME = Theme("small")
NO_TEXT = refused("unreadable rejected")
"""A byte in the Program changes its hash, which is seen first."""


def _text(
    what: str, change: Callable[[str], str | bytes], alone=UNREADABLE, cpp=UNREADABLE
) -> None:
    @THEME.forgery(what, cpp=cpp, alone=alone)
    def _(case: Case) -> Content:
        return change(json.dumps(case.table))


def _table(what: str, change: Callable[[Table], Any], cpp=UNREADABLE, alone=UNREADABLE) -> None:
    @THEME.forgery(what, cpp=cpp, alone=alone)
    def _(case: Case) -> None:
        """To a checker that reads no model, a note in it is none."""
        change(case.table)


def _behind(text: str, field: str, value: str) -> str:
    return f'{text[:-1]}, "{field}": {value}}}'


_table("a note beside the fields", lambda t: t.update(note="trust me"))
_table("a note in a statement", lambda t: t["statements"][0].update(note="trust me"))
_table("a note in a root box", lambda t: t["statements"][0]["root"].update(note="x"))
_table(
    "a note in the Program",
    lambda t: t["program"].update(note="x"),
    alone=refused("unreadable rejected"),
)
_table("a note in the model", lambda t: t["model"].update(note="x"), alone=LOOSE)
_table(
    "a bound of a condition that is not claimed",
    lambda t: t["statements"][0]["bounds"].update(other=0.0),
)
_table("no hash of the Program", lambda t: t.pop("program_hash"))
_table("a format of the future", lambda t: t.update(format=4))
_table("a format in a text", lambda t: t.update(format="3"))
_table("a format that is true", lambda t: t.update(format=True))
_table("another kind of file", lambda t: t.update(kind="neuralgaits wish"))
_table("another chart", lambda t: t.update(chart="u = (level, phase)"))
_table("no statements", lambda t: t.update(statements=[]))
_table("a statement of nothing", lambda t: t["statements"][0].update(conditions=[]))
_table("statements in an object", lambda t: t.update(statements={"0": t["statements"][0]}))
_text("a field twice", lambda s: _behind(s, "theorems", "[]"))
_text("a field twice, once with an escape", lambda s: _behind(s, "\\u0074heorems", "[]"))
_text("a bound twice", lambda s: s.replace('"bounds": {', '"bounds": {"tall": 0.0, ', 1))
_text("the statements twice, the true ones first", lambda s: _behind(s, "statements", "[]"))
_text("a second file behind it", lambda s: s + s)
_text("a word behind it", lambda s: s + " proved")
_text("a null behind it", lambda s: s.encode() + b"\0")
_text("a comment in front", lambda s: "// proved\n" + s)
_text("a byte order mark in front", lambda s: b"\xef\xbb\xbf" + s.encode())
_text("UTF-16", lambda s: s.encode("utf-16"))
_text("a byte that is no UTF-8", lambda s: s.encode().replace(b'"tall"', b'"t\xe1ll"'), cpp=NO_TEXT)
_text("an overlong slash", lambda s: s.encode().replace(b'"tall"', b'"t\xc0\xafll"'), cpp=NO_TEXT)
_text(
    "a surrogate as UTF-8",
    lambda s: s.encode().replace(b'"tall"', b'"t\xed\xa0\x80ll"'),
    cpp=NO_TEXT,
)
_text("nothing", lambda s: "")
_text("half of it", lambda s: s[: len(s) // 2])
_text("an exponent of 20 digits", lambda s: s.replace('"degree": 2', f'"degree": 2e-{"9" * 20}', 1))
_text(
    "a degree of a thousand digits",
    lambda s: s.replace('"degree": 2', f'"degree": {"2" * 1000}', 1),
)
_text(
    "a degree of 100,000 digits",
    lambda s: s.replace('"degree": 2', f'"degree": {"2" * 100_000}', 1),
)
_text("a trailing comma", lambda s: s[:-1] + ",}")
_text("single quotes", lambda s: s.replace('"', "'"))
_text(
    "lists 100,000 deep",
    lambda s: s.replace('"theorems": []', f'"theorems": {"[" * 100_000}{"]" * 100_000}'),
)
_text("objects 100,000 deep", lambda s: '{"a":' * 100_000 + "1" + "}" * 100_000)
_text(
    "a model 100,000 deep",
    lambda s: s.replace('"torso": {', f'"torso": {"[" * 100_000}{"]" * 100_000}, "x": {{', 1),
)
_text(
    "quantities 10,000 deep",
    lambda s: s.replace('"of": {"function": "hip_height"}', _deep(10_000), 1),
    cpp=refused("unreadable undecided rejected"),
    alone=refused("unreadable undecided rejected"),
)


def _deep(count: int) -> str:
    return '"of": {"function": "at_least", "bound": 0.0, ' * count + (
        '"of": {"function": "hip_height"}' + "}" * count
    )
