"""Forgeries of every system with proofs: flat feet, beliefs, speeds, cart-poles, hoppers."""

import copy
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from support.forgeries.base import (
    LOOSE,
    NO,
    UNREADABLE,
    UNTRUE,
    About,
    Answer,
    Case,
    Table,
    Theme,
    refused,
    true,
)
from support.forgeries.edits import (
    NOBODY,
    constant,
    constantly,
    first,
    number,
    parameters,
    program_of,
    put,
    renew,
    without,
)

THEME = Theme("feet")
OPEN_OR_FALSE = refused("undecided rejected")


@dataclass(frozen=True)
class Subject:
    """What there is to forge in a true proof.

    Attributes:
        about: which one.
        condition: of few boxes.
        numbers: where the model has the numbers of the robot, or of a link.
        number: one of them.
        array: of the weights, by its name in the Program.
        axis: of the chart, one that may have another end.
        family: whether a reader knows the spec's regions and conditions by the family's name.
    """

    about: About
    condition: str
    numbers: Callable[[Table], Table]
    number: str
    array: str
    axis: int
    family: bool = False


def _robot(table: Table) -> Table:
    return table["model"]["robot"]


def _torso(table: Table) -> Table:
    return table["model"]["robot"]["torso"]


SUBJECTS = (
    Subject("feet", "pressure-heel", _torso, "mass", "policy.ankle.network.biases[0]", 1),
    Subject("belief", "inertia", _torso, "mass", "policy.network.biases[0]", 2),
    Subject("speeds", "inertia", _torso, "along", "policy.network.biases[0]", 2),
    Subject("cartpole", "force", _robot, "pole_mass", "controls.policy.output", 3, family=True),
    Subject("hopper", "reach", _robot, "foot_mass", "policy.bias", 1, family=True),
)
OF_ANY: list[tuple[str, Callable[[Case, Subject], None]]] = []
"""Changes of any system's proof, by their words."""
BOX = {"low": ["0x0p+0", "0x0p+0"], "high": ["0x1p-1", "0x1p+0"]}


def _each(what: str, cpp: Answer = NO, alone: Answer = NO, **more: Any) -> Callable[[Any], None]:
    """Register a change of a case and its subject for every system."""

    def register(change: Callable[[Case, Subject], None]) -> None:
        OF_ANY.append((what, change))
        for one in SUBJECTS:
            words = f"{what} ({one.about})"

            @THEME.forgery(words, about=one.about, cpp=cpp, alone=alone, **more)
            def _(case: Case, one: Subject = one) -> None:
                change(case, one)

    return register


@_each("a bound far higher", UNTRUE, UNTRUE, bounded=True)
def _(case: Case, of: Subject) -> None:
    bounds = first(case.table, of.condition)["bounds"]
    bounds[of.condition] += 10.0


@_each("a condition without a statement", OPEN_OR_FALSE, OPEN_OR_FALSE)
def _(case: Case, of: Subject) -> None:
    without(case.table, [of.condition])


@_each("a condition gone from model and Program, too", true(), LOOSE)
def _(case: Case, of: Subject) -> None:
    table = case.table
    without(table, [of.condition])
    table["model"]["conditions"].pop(of.condition)
    table["program"]["outputs"] = [
        row for row in table["program"]["outputs"] if row[0] != of.condition
    ]
    put(table, program_of(table))


@_each("a statement of half its region", UNTRUE, UNTRUE)
def _(case: Case, of: Subject) -> None:
    corner = first(case.table, of.condition)["root"]["high"]
    corner[1] = number(corner[1], 0.5)


@_each("a region cut in half, in the model, too", true(), LOOSE)
def _(case: Case, of: Subject) -> None:
    model, statement = case.table["model"], first(case.table, of.condition)
    region = model["regions"][model["conditions"][of.condition]["region"]]
    region[0]["low"][1] = statement["root"]["low"][1] = (0.5).hex()


@_each("a leaf that is missing", refused("rejected"), refused("rejected"))
def _(case: Case, of: Subject) -> None:
    statement = first(case.table, of.condition)
    statement["tree"] = "1" + statement["tree"]


@_each("a robot of another weight", true(), LOOSE)
def _(case: Case, of: Subject) -> None:
    numbers = of.numbers(case.table)
    numbers[of.number] = number(numbers[of.number], 1.0625)


@_each("a number of the robot that is none", NO, LOOSE)
def _(case: Case, of: Subject) -> None:
    of.numbers(case.table)[of.number] = "nan"


@_each("weights of another gait under this one's hashes", true(), LOOSE)
def _(case: Case, of: Subject) -> None:
    constant(case.table, of.array, lambda weights: weights * 1.0001 + 1e-7)


@_each("a Program that says 1", true(), LOOSE)
def _(case: Case, _: Subject) -> None:
    constantly(case.table)


@_each("an operation that is another, under the hash before", refused("rejected"), NO)
def _(case: Case, _: Subject) -> None:
    case.table["program"]["operations"][3][0] = "neg"


@_each("a Program with an operation more", true(), LOOSE)
def _(case: Case, _: Subject) -> None:
    case.table["program"]["operations"].append(
        copy.deepcopy(case.table["program"]["operations"][-1])
    )
    renew(case.table)


@_each("an axis of another name", true(), LOOSE)
def _(case: Case, of: Subject) -> None:
    case.table["chart"][of.axis]["name"] = "height of the step"


@_each("an axis twice as long", true(), LOOSE)
def _(case: Case, of: Subject) -> None:
    axis = case.table["chart"][of.axis]
    for end in ("low", "high"):
        axis[end] = number(axis[end], 2.0)
        for statement in case.table["statements"]:
            statement["root"][end][of.axis] = axis[end]


@_each("an axis more", true(), LOOSE)
def _(case: Case, _: Subject) -> None:
    axis = {"name": "wind (error in N)", "low": (-1.0).hex(), "high": (1.0).hex()}
    case.table["chart"].append(axis)
    for statement in case.table["statements"]:
        for end in ("low", "high"):
            statement["root"][end].append(axis[end])


@_each("the name of another robot", true(), LOOSE)
def _(case: Case, _: Subject) -> None:
    case.table["robot"]["name"] = "atlas"


@_each("weights that nobody has", true(), LOOSE)
def _(case: Case, _: Subject) -> None:
    case.table["weights_sha256"] = NOBODY


@_each("a model of another family", UNREADABLE, UNREADABLE)
def _(case: Case, of: Subject) -> None:
    if of.family:
        case.table["model"].pop("family")
    else:
        case.table["model"]["family"] = "hopper"


@_each("a condition of the name of a premise", NO, NO)
def _(case: Case, of: Subject) -> None:
    conditions = case.table["model"]["conditions"]
    conditions["set/forward"] = conditions.pop(of.condition)


@_each("a model with a part more", NO, LOOSE)
def _(case: Case, _: Subject) -> None:
    case.table["model"]["trust"] = "me"


def _kind(
    about: About, what: str, change: Callable[[Table], Any], cpp: Answer = NO, alone: Answer = LOOSE
) -> None:
    @THEME.forgery(f"{what} ({about})", about=about, cpp=cpp, alone=alone)
    def _(case: Case) -> None:
        change(case.table)


def _roots(table: Table) -> None:
    for statement in table["statements"]:
        for end in ("low", "high"):
            statement["root"][end][2:] = [axis[end] for axis in table["chart"][2:]]


def _on_axes(change: Callable[[list[Table]], Any]) -> Callable[[Table], None]:
    """A change of the axes behind phase and level, and of every statement's box with them."""

    def changed(table: Table) -> None:
        change(table["chart"])
        _roots(table)

    return changed


def _sole(**ends: float) -> Callable[[Table], None]:
    return lambda table: _robot(table)["sole"].update({n: x.hex() for n, x in ends.items()})


def _ankle(name: str, factor: float) -> Callable[[Table], None]:
    def change(table: Table) -> None:
        link = _robot(table)["leg"][0]
        link[name] = number(link[name], factor)

    return change


def _swap(table: Table) -> None:
    conditions = table["model"]["conditions"]
    heel, toe = conditions["pressure-heel"]["quantity"], conditions["pressure-toe"]["quantity"]
    heel["end"], toe["end"] = toe["end"], heel["end"]


def _level(level: int, **changed: Any) -> Callable[[Table], None]:
    return lambda table: parameters(table, level).update(changed)


_kind("feet", "a sole of a metre", _sole(toe=1.0), true(r"to 1 m ahead"))
_kind("feet", "a sole of a centimetre", _sole(toe=0.005, heel=0.005))
_kind("feet", "heel and toe swapped in the conditions", _swap, true())
_kind("feet", "an ankle as strong as ten", _ankle("torque_limit", 10.0), true())
_kind("feet", "an ankle as weak as nothing", _ankle("torque_limit", 1e-3))
_kind("feet", "a rotor of the ankle a thousand times as heavy", _ankle("armature", 1e3), true())
_kind("feet", "an ankle twice as high", _ankle("length", 2.0))
_kind("feet", "points for feet", lambda t: _robot(t).pop("sole"))
_kind("feet", "no torque of the ankle", lambda t: t["model"]["policy"].pop("ankle"))
_kind("feet", "a floor of unknown height", _level(2, floor=(0.01).hex()), NO, NO)
_kind("feet", "a push that nobody proved", _level(2, disturbance=[(0.1).hex()] * 2), NO, NO)
_kind("feet", "another rate of the orbit", _level(3, slowest=[(0.0).hex()]), NO, NO)
_kind("feet", "an orbit of nested tubes", _level(3, attraction="nested tubes"), NO, NO)

_kind("belief", "the distance left out", _on_axes(lambda chart: chart.pop()), NO, NO)
_kind("belief", "one side more", _on_axes(lambda c: c[4].update(low=(-0.004).hex())), true())
_kind("belief", "the distance twice", _on_axes(lambda c: c.append(c[4] | {"name": "other lean"})))
_kind("belief", "any belief after any", lambda t: t["chart"][3].pop("change"), NO, NO)
_kind("belief", "beliefs that hardly change", lambda t: t["chart"][3].update(change="0x1p-20"))
_kind("belief", "the lean called a speed", lambda t: _command(t).update(name="speed"), NO)
_kind("belief", "wider beliefs in the policy", lambda t: _command(t).update(high=(0.02).hex()), NO)
_kind("belief", "a torso that is not there", lambda t: _robot(t).update(torso=None), NO)
_kind("speeds", "the speed called a lean", lambda t: _command(t).update(name="lean"), NO)
_kind("speeds", "the axis after first", _on_axes(lambda c: c.insert(2, c.pop())), NO, NO)
_kind("cartpole", "a rate of ten", lambda t: t["model"].update(rate=(10.0).hex()), UNTRUE)
_kind("cartpole", "a rate below zero", lambda t: t["model"].update(rate="-0x1p-4"), NO, NO)
_kind("cartpole", "a hopper", lambda t: t["model"].update(family="hopper"), NO, NO)
_kind("hopper", "a rate below zero", lambda t: t["model"].update(rate="-0x1p-4"), NO, NO)
_kind("hopper", "a cart-pole", lambda t: t["model"].update(family="cartpole"), NO, NO)


def _command(table: Table) -> Table:
    return table["model"]["policy"]["commands"][0]
