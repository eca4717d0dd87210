"""Trees, bounds, scales and degrees. A tree is a hint: another one makes no statement false."""

import json

from support.forgeries.base import (
    LOOSE,
    NO,
    REJECTED,
    UNREADABLE,
    UNTRUE,
    Case,
    Content,
    Table,
    Theme,
    true,
)
from support.forgeries.edits import first, number, statement_of

THEME = Theme("small")
MARK = "@@"
"""Stands for what the JSON writer would refuse, until the text is written."""


def _wide(statement: Table) -> int:
    """The last axis along which its root box can be halved."""
    low, high = statement["root"]["low"], statement["root"]["high"]
    return max(k for k, (a, b) in enumerate(zip(low, high, strict=True)) if a != b)


@THEME.forgery(
    "trees of two statements exchanged", cpp=true(), alone=LOOSE, run=LOOSE, bounded=True
)
def _(case: Case) -> None:
    one, two = case.table["statements"][:2]
    one["tree"], two["tree"] = two["tree"], one["tree"]


@THEME.forgery("every tree is one leaf", cpp=true(), alone=LOOSE, run=LOOSE, bounded=True)
def _(case: Case) -> None:
    for statement in case.table["statements"]:
        statement["tree"] = "-"


@THEME.forgery("every leaf split once more", cpp=true(), alone=LOOSE, run=LOOSE, bounded=True)
def _(case: Case) -> None:
    for statement in case.table["statements"]:
        statement["tree"] = statement["tree"].replace("-", f"{_wide(statement)}--")


@THEME.forgery("a box's tree for a curve", cpp=REJECTED, alone=REJECTED, about="walk")
def _(case: Case) -> None:
    """The curve has no width along one of the axes that the box is split along."""
    curve, box = (statement_of(case.table, name) for name in ("set/width", "set/inertia"))
    curve["tree"] = box["tree"]


@THEME.forgery("a tree without end", cpp=REJECTED, alone=REJECTED, run=UNTRUE)
def _(case: Case) -> None:
    case.table["statements"][0]["tree"] = "0" * 1000


@THEME.forgery("a tree of five million leaves where a curve has none", cpp=REJECTED, alone=REJECTED)
def _(case: Case) -> None:
    statement = case.table["statements"][0]
    statement["root"]["high"] = statement["root"]["low"]
    statement["tree"] = "0" * 2_500_000 + "-" * 2_500_001


@THEME.forgery("a bound raised beyond what holds", cpp=REJECTED, alone=REJECTED, bounded=True)
def _(case: Case) -> None:
    statement_of(case.table, "tall")["bounds"]["tall"] = 1.0


@THEME.forgery("a premise's bound raised beyond what holds", about="walk", bounded=True)
def _(case: Case) -> None:
    first(case.table, "set/inertia")["bounds"]["set/inertia"] *= 10.0


@THEME.forgery("the bound of a constant better than it is", about="walk", bounded=True)
def _(case: Case) -> None:
    first(case.table, "orbit/gain")["bounds"]["orbit/gain"] = -0.1


@THEME.forgery("a negative bound of a condition", cpp=UNREADABLE, alone=UNREADABLE)
def _(case: Case) -> None:
    statement_of(case.table, "tall")["bounds"]["tall"] = -1e-300


@THEME.forgery("a negative bound of a premise", about="walk", cpp=REJECTED, alone=REJECTED)
def _(case: Case) -> None:
    statement_of(case.table, "set/inertia")["bounds"]["set/inertia"] = -1.0


@THEME.forgery("a bound of minus zero for a premise", about="walk", cpp=REJECTED, alone=REJECTED)
def _(case: Case) -> None:
    statement_of(case.table, "set/inertia")["bounds"]["set/inertia"] = -0.0


@THEME.forgery("the smallest bound there is for a premise", about="walk", cpp=NO, alone=NO)
def _(case: Case) -> None:
    """Its scale makes it zero."""
    statement = statement_of(case.table, "set/inertia")
    statement["bounds"]["set/inertia"] = 5e-324
    statement["scales"]["set/inertia"] = 0.5


def _premise_scale(scale: float) -> None:
    @THEME.forgery(f"a premise in the scale {scale:g}", about="walk", cpp=REJECTED, alone=LOOSE)
    def _(case: Case) -> None:
        statement_of(case.table, "set/inertia")["scales"]["set/inertia"] = scale


def _scale(scale: float) -> None:
    @THEME.forgery(f"a condition in the scale {scale:g}", cpp=UNTRUE, alone=LOOSE, run=UNTRUE)
    def _(case: Case) -> None:
        statement = statement_of(case.table, "tall")
        statement["scales"]["tall"], statement["bounds"]["tall"] = scale, 0.0

    @THEME.forgery(
        f"a condition in the scale {scale:g}, in the model as well",
        cpp=true(r">= -?0 m\b"),
        alone=LOOSE,
        run=UNTRUE,
    )
    def _(case: Case) -> None:
        statement = statement_of(case.table, "tall")
        statement["scales"]["tall"], statement["bounds"]["tall"] = scale, 0.0
        case.table["model"]["conditions"]["tall"]["scale"] = scale


for _value in (1.0, 0.25, 5e-324, 1e308):
    _scale(_value)
for _value in (0.5, 1e-300, 1e300):
    _premise_scale(_value)


@THEME.forgery(
    "a bound that a scale makes infinite", cpp=UNTRUE, alone=UNTRUE, run=UNTRUE, bounded=True
)
def _(case: Case) -> None:
    statement = statement_of(case.table, "tall")
    statement["scales"]["tall"], statement["bounds"]["tall"] = 1e308, 1e308
    case.table["model"]["conditions"]["tall"]["scale"] = 1e308


def _no_number(text: str, part: str) -> None:
    @THEME.forgery(f"{part} of {text}", cpp=UNREADABLE, alone=UNREADABLE)
    def _(case: Case) -> Content:
        statement_of(case.table, "tall")[part]["tall"] = MARK
        return json.dumps(case.table).replace(f'"{MARK}"', text)


for _text in ("NaN", "Infinity", "-Infinity", "1e999", "1e99999999999999999999", "true", '"0x1p0"'):
    for _part in ("bounds", "scales"):
        _no_number(_text, _part)


@THEME.forgery("a digit as long as the file", cpp=LOOSE, alone=LOOSE, run=LOOSE)
def _(case: Case) -> Content:
    """A bound of next to nothing."""
    statement_of(case.table, "tall")["bounds"]["tall"] = MARK
    return json.dumps(case.table).replace(f'"{MARK}"', "0." + "0" * 100_000 + "1")


def _degree(degree: object) -> None:
    @THEME.forgery(f"the degree {degree!r}", cpp=UNREADABLE, alone=UNREADABLE)
    def _(case: Case) -> None:
        case.table["statements"][0]["degree"] = degree


for _number in (0, 3, -2, True, 2.0, None):
    _degree(_number)


@THEME.forgery("the other degree", cpp=true(), alone=LOOSE, run=LOOSE, bounded=True)
def _(case: Case) -> None:
    for statement in case.table["statements"]:
        statement["degree"] = 3 - statement["degree"]


def _corner(text: str) -> None:
    number = text in ("1.0", "0x10p-4", " 0x1p0", "0X1P0")
    same = LOOSE if number else UNREADABLE

    @THEME.forgery(f"a corner at {text!r}", cpp=UNREADABLE, alone=same, run=same)
    def _(case: Case) -> None:
        """Another way to write the number that stands there is not false, or is no number."""
        statement_of(case.table, "tall")["root"]["high"][0] = text


for _text in ("nan", "inf", "1.0", "0x10p-4", "0x1p+99999", " 0x1p0", "0X1P0"):
    _corner(_text)


@THEME.forgery("a corner one last place beyond the chart", cpp=UNREADABLE, alone=UNREADABLE)
def _(case: Case) -> None:
    corner = statement_of(case.table, "tall")["root"]["high"]
    corner[1] = number(corner[1], ulps=1)
