"""Theorems of levels 2 and 3 with other parameters than those that were proved."""

from typing import Any

from support.forgeries.base import (
    LOOSE,
    NO,
    REJECTED,
    UNREADABLE,
    Answer,
    Case,
    Theme,
    refused,
    true,
)
from support.forgeries.edits import constant, first, more_constants, number, parameters, without

THEME = Theme("walk")
NO_BARRIER = r"(?im)^(?=.*\bno\b).*barrier"
"""That nothing is said of safety is said."""
FALLS = refused("rejected unreadable")
"""Seen at once, without a box."""


def _changed(
    what: str,
    level: int,
    change: dict[str, Any],
    *,
    cpp: Answer = FALLS,
    alone: Answer = FALLS,
    run: Answer = FALLS,
) -> None:
    """Parameters of a level in the file alone."""

    @THEME.forgery(what, cpp=cpp, alone=alone, run=run)
    def _(case: Case) -> None:
        found = parameters(case.table, level)
        for name, value in change.items():
            found[name] = value(found) if callable(value) else value


def _hex(value: float) -> str:
    return value.hex()


SAFE = true(NO_BARRIER)
_changed("barriers emptied", 2, {"barriers": []}, cpp=SAFE, alone=SAFE)
_changed("a barrier dropped", 2, {"barriers": ["torso-upper"]}, cpp=true(), alone=LOOSE)
_changed("a barrier that is none", 2, {"barriers": lambda p: [*p["barriers"], "knee"]}, alone=NO)
_changed("a barrier twice", 2, {"barriers": lambda p: 2 * p["barriers"]}, alone=LOOSE)
_changed("carried emptied", 2, {"carried": []}, cpp=true(), alone=LOOSE, run=LOOSE)
_changed("carried enlarged", 2, {"carried": lambda p: [*p["carried"], "tube-width"]})
_changed("carried a premise", 2, {"carried": lambda p: [*p["carried"], "set/inertia"]})
_changed("a disturbance, in the parameters only", 2, {"disturbance": [_hex(0.05), _hex(5.0)]})
_changed("a negative disturbance", 2, {"disturbance": [_hex(-0.05), _hex(-5.0)]})
_changed("a disturbance of three numbers", 2, {"disturbance": [_hex(0.0)] * 3})
for _value in (0.0, 0.05, -1e-8, 5e-324, 1e300):
    _changed(f"start_strip {_value:g}", 2, {"start_strip": _hex(_value)})
    _changed(f"guard_strip {_value:g}", 2, {"guard_strip": _hex(_value)})
for _name in ("start_strip", "guard_strip", "risen", "falling"):
    _changed(f"{_name} not a number", 2, {_name: "nan"}, cpp=UNREADABLE, alone=UNREADABLE)
_changed(
    "risen and falling exchanged",
    2,
    {"risen": lambda p: p["falling"], "falling": lambda _: _hex(0.1375)},
)
_changed("a floor that the foot does not clear", 2, {"floor": _hex(0.005)})
_changed("a floor of negative height", 2, {"floor": _hex(-0.005)})
_changed("a floor without end", 2, {"floor": "inf"}, cpp=UNREADABLE, alone=UNREADABLE)
_changed("risen at the start", 2, {"risen": _hex(0.0)})
_changed("falling behind the guard", 2, {"falling": _hex(1.01)})
_changed(
    "guard_from by one last place", 3, {"guard_from": lambda p: number(p["guard_from"], ulps=1)}
)
_changed("guard_to by one last place", 3, {"guard_to": lambda p: number(p["guard_to"], ulps=-1)})
_changed("guard_from behind guard_to", 3, {"guard_from": lambda p: number(p["guard_to"], ulps=1)})
_changed("the expansion's series zeroed", 3, {"expansion": lambda p: [_hex(0.0)] * 13})
_changed("the expansion's series empty", 3, {"expansion": []})
_changed("every series of the orbit empty", 3, {"expansion": [], "slowest": [], "fastest": []})
_changed("fences of the thin tube empty", 3, {"lower": [], "upper": []})
_changed("a coefficient of a series more", 3, {"expansion": lambda p: [*p["expansion"], _hex(0.0)]})
_changed(
    "a coefficient by one last place",
    3,
    {"slowest": lambda p: [number(p["slowest"][0], ulps=1), *p["slowest"][1:]]},
)
_changed(
    "a coefficient that is no number",
    3,
    {"fastest": ["nan"] * 13},
    cpp=UNREADABLE,
    alone=UNREADABLE,
)
_changed("thin tube inverted", 3, {"lower": lambda p: p["upper"], "upper": lambda p: p["lower"]})
_changed("attraction by nested tubes", 3, {"attraction": "nested tubes"})
_changed("attraction by nothing", 3, {"attraction": "hope"}, cpp=UNREADABLE, alone=UNREADABLE)
_changed("a parameter that is not known", 3, {"trust": "me"}, cpp=UNREADABLE, alone=UNREADABLE)
_changed("a parameter in decimals", 2, {"risen": 0.1375}, cpp=UNREADABLE, alone=UNREADABLE)


@THEME.forgery("barriers and what is carried emptied", cpp=SAFE, alone=SAFE)
def _(case: Case) -> None:
    parameters(case.table, 2).update(barriers=[], carried=[])


@THEME.forgery("barriers emptied, and every premise about them left out", cpp=SAFE, alone=SAFE)
def _(case: Case) -> None:
    table = case.table
    parameters(table, 2)["barriers"] = []
    names = {name for s in table["statements"] for name in s["conditions"]}
    without(table, [n for n in names if n.startswith(("set/after ", "set/value "))])


@THEME.forgery("a disturbance, in the Program's constants too", alone=NO)
def _(case: Case) -> None:
    parameters(case.table, 2)["disturbance"] = [_hex(0.05), _hex(5.0)]
    more_constants(case.table, {"walking.disturbance": [0.05, 5.0]})


@THEME.forgery("a negative disturbance, in the Program's constants too", cpp=UNREADABLE, alone=NO)
def _(case: Case) -> None:
    parameters(case.table, 2)["disturbance"] = [_hex(-0.05), _hex(-5.0)]
    more_constants(case.table, {"walking.disturbance": [-0.05, -5.0]})


@THEME.forgery("the expansion's series zeroed, in the Program too", cpp=REJECTED, bounded=True)
def _(case: Case) -> None:
    first(case.table, "orbit/expansion")
    constant(case.table, "orbit.expansion", lambda series: 0.0 * series)
    parameters(case.table, 3)["expansion"] = [_hex(0.0)] * 13


@THEME.forgery("thin tube inverted, in the Program too")
def _(case: Case) -> None:
    found = parameters(case.table, 3)
    found["lower"], found["upper"] = found["upper"], found["lower"]
    for side in ("lower", "upper"):
        values = [float.fromhex(x) for x in found[side]]
        constant(case.table, f"orbit.{side}", lambda _, v=values: v)


@THEME.forgery("thin tube of no width, in the Program too")
def _(case: Case) -> None:
    found = parameters(case.table, 3)
    found["upper"] = found["lower"]
    values = [float.fromhex(x) for x in found["lower"]]
    constant(case.table, "orbit.upper", lambda _: values)


@THEME.forgery("a level that is claimed without one of its premises", cpp=REJECTED, alone=REJECTED)
def _(case: Case) -> None:
    without(case.table, ["orbit/gain"])


@THEME.forgery("level 2 claimed without one of its premises", cpp=REJECTED, alone=REJECTED)
def _(case: Case) -> None:
    without(case.table, ["set/foot-below"])


@THEME.forgery("level 3 claimed on a level 2 that is not", cpp=REJECTED, alone=REJECTED)
def _(case: Case) -> None:
    case.table["theorems"][0]["claimed"] = False
    without(case.table, ["set/foot-below"])


@THEME.forgery("level 2 not claimed, level 3 claimed", cpp=true(), alone=LOOSE, run=LOOSE)
def _(case: Case) -> None:
    case.table["theorems"][0]["claimed"] = False


@THEME.forgery("no level claimed", cpp=true(), alone=LOOSE, run=LOOSE)
def _(case: Case) -> None:
    for theorem in case.table["theorems"]:
        theorem["claimed"] = False


def _levels(what: str, levels: list[object]) -> None:
    @THEME.forgery(f"theorems of {what}", cpp=NO, alone=UNREADABLE)
    def _(case: Case) -> None:
        second, third = case.table["theorems"]
        chosen = {2: second, 3: third}
        case.table["theorems"] = [
            (chosen.get(n, third) if isinstance(n, int) else third) | {"level": n} for n in levels
        ]


_levels("level 3 alone", [3])
_levels("levels 3 and 2", [3, 2])
_levels("level 2 twice", [2, 2])
_levels("levels 2 and 4", [2, 4])
_levels("levels 2, 3 and 4", [2, 3, 4])
_levels("levels 2 and 30", [2, 30])
_levels("levels 2 and -3", [2, -3])
_levels("levels 2 and 3.0", [2, 3.0])
_levels("levels 2 and 'three'", [2, "3"])
_levels("levels 2 and true", [2, True])


@THEME.forgery("no theorems, premises as conditions", alone=NO)
def _(case: Case) -> None:
    case.table["theorems"] = []


@THEME.forgery("claimed by a word", cpp=UNREADABLE, alone=UNREADABLE)
def _(case: Case) -> None:
    case.table["theorems"][1]["claimed"] = "yes"
