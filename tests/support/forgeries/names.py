"""Conditions that are called what they are not: premises, other conditions, nothing at all."""

from typing import Any

from support.forgeries.base import LOOSE, NO, UNREADABLE, Case, Table, Theme, refused, true
from support.forgeries.edits import (
    claim,
    constant,
    constantly,
    more_constants,
    more_outputs,
    parameters,
    rename,
    root,
    statement_of,
)

THEME = Theme("walk")
LAST_LAYER = "policy.network.weights[2]"
HIP = {"function": "hip_height"}
WHOLE = root((0.0, 0.0), (1.0, 1.0))


def trivial(region: str = "tube", scale: float = 1.0, bound: float = -1e6) -> Table:
    """A condition that cannot fail: the hip is not a thousand kilometres below the ground."""
    quantity = {"function": "at_least", "of": HIP, "bound": bound}
    return {"kind": "Pointwise", "region": region, "scale": scale, "quantity": quantity}


def shadow(table: Table, names: list[str]) -> None:
    """Conditions of the spec with the names of premises, on regions made for them."""
    one_each(table)
    constantly(table, names, scalar=True)
    for name in names:
        region = f"of {name}"
        boxes = [s["root"] for s in table["statements"] if name in s["conditions"]]
        table["model"]["regions"][region] = boxes
        table["model"]["conditions"][name] = trivial(region)
        for statement in table["statements"]:
            if name in statement["conditions"]:
                statement["region"] = region


def one_each(table: Table) -> None:
    """Every statement about one output only, so that each can have a region of its own."""
    found = []
    for s in table["statements"]:
        for name in s["conditions"]:
            own: dict[str, Any] = {part: {name: s[part][name]} for part in ("scales", "bounds")}
            found.append({**s, "conditions": [name], **own})
    table["statements"] = found


def _shadow_kind(name: str) -> None:
    @THEME.forgery(f"a condition of the spec is called {name}, like the premise")
    def _(case: Case) -> None:
        shadow(case.table, [name])


for _name in ("set/inertia", "set/reset-level", "set/after torso-lower", "orbit/gain"):
    _shadow_kind(_name)


@THEME.forgery("policy weights times -3; conditions of the spec called like every premise")
def _(case: Case) -> None:
    table = case.table
    names = sorted({name for s in table["statements"] for name in s["conditions"]})
    premises = [name for name in names if "/" in name]
    constant(table, LAST_LAYER, lambda w: -3.0 * w)
    shadow(table, premises)
    constantly(table, scalar=True)
    # What the spec itself asks is restated so that it holds of anything.
    for name, condition in table["model"]["conditions"].items():
        if name not in premises:
            weak = trivial(condition["region"], condition["scale"])
            weak |= {"kind": "Barrier", "alpha": 10.0} if condition["kind"] == "Barrier" else {}
            table["model"]["conditions"][name] = weak


@THEME.forgery("a condition of the model alone is called set/inertia")
def _(case: Case) -> None:
    table = case.table
    table["model"]["regions"]["T"] = [statement_of(table, "set/inertia")["root"]]
    table["model"]["conditions"]["set/inertia"] = trivial("T")


@THEME.forgery(
    "a theorem with a disturbance, premises of the undisturbed flow under its names",
    alone=true(r"whatever d\(t\)"),
)
def _(case: Case) -> None:
    table = case.table
    push = [(0.05).hex(), (5.0).hex()]
    parameters(table, 2)["disturbance"] = push
    more_constants(table, {"walking.disturbance": [0.05, 5.0]})
    twins = {f"set/rate {name}": name for name in ("torso-lower", "torso-upper")}
    more_outputs(table, twins)
    whole = statement_of(table, "set/inertia")["root"]
    for name in twins:
        table["statements"].append(claim(name, whole, region="walking set"))


@THEME.forgery("the same, and the spec's undisturbed conditions called like the premises")
def _(case: Case) -> None:
    table = case.table
    one_each(table)
    parameters(table, 2)["disturbance"] = [(0.05).hex(), (5.0).hex()]
    more_constants(table, {"walking.disturbance": [0.05, 5.0]})
    velocity = {"function": "foot_vertical_velocity"}
    pushed = {
        "set/forward": ({"function": "forward_rate"}, 0.3),
        "set/foot-rises": (velocity, 0.1),
        "set/foot-falls": ({"function": "at_most", "of": velocity, "bound": 0.0}, 0.1),
    }
    conditions, regions = table["model"]["conditions"], table["model"]["regions"]
    for name, (quantity, bound) in pushed.items():
        statement_of(table, name)["bounds"][name] = bound
        conditions[name] = {"kind": "Pointwise", "region": "T", "scale": 1.0, "quantity": quantity}
    regions["T"] = [WHOLE]
    for side in ("lower", "upper"):
        edge = 0.0 if side == "lower" else 1.0
        conditions[f"set/fence-{side}"] = conditions[f"flow-{_of(side)}-fence"] | {"region": side}
        regions[side] = [root((0.0, edge), (1.0, edge))]
    for name in ("torso-lower", "torso-upper"):
        conditions[f"set/rate {name}"] = conditions[name]
    whole = statement_of(table, "set/inertia")["root"]
    twins = {f"set/rate {name}": name for name in ("torso-lower", "torso-upper")}
    more_outputs(table, twins)
    for name in twins:
        scale = {"scales": {name: 3.3}}
        table["statements"].append(claim(name, whole, region="walking set") | scale)


def _of(side: str) -> str:
    return "above-lower" if side == "lower" else "below-upper"


def restated(table: Table, name: str) -> None:
    """The condition `tall` of the small spec under another name, with a bound that says nothing."""
    rename(table, "tall", name)
    table["model"]["conditions"][name]["quantity"]["bound"] = -10.0


def _name_kind(name: str, what: str, premise: bool = False) -> None:
    answer = NO if premise else UNREADABLE

    @THEME.forgery(f"a condition called {what}", cpp=answer, alone=answer, about="small")
    def _(case: Case) -> None:
        restated(case.table, name)


_name_kind("hip/high", "hip/high, above -10 m")
_name_kind("full/rate level-lower", "full/rate level-lower in a file of level 1")
_name_kind("set/inertia", "set/inertia in a file of level 1")
_name_kind("/", "/")
_name_kind("set/", "set/")
_name_kind("set/after nothing", "set/after nothing")


@THEME.forgery(
    "an output called hip/high, which no premise is",
    cpp=refused("unreadable rejected"),
    alone=UNREADABLE,
)
def _(case: Case) -> None:
    more_outputs(case.table, {"hip/high": "knee"})


@THEME.forgery("a premise of a barrier that the theorem does not name")
def _(case: Case) -> None:
    more_outputs(case.table, {"set/after knee": "set/after torso-lower"})
    table = case.table
    table["statements"].append(claim("set/after knee", WHOLE, region="walking set"))


@THEME.forgery("a condition whose name reads like two", about="walk", cpp=LOOSE, alone=LOOSE)
def _(case: Case) -> None:
    """In a list of what holds it is read as torso-upper and a condition that there is not."""
    rename(case.table, "knee", "torso-upper, hip-high")
    carried = parameters(case.table, 2)["carried"]
    carried[carried.index("knee")] = "torso-upper, hip-high"


@THEME.forgery("an empty name", about="small", cpp=refused("unreadable rejected"))
def _(case: Case) -> None:
    restated(case.table, "")
