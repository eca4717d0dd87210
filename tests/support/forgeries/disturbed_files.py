"""Level 5 with other premises, clocks and laws than those that were proved, and of other runs."""

import copy
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from neuralgaits.programs import Input
from support.forgeries.base import (
    LOOSE,
    NO,
    REJECTED,
    UNREADABLE,
    UNTRUE,
    About,
    Answer,
    Case,
    Content,
    Table,
    Theme,
    refused,
    true,
)
from support.forgeries.disturbed import FALLS, FREE, SCHEDULED, in_program
from support.forgeries.edits import (
    claim,
    constant,
    constantly,
    first,
    more_constants,
    more_outputs,
    number,
    parameters,
    program_of,
    put,
    rename,
    statement_of,
    without,
)

THEME = Theme("lawfree")
PREMISES = (
    *("contact", "torque", "decrease level-lower", "decrease torso-upper", "decay", "rest", "jerk"),
    *("growth-slope", "jerk-push", "kick", "kick-slope", "kick-push", "kick-contact"),
)
KICK = ("kick", "kick_slope", "kick_push", "kick_peak")
KICK_PREMISES = ("kick", "kick-slope", "kick-push", "kick-contact")
LAW_PREMISES = ("decay", "rest")
OTHER_CLOCK: dict[About, About] = {"held": "free", "free": "held", "law": "lawfree", "lawfree": "law"}
OTHER_LAW: dict[About, About] = {"held": "law", "law": "held", "free": "lawfree", "lawfree": "free"}


def _kind(
    what: str,
    *abouts: About,
    cpp: Answer | None = NO,
    alone: Answer = FALLS,
    run: Answer = NO,
    bounded: bool = False,
) -> Callable[[Callable[[Case], Content | None]], None]:
    """Register a change of several of the proofs; a checker in C++ may take minutes for some."""

    def register(change: Callable[[Case], Content | None]) -> None:
        for about in abouts or (THEME.about,):
            answers = {"cpp": cpp, "alone": alone, "run": run}
            THEME.forgery(f"{what} ({about})", about=about, bounded=bounded, **answers)(change)

    return register


def _of(case: Case, name: str) -> Table:
    return statement_of(case.table, f"disturbed/{name}")


def _premise(name: str) -> None:
    @_kind(f"no statement of disturbed/{name}", alone=REJECTED)
    def _(case: Case) -> None:
        without(case.table, [f"disturbed/{name}"])

    @_kind(f"less than nothing proved of disturbed/{name}", alone=FALLS)
    def _(case: Case) -> None:
        _of(case, name)["bounds"][f"disturbed/{name}"] = -1.0

    @_kind(f"disturbed/{name} on half of its box", alone=REJECTED)
    def _(case: Case) -> None:
        corner = _of(case, name)["root"]["high"]
        corner[1] = number(corner[1], 0.5)


for _name in PREMISES:
    _premise(_name)


@_kind("a premise under the label of level 4", alone=REJECTED)
def _(case: Case) -> None:
    _of(case, "decay")["region"] = "full order"


@_kind("a premise in the scale 2", alone=REJECTED)
def _(case: Case) -> None:
    _of(case, "decay")["scales"]["disturbed/decay"] = 2.0


@_kind("the kick on the step alone", "free", alone=REJECTED)
def _(case: Case) -> None:
    _of(case, "kick")["root"]["high"][0] = (1.0).hex()


@_kind("the decay on the step alone", "law", alone=REJECTED)
def _(case: Case) -> None:
    _of(case, "decay")["root"] |= {"low": ["0x0.0p+0", "0x0.0p+0"]}


@_kind("a leaf that is missing", alone=REJECTED)
def _(case: Case) -> None:
    _of(case, "decay")["tree"] = "0-"


@_kind("a premise renamed, in the Program too", alone=FALLS)
def _(case: Case) -> None:
    rename(case.table, "disturbed/kick-slope", "disturbed/kick-slopes")


@_kind("two premises under each other's names", cpp=None, alone=LOOSE)
def _(case: Case) -> None:
    """Each has the value of the other: what bounds the Program cannot know."""
    for old, new in (("jerk", "x"), ("jerk-push", "jerk"), ("x", "jerk-push")):
        rename(case.table, f"disturbed/{old}", f"disturbed/{new}")


def _twin(name: str, old: str) -> None:
    @_kind(f"disturbed/{name} that computes {old}", cpp=None, alone=LOOSE)
    def _(case: Case) -> None:
        more_outputs(case.table, {f"disturbed/{name}": old})


for _name in ("rest", "jerk", "kick", "kick-slope", "kick-push"):
    _twin(_name, "full/inertia")


@_kind("premises of level 5 that say 1", "held", "lawfree", cpp=None, alone=LOOSE)
def _(case: Case) -> None:
    names = [row[0] for row in case.table["program"]["outputs"]]
    constantly(case.table, [name for name in names if name.startswith("disturbed/")])


# ------------------------------------------------------------------------------- the clock


def _kicks(case: Case) -> None:
    """The numbers of a free clock, as they are in its own proof."""
    other = parameters(case.base.proofs[OTHER_CLOCK[case.about]], 5)
    parameters(case.table, 5).update({name: other[name] for name in (*KICK, "kick_end")})


def _kick_constants(case: Case) -> None:
    shape = parameters(case.table, 5)
    more_constants(case.table, {"disturbed.kick": [float.fromhex(shape[n]) for n in KICK]})


@_kind("ticks at touchdowns stated as a free clock", "held", "law")
def _(case: Case) -> None:
    _kicks(case)


@_kind("the same, with the Program's constants", "held")
def _(case: Case) -> None:
    _kicks(case)
    _kick_constants(case)


@_kind("the same, with statements of what the Program lacks", "law", alone=UNREADABLE)
def _(case: Case) -> None:
    _kicks(case)
    _kick_constants(case)
    other = case.base.proofs[OTHER_CLOCK[case.about]]
    for name in KICK_PREMISES:
        case.table["statements"].append(copy.deepcopy(statement_of(other, f"disturbed/{name}")))


@_kind("the same, and outputs that compute something else", "held", cpp=None, alone=NO)
def _(case: Case) -> None:
    """The boxes are another set's, unless the sets end at the same phases."""
    _kicks(case)
    _kick_constants(case)
    shape, full = parameters(case.table, 5), parameters(case.table, 4)
    last = float.fromhex(_of(case, "contact")["root"]["high"][0]).hex()
    for name in KICK_PREMISES:
        low = (1.0 - float.fromhex(full["guard_strip"])).hex()
        box = {"low": [low, "0x0.0p+0"], "high": [last, "0x1.0000000000000p+0"]}
        if name == "kick-contact":
            box["low"][0] = _of(case, "contact")["root"]["low"][0]
            box["high"][0] = shape["kick_end"]
        told = claim(f"disturbed/{name}", box, region="disturbed", bound=1e-9)
        case.table["statements"].append(told)
    more_outputs(case.table, {f"disturbed/{name}": "full/inertia" for name in KICK_PREMISES})


@_kind("a free clock stated as ticks at touchdowns", *FREE)
def _(case: Case) -> None:
    parameters(case.table, 5).pop("kick_end")


@_kind("the same, without the statements of its kick", "free", cpp=None, alone=LOOSE)
def _(case: Case) -> None:
    """What is said then is true, but the Program is not the one of such a theorem."""
    shape = parameters(case.table, 5)
    for name in (*KICK, "kick_end"):
        shape.pop(name)
    without(case.table, [f"disturbed/{name}" for name in KICK_PREMISES])


@_kind("the theorem of the other clock", "held", "lawfree")
def _(case: Case) -> None:
    case.table["theorems"] = copy.deepcopy(case.base.proofs[OTHER_CLOCK[case.about]]["theorems"])


@_kind("level 5 of the other clock", "free", "law")
def _(case: Case) -> None:
    case.table["theorems"][-1] = copy.deepcopy(
        case.base.proofs[OTHER_CLOCK[case.about]]["theorems"][-1]
    )


@_kind("the Program of the other clock", "held", "lawfree")
def _(case: Case) -> None:
    put(case.table, program_of(case.base.proofs[OTHER_CLOCK[case.about]]))


# --------------------------------------------------------------------------------- the law

LAW = ("torque_gains", "inertia_gains", "decay", "rest")


def _law_of_other(case: Case) -> None:
    other = parameters(case.base.proofs[OTHER_LAW[case.about]], 5)
    parameters(case.table, 5).update({name: other[name] for name in LAW})


def _law_constants(case: Case) -> None:
    shape = parameters(case.table, 5)
    values = {n: [float.fromhex(x) for x in shape[n]] for n in LAW[:2]}
    values["law"] = [float.fromhex(shape[n]) for n in LAW[2:]]
    more_constants(case.table, {f"disturbed.{name}": row for name, row in values.items()})


@_kind("fblin stated as scheduled-pd", "held")
def _(case: Case) -> None:
    _law_of_other(case)


@_kind("the same, with its constants in the Program", "free")
def _(case: Case) -> None:
    _law_of_other(case)
    _law_constants(case)


@_kind("fblin stated so, and outputs that compute something else", "held", cpp=None, alone=NO)
def _(case: Case) -> None:
    _law_of_other(case)
    _law_constants(case)
    box = copy.deepcopy(_of(case, "contact")["root"])
    for name in LAW_PREMISES:
        told = claim(f"disturbed/{name}", box, region="disturbed", bound=1e-9)
        case.table["statements"].append(told)
    more_outputs(case.table, {f"disturbed/{name}": "full/inertia" for name in LAW_PREMISES})


@_kind("scheduled-pd stated as fblin", "lawfree")
def _(case: Case) -> None:
    for name in LAW:
        parameters(case.table, 5).pop(name)


@_kind("the same, without the statements of its law", "lawfree", cpp=None, alone=LOOSE)
def _(case: Case) -> None:
    for name in LAW:
        parameters(case.table, 5).pop(name)
    without(case.table, [f"disturbed/{name}" for name in LAW_PREMISES])


@_kind("the theorem of the other law", "held", "lawfree")
def _(case: Case) -> None:
    case.table["theorems"] = copy.deepcopy(case.base.proofs[OTHER_LAW[case.about]]["theorems"])


@_kind("level 5 of the other law", "free", "law")
def _(case: Case) -> None:
    case.table["theorems"][-1] = copy.deepcopy(
        case.base.proofs[OTHER_LAW[case.about]]["theorems"][-1]
    )


def _gains(
    what: str,
    change: Callable[[np.ndarray], np.ndarray],
    name: str,
    false: str | None = None,
    own: Answer = LOOSE,
) -> None:
    """Coefficients of the law, in the theorem alone and in the Program as well."""

    def changed(case: Case) -> None:
        shape = parameters(case.table, 5)
        values = change(np.array([float.fromhex(x) for x in shape[name]]))
        shape[name] = [float(x).hex() for x in values]

    @_kind(f"{what}, in the parameters only", "law")
    def _(case: Case) -> None:
        changed(case)

    @_kind(
        f"{what}, in the Program too",
        "lawfree",
        cpp=None,
        alone=UNTRUE if false else own,
        run=UNTRUE if false else own,
        bounded=false is not None,
    )
    def _(case: Case) -> None:
        changed(case)
        in_program(case.table)
        if false is not None:
            first(case.table, f"disturbed/{false}")


def _one(values: np.ndarray) -> np.ndarray:
    values[0] += 5.0
    return values


_gains("all gains of the inertia halved", lambda x: 0.5 * x, "inertia_gains", "decay")
_gains("no gains of the inertia", lambda x: 0.0 * x, "inertia_gains", "decay")
_gains("gains of the inertia with another sign", lambda x: -x, "inertia_gains", "decay")
_gains("a torque of 5 N m more", _one, "torque_gains", "rest")
_gains("no feed-forward torque", lambda x: 0.0 * x, "torque_gains", "rest")
# What is then proved is true, and of the file's polynomials: the header says that it has others.
_gains("gains of the inertia by a millionth", lambda x: x * (1.0 + 1e-6), "inertia_gains")
_gains("a degree of the torque less", lambda x: x[: 4 * 17 * 8], "torque_gains", own=NO)
_gains("a degree of the inertia less", lambda x: x[: 16 * 11 * 3], "inertia_gains", own=NO)
_gains("one coefficient alone", lambda x: x[:1], "torque_gains", own=NO)


def _text(what: str, value: Any) -> None:
    @_kind(f"gains {what}", "law", alone=UNREADABLE, run=UNREADABLE)
    def _(case: Case) -> None:
        parameters(case.table, 5)["torque_gains"] = value


_text("that are none", [])
_text("that are not numbers", ["nan"] * 612)
_text("a million of them", ["0x1.0p+0"] * 1_000_000)
_text("in decimals", [1.0] * 612)


@_kind("gains of the inertia, and none of the torque", *SCHEDULED)
def _(case: Case) -> None:
    parameters(case.table, 5).pop("torque_gains")


# ------------------------------------------------------------------------- other levels, runs


@_kind("level 5 claimed without level 4's theorem", alone=UNREADABLE, run=UNREADABLE)
def _(case: Case) -> None:
    del case.table["theorems"][-2]


@_kind("its theorem under level 4", alone=UNREADABLE, run=UNREADABLE)
def _(case: Case) -> None:
    case.table["theorems"][-1]["level"] = 4


@_kind("its theorem twice", alone=UNREADABLE, run=UNREADABLE)
def _(case: Case) -> None:
    case.table["theorems"].append(case.table["theorems"][-1])


@_kind("level 5 before level 4", alone=UNREADABLE, run=UNREADABLE)
def _(case: Case) -> None:
    case.table["theorems"][-2:] = case.table["theorems"][:-3:-1]


@_kind("a parameter that is not known", alone=UNREADABLE, run=UNREADABLE)
def _(case: Case) -> None:
    parameters(case.table, 5)["trust"] = "me"


@_kind("a premise of level 4 left out", "held", "lawfree", alone=REJECTED)
def _(case: Case) -> None:
    without(case.table, ["full/impulse"])


@_kind("a condition left out", "held", "lawfree", alone=UNTRUE)
def _(case: Case) -> None:
    without(case.table, ["knee"])


@_kind("another run's level 5 with this run's hashes", "held", "lawfree", cpp=None, alone=LOOSE)
def _(case: Case) -> None:
    constant(case.table, "policy.network.weights[2]", lambda w: w * (1.0 + 1e-9))


@_kind("a chart with an axis of robots", alone=REJECTED)
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


@_kind("footholds of unknown height", "held", "lawfree", alone=REJECTED)
def _(case: Case) -> None:
    parameters(case.table, 2)["floor"] = (0.01).hex()


@_kind("a robot with soles", alone=NO)
def _(case: Case) -> None:
    case.table["model"]["robot"]["sole"] = {name: (0.1).hex() for name in ("toe", "heel")}


@_kind("the model of a heavier robot", cpp=None, alone=LOOSE)
def _(case: Case) -> None:
    torso = case.table["model"]["robot"]["torso"]
    torso["mass"] = number(torso["mass"], 1.0625)


@_kind("level 5 claimed, and level 4 not", cpp=None, alone=LOOSE, run=LOOSE)
def _(case: Case) -> None:
    """It rests on level 4, which is concluded all the same."""
    case.table["theorems"][-2]["claimed"] = False
