"""Level 4 with other constants, barriers and edges than those that were proved."""

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any

from neuralgaits.programs import Input
from support.forgeries.base import (
    LOOSE,
    NO,
    OPEN,
    REJECTED,
    Answer,
    Case,
    Table,
    Theme,
    refused,
    true,
)
from support.forgeries.edits import (
    constantly,
    constants,
    more_outputs,
    number,
    parameters,
    program_of,
    put,
    rename,
    without,
)

THEME = Theme("full")
FALLS = refused("rejected unreadable")
SET = "bandwidth radius shrink guard_radius inertia mismatch drift gain landing landing_slope"
ORDER = (*SET.split(), "slowest", "fastest")
"""What stands in the Program's constant full.set, in this order."""
OF_BARRIER = ("alpha", "epsilon", "coupling", "reading", "reset", "reset_slope")


def _kind(what: str, *, alone: Answer = FALLS, run: Answer = FALLS) -> Any:
    return THEME.forgery(what, cpp=true(), alone=alone, run=run)


def _in_program(table: Table) -> None:
    """The Program's constants are what the parameters say."""
    found = parameters(table, 4)
    alone = [float.fromhex(found[name]) for name in ORDER[:-2]]
    pace = [float.fromhex(x) for x in found["pace"]]
    rows = [float.fromhex(b[name]) for b in found["barriers"] for name in OF_BARRIER]
    constants(table, {"full.set": lambda _: alone + pace, "full.barriers": lambda _: rows})


def _number(what: str, change: Callable[[Table], None], *, inside: Answer, run: Answer) -> None:
    """A change in the parameters alone, and one that the Program's constants follow."""

    @_kind(f"{what}, in the parameters only")
    def _(case: Case) -> None:
        change(parameters(case.table, 4))

    @_kind(f"{what}, in the Program too", alone=inside, run=run)
    def _(case: Case) -> None:
        change(parameters(case.table, 4))
        _in_program(case.table)


def _times(name: str, factor: float) -> Callable[[Table], None]:
    def change(found: Table) -> None:
        found[name] = number(found[name], factor)

    return change


def _of_barrier(place: int, name: str, factor: float) -> Callable[[Table], None]:
    def change(found: Table) -> None:
        found["barriers"][place][name] = number(found["barriers"][place][name], factor)

    return change


_number("radius doubled", _times("radius", 2.0), inside=LOOSE, run=LOOSE)
_number("guard_radius a tenth", _times("guard_radius", 0.1), inside=FALLS, run=FALLS)
_number("gain negative", _times("gain", -1.0), inside=LOOSE, run=LOOSE)
_number("gain a tenth", _times("gain", 0.1), inside=LOOSE, run=LOOSE)
_number("mismatch negative", _times("mismatch", -1.0), inside=LOOSE, run=LOOSE)
_number("inertia negative", _times("inertia", -1.0), inside=FALLS, run=FALLS)
_number("shrink negative", _times("shrink", -1.0), inside=FALLS, run=FALLS)
_number("bandwidth negative", _times("bandwidth", -1.0), inside=FALLS, run=FALLS)
_number("bandwidth of nothing", _times("bandwidth", 0.0), inside=FALLS, run=FALLS)
_number("alpha negative", _of_barrier(2, "alpha", -1.0), inside=FALLS, run=FALLS)
_number("alpha ten times", _of_barrier(2, "alpha", 10.0), inside=FALLS, run=FALLS)
_number("epsilon a tenth", _of_barrier(0, "epsilon", 0.1), inside=FALLS, run=FALLS)
_number("epsilon ten times", _of_barrier(0, "epsilon", 10.0), inside=LOOSE, run=LOOSE)
_number("coupling a tenth", _of_barrier(0, "coupling", 0.1), inside=LOOSE, run=LOOSE)
_number("reset ten times", _of_barrier(0, "reset", 10.0), inside=LOOSE, run=LOOSE)


def _edge(name: str, factor: float = 1.0, ulps: int = 0) -> None:
    what = f"{ulps:+d} last place" if ulps else f"times {factor:g}"

    @_kind(f"{name} {what}")
    def _(case: Case) -> None:
        found = parameters(case.table, 4)
        found[name] = number(found[name], factor, ulps)


for _name in ("start_strip", "risen"):
    _edge(_name, ulps=1)
    _edge(_name, ulps=-1)
for _factor in (0.0, -1.0, 1e9):
    for _name in ("guard_strip", "start_strip", "risen", "crossing"):
        _edge(_name, _factor)


def _hidden(name: str, change: Callable[[float], float]) -> None:
    @_kind(f"{name} by less than a last place of 1 less it", alone=LOOSE, run=LOOSE)
    def _(case: Case) -> None:
        """Premises are on boxes that end at the rounded phase, which stay what they were."""
        found = parameters(case.table, 4)
        value = float.fromhex(found[name])
        found[name] = change(value).hex()
        assert 1.0 - change(value) == 1.0 - value != 1.0 - 2.0 * value


_hidden("guard_strip", lambda x: math.nextafter(x, 0.0))
_hidden("crossing", lambda x: math.nextafter(x, 0.0))


@_kind("crossing by more than a last place of 1 less it")
def _(case: Case) -> None:
    found = parameters(case.table, 4)
    found["crossing"] = (float.fromhex(found["crossing"]) + 2.0**-52).hex()


def _sigma(what: str, value: Callable[[str], str], answer: Answer = FALLS) -> None:
    """It stands in no premise, and so in no constant of the Program."""

    @_kind(f"sigma {what}", alone=answer, run=answer)
    def _(case: Case) -> None:
        barrier = parameters(case.table, 4)["barriers"][2]
        barrier["sigma"] = value(barrier["sigma"])


_sigma("a tenth", lambda text: number(text, 0.1))
_sigma("a thousand times", lambda text: number(text, 1e3))
_sigma("negative", lambda text: number(text, -1.0))
_sigma("zero", lambda text: "0x0.0p+0")
_sigma("not a number", lambda text: "nan")
_sigma("a last place more", lambda text: number(text, ulps=1), LOOSE)


def _barriers(what: str, change: Callable[[list[Table]], list[Table]], inside: Answer) -> None:
    @_kind(f"barriers {what}, in the parameters only", alone=LOOSE)
    def _(case: Case) -> None:
        found = parameters(case.table, 4)
        found["barriers"] = change(found["barriers"])

    @_kind(f"barriers {what}, in the Program too", alone=inside)
    def _(case: Case) -> None:
        found = parameters(case.table, 4)
        before = len(found["barriers"])
        found["barriers"] = change(found["barriers"])
        if len(found["barriers"]) != before:
            constantly(case.table)  # What was traced needs as many as there were.
        _in_program(case.table)


def _named(barriers: list[Table], order: list[int]) -> list[Table]:
    """The same numbers under names in another order."""
    names = [b["name"] for b in barriers]
    return [b | {"name": names[k]} for b, k in zip(barriers, order, strict=True)]


_barriers("in another order", lambda b: [*b[:2], b[3], b[2]], LOOSE)
_barriers("under each other's name", lambda b: _named(b, [0, 1, 3, 2]), LOOSE)
_barriers("and fences under each other's name", lambda b: _named(b, [1, 0, 2, 3]), FALLS)
_barriers("less the last", lambda b: b[:3], LOOSE)
_barriers("less a fence", lambda b: b[1:], FALLS)
_barriers("with one twice", lambda b: [*b, b[3]], FALLS)
_barriers("that are fences alone", lambda b: b[:2], LOOSE)
_barriers("with one renamed", lambda b: [*b[:3], b[3] | {"name": "upright"}], FALLS)


@_kind("a barrier renamed, in outputs and statements too", alone=LOOSE)
def _(case: Case) -> None:
    table, old, new = case.table, "torso-upper", "safe"
    parameters(table, 4)["barriers"][3]["name"] = new
    for name in [row[0] for row in table["program"]["outputs"]]:
        if name.startswith("full/") and name.endswith(old):
            rename(table, name, name.replace(old, new))


@_kind("a premise left out")
def _(case: Case) -> None:
    statements = case.table["statements"]
    statements.remove(next(s for s in statements if "full/impulse" in s["conditions"]))


@_kind("a premise of which less is proved than nothing")
def _(case: Case) -> None:
    for statement in case.table["statements"]:
        if "full/contact" in statement["bounds"]:
            statement["bounds"]["full/contact"] = -1.0


def _of(table: Table, what: Callable[[str], bool]) -> None:
    """Only the statements about outputs of some kind."""
    table["statements"] = [s for s in table["statements"] if what(s["conditions"][0])]


@_kind("all of its premises left out")
def _(case: Case) -> None:
    _of(case.table, lambda name: not name.startswith("full/"))


@_kind("nothing but its premises, all levels claimed")
def _(case: Case) -> None:
    _of(case.table, lambda name: name.startswith("full/"))


@_kind("nothing but its premises, it alone claimed", alone=OPEN, run=OPEN)
def _(case: Case) -> None:
    """What is said of it is true, and the spec's conditions are not proved."""
    _of(case.table, lambda name: name.startswith("full/"))
    for theorem in case.table["theorems"]:
        theorem["claimed"] = theorem["level"] == 4


@_kind("its premises, and conditions but one", alone=NO, run=NO)
def _(case: Case) -> None:
    without(case.table, ["knee"])


@_kind("premises of level 3 left out")
def _(case: Case) -> None:
    _of(case.table, lambda name: not name.startswith("orbit/"))


@_kind("a premise under the label of level 3", alone=NO, run=NO)
def _(case: Case) -> None:
    for statement in case.table["statements"]:
        if "full/impulse" in statement["conditions"]:
            statement["region"] = "orbit"


@_kind("a premise on the box of level 3's", alone=NO, run=NO)
def _(case: Case) -> None:
    statements = case.table["statements"]
    other = next(s for s in statements if "orbit/fence-lower" in s["conditions"])
    for statement in statements:
        if "full/impulse" in statement["conditions"]:
            statement |= {"root": other["root"], "tree": other["tree"]}


@_kind("a premise that computes what one of level 3 does", alone=LOOSE)
def _(case: Case) -> None:
    more_outputs(case.table, {"full/inertia": "orbit/inside"})


@_kind("a condition that depends on outputs off zero", alone=LOOSE)
def _(case: Case) -> None:
    more_outputs(case.table, {"foot-rises": "full/foot-rises"})


@_kind("the strips of level 2 moved")
def _(case: Case) -> None:
    found = parameters(case.table, 2)
    found["start_strip"] = number(found["start_strip"], 2.0)


@_kind("the thin tube of level 3 wider, in the parameters only")
def _(case: Case) -> None:
    found = parameters(case.table, 3)
    found["upper"] = [number(text, 1.01) for text in found["upper"]]


@_kind("level 3 taken out from between")
def _(case: Case) -> None:
    """Its premises are then those of no theorem."""
    del case.table["theorems"][1]


@_kind("level 4 before the others", alone=refused("unreadable"))
def _(case: Case) -> None:
    case.table["theorems"].reverse()


@_kind("a file of level 4 alone, as earlier versions wrote it", alone=refused("unreadable"))
def _(case: Case) -> None:
    table = case.table
    _of(table, lambda name: name.startswith("full/"))
    del table["theorems"][:2]
    program = program_of(table)
    outputs = tuple(row for row in program.outputs if row.name.startswith("full/"))
    put(table, replace(program, outputs=outputs))


@_kind("the model of another proof beside it", alone=LOOSE)
def _(case: Case) -> None:
    case.table["model"] = case.base.proofs["small"]["model"]


@_kind("its theorem under level 2", alone=refused("unreadable"))
def _(case: Case) -> None:
    case.table["theorems"][2]["level"] = 2


@_kind("its theorem twice", alone=refused("unreadable"))
def _(case: Case) -> None:
    case.table["theorems"] *= 2


@_kind("its Program under the theorem of level 3")
def _(case: Case) -> None:
    """Premises at the full order are no premises of level 3."""
    case.table["theorems"] = case.base.proofs["walk"]["theorems"]
    put(case.table, program_of(case.table))


@THEME.forgery("a chart with an axis of robots", cpp=REJECTED, alone=REJECTED)
def _(case: Case) -> None:
    """Whatever the Program says of it: this one says 1."""
    table = case.table
    constantly(table)
    program, end = program_of(table), (0.01).hex()
    put(table, replace(program, inputs=(Input("u", (3,)), *program.inputs[1:])))
    table["chart"].append({"name": "mass", "low": f"-{end}", "high": end})
    for statement in table["statements"]:
        statement["root"]["low"].append(f"-{end}")
        statement["root"]["high"].append(end)


@_kind("footholds of unknown height at level 2", alone=REJECTED)
def _(case: Case) -> None:
    parameters(case.table, 2)["floor"] = (0.01).hex()
