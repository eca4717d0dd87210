"""Level 5 stated of another clock or another law than it was proved of."""

import copy
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np

from support.forgeries.base import LOOSE, NO, UNREADABLE, About, Case, Theme
from support.forgeries.disturbed import FREE, SCHEDULED, in_program
from support.forgeries.disturbed_files import kind_of as any_kind_of
from support.forgeries.disturbed_files import premise_of
from support.forgeries.edits import (
    claim,
    more_constants,
    more_outputs,
    parameters,
    program_of,
    put,
    statement_of,
    without,
)

THEME = Theme("lawfree")
kind_of = partial(any_kind_of, theme=THEME)
KICK = ("kick", "kick_slope", "kick_push", "kick_peak")
KICK_PREMISES = ("kick", "kick-slope", "kick-push", "kick-contact")
LAW_PREMISES = ("decay", "rest")
OTHER_CLOCK: dict[About, About] = {
    "held": "free",
    "free": "held",
    "law": "lawfree",
    "lawfree": "law",
}
OTHER_LAW: dict[About, About] = {"held": "law", "law": "held", "free": "lawfree", "lawfree": "free"}


def _kicks(case: Case) -> None:
    """The numbers of a free clock, as they are in its own proof."""
    other = parameters(case.base.proofs[OTHER_CLOCK[case.about]], 5)
    parameters(case.table, 5).update({name: other[name] for name in (*KICK, "kick_end")})


def _kick_constants(case: Case) -> None:
    shape = parameters(case.table, 5)
    more_constants(case.table, {"disturbed.kick": [float.fromhex(shape[n]) for n in KICK]})


@kind_of("ticks at touchdowns stated as a free clock", "held", "law")
def _(case: Case) -> None:
    _kicks(case)


@kind_of("the same, with the Program's constants", "held")
def _(case: Case) -> None:
    _kicks(case)
    _kick_constants(case)


@kind_of("the same, with statements of what the Program lacks", "law", alone=UNREADABLE)
def _(case: Case) -> None:
    _kicks(case)
    _kick_constants(case)
    other = case.base.proofs[OTHER_CLOCK[case.about]]
    for name in KICK_PREMISES:
        case.table["statements"].append(copy.deepcopy(statement_of(other, f"disturbed/{name}")))


@kind_of("the same, and outputs that compute something else", "held", cpp=None, alone=NO)
def _(case: Case) -> None:
    """The boxes are another set's, unless the sets end at the same phases."""
    _kicks(case)
    _kick_constants(case)
    shape, full = parameters(case.table, 5), parameters(case.table, 4)
    last = float.fromhex(premise_of(case, "contact")["root"]["high"][0]).hex()
    for name in KICK_PREMISES:
        low = (1.0 - float.fromhex(full["guard_strip"])).hex()
        box = {"low": [low, "0x0.0p+0"], "high": [last, "0x1.0000000000000p+0"]}
        if name == "kick-contact":
            box["low"][0] = premise_of(case, "contact")["root"]["low"][0]
            box["high"][0] = shape["kick_end"]
        told = claim(f"disturbed/{name}", box, region="disturbed", bound=1e-9)
        case.table["statements"].append(told)
    more_outputs(case.table, {f"disturbed/{name}": "full/inertia" for name in KICK_PREMISES})


@kind_of("a free clock stated as ticks at touchdowns", *FREE)
def _(case: Case) -> None:
    parameters(case.table, 5).pop("kick_end")


@kind_of("the same, without the statements of its kick", "free", cpp=None, alone=LOOSE)
def _(case: Case) -> None:
    """What is said then is true, but the Program is not the one of such a theorem."""
    shape = parameters(case.table, 5)
    for name in (*KICK, "kick_end"):
        shape.pop(name)
    without(case.table, [f"disturbed/{name}" for name in KICK_PREMISES])


@kind_of("the theorem of the other clock", "held", "lawfree")
def _(case: Case) -> None:
    case.table["theorems"] = copy.deepcopy(case.base.proofs[OTHER_CLOCK[case.about]]["theorems"])


@kind_of("level 5 of the other clock", "free", "law")
def _(case: Case) -> None:
    case.table["theorems"][-1] = copy.deepcopy(
        case.base.proofs[OTHER_CLOCK[case.about]]["theorems"][-1]
    )


@kind_of("the Program of the other clock", "held", "lawfree")
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


@kind_of("fblin stated as scheduled-pd", "held")
def _(case: Case) -> None:
    _law_of_other(case)


@kind_of("the same, with its constants in the Program", "free")
def _(case: Case) -> None:
    _law_of_other(case)
    _law_constants(case)


@kind_of("fblin stated so, and outputs that compute something else", "held", cpp=None, alone=NO)
def _(case: Case) -> None:
    _law_of_other(case)
    _law_constants(case)
    box = copy.deepcopy(premise_of(case, "contact")["root"])
    for name in LAW_PREMISES:
        told = claim(f"disturbed/{name}", box, region="disturbed", bound=1e-9)
        case.table["statements"].append(told)
    more_outputs(case.table, {f"disturbed/{name}": "full/inertia" for name in LAW_PREMISES})


@kind_of("scheduled-pd stated as fblin", "lawfree")
def _(case: Case) -> None:
    for name in LAW:
        parameters(case.table, 5).pop(name)


@kind_of("the same, without the statements of its law", "lawfree", cpp=None, alone=LOOSE)
def _(case: Case) -> None:
    for name in LAW:
        parameters(case.table, 5).pop(name)
    without(case.table, [f"disturbed/{name}" for name in LAW_PREMISES])


@kind_of("the theorem of the other law", "held", "lawfree")
def _(case: Case) -> None:
    case.table["theorems"] = copy.deepcopy(case.base.proofs[OTHER_LAW[case.about]]["theorems"])


@kind_of("level 5 of the other law", "free", "law")
def _(case: Case) -> None:
    case.table["theorems"][-1] = copy.deepcopy(
        case.base.proofs[OTHER_LAW[case.about]]["theorems"][-1]
    )


def _gains(
    what: str, change: Callable[[np.ndarray], np.ndarray], name: str, *, true: bool = False
) -> None:
    """Coefficients of the law in the theorem alone; in the Program as well, if that is true."""

    def changed(case: Case) -> None:
        shape = parameters(case.table, 5)
        values = change(np.array([float.fromhex(x) for x in shape[name]]))
        shape[name] = [float(x).hex() for x in values]

    @kind_of(f"{what}, in the parameters only", "law")
    def _(case: Case) -> None:
        changed(case)

    if not true:
        return

    @kind_of(f"{what}, in the Program too", "lawfree", cpp=None, alone=LOOSE, run=LOOSE)
    def _(case: Case) -> None:
        changed(case)
        in_program(case.table)


def _one(values: np.ndarray) -> np.ndarray:
    values[0] += 5.0
    return values


_gains("all gains of the inertia halved", lambda x: 0.5 * x, "inertia_gains")
_gains("no gains of the inertia", lambda x: 0.0 * x, "inertia_gains")
_gains("gains of the inertia with another sign", lambda x: -x, "inertia_gains")
_gains("a torque of 5 N m more", _one, "torque_gains")
_gains("no feed-forward torque", lambda x: 0.0 * x, "torque_gains")
# What is then proved is true, and of the file's polynomials: the header says that it has others.
_gains(
    "gains of the inertia by a millionth", lambda x: x * (1.0 + 1e-6), "inertia_gains", true=True
)
_gains("a degree of the torque less", lambda x: x[: 4 * 17 * 8], "torque_gains")
_gains("a degree of the inertia less", lambda x: x[: 16 * 11 * 3], "inertia_gains")
_gains("one coefficient alone", lambda x: x[:1], "torque_gains")


def _text(what: str, value: Any) -> None:
    @kind_of(f"gains {what}", "law", alone=UNREADABLE, run=UNREADABLE)
    def _(case: Case) -> None:
        parameters(case.table, 5)["torque_gains"] = value


_text("that are none", [])
_text("that are not numbers", ["nan"] * 612)
_text("a million of them", ["0x1.0p+0"] * 1_000_000)
_text("in decimals", [1.0] * 612)


@kind_of("gains of the inertia, and none of the torque", *SCHEDULED)
def _(case: Case) -> None:
    parameters(case.table, 5).pop("torque_gains")
