"""Regions that are not those of the spec: half, shrunk, renamed, moved, empty, elsewhere."""

import copy
import json

from support.forgeries.base import LOOSE, NO, OPEN, UNTRUE, Case, Theme, refused, true
from support.forgeries.edits import (
    first,
    number,
    parameters,
    program_of,
    put,
    rename_region,
    root,
    statement_of,
    without,
)

THEME = Theme("small")
OF_A_REGION = r"in their regions, which are not all of T: [^\n]*normal-force"
"""A condition that holds along a trajectory only on its region is said to."""


def _of_ends(case: Case) -> list[dict]:
    return [s for s in case.table["statements"] if s["region"] == "ends"]


@THEME.forgery(
    "half a region: one of its two boxes has no statement", cpp=OPEN, alone=OPEN, run=OPEN
)
def _(case: Case) -> None:
    case.table["statements"].remove(_of_ends(case)[1])


@THEME.forgery("one of two conditions has no statement", cpp=OPEN, alone=OPEN, run=OPEN)
def _(case: Case) -> None:
    without(case.table, ["tall"])


@THEME.forgery(
    "half a region, in the model as well", cpp=true(r"\[0, 0\.25\]"), alone=LOOSE, run=NO
)
def _(case: Case) -> None:
    case.table["statements"].remove(_of_ends(case)[1])
    case.table["model"]["regions"]["ends"].pop()


@THEME.forgery(
    "a condition left out, in the model and the Program as well", cpp=true(), alone=LOOSE
)
def _(case: Case) -> None:
    table = case.table
    without(table, ["brisk"])
    del table["model"]["conditions"]["brisk"]
    table["program"]["outputs"] = [r for r in table["program"]["outputs"] if r[0] != "brisk"]
    put(table, program_of(table))


@THEME.forgery(
    "a region shrunk by one last place, in its statement", cpp=UNTRUE, alone=UNTRUE, run=UNTRUE
)
def _(case: Case) -> None:
    corner = statement_of(case.table, "tall")["root"]["high"]
    corner[0] = number(corner[0], ulps=-1)


@THEME.forgery("a region shrunk by half, in its statement", cpp=UNTRUE, alone=UNTRUE, run=UNTRUE)
def _(case: Case) -> None:
    corner = statement_of(case.table, "tall")["root"]["high"]
    corner[0] = number(corner[0], 0.5)


@THEME.forgery(
    "a region shrunk to a point, in its statement",
    cpp=UNTRUE,
    alone=UNTRUE,
    run=UNTRUE,
    bounded=True,
)
def _(case: Case) -> None:
    statement_of(case.table, "tall").update(root=root((0.0, 0.0), (0.0, 0.0)), tree="-")


@THEME.forgery(
    "a region grown beyond the step, in its statement", cpp=UNTRUE, alone=UNTRUE, run=UNTRUE
)
def _(case: Case) -> None:
    statement_of(case.table, "tall")["root"] = root((-0.01, 0.0), (1.0, 1.0))


@THEME.forgery("statements about nothing but places beyond the step")
def _(case: Case) -> None:
    table = case.table
    table["statements"] = [statement_of(table, "tall")]
    table["statements"][0]["root"] = root((-0.01, 0.0), (0.0, 1.0))


@THEME.forgery(
    "a region shrunk by one last place, in the model as well",
    cpp=true(r"0\.9999999999999999"),
    alone=LOOSE,
)
def _(case: Case) -> None:
    for box in (
        statement_of(case.table, "tall")["root"],
        case.table["model"]["regions"]["tube"][0],
    ):
        box["high"][0] = number(box["high"][0], ulps=-1)


@THEME.forgery(
    "a region shrunk by half, in the model as well", cpp=true(r"\[0, 0\.5\]"), alone=LOOSE
)
def _(case: Case) -> None:
    for box in (
        statement_of(case.table, "tall")["root"],
        case.table["model"]["regions"]["tube"][0],
    ):
        box["high"][0] = number(box["high"][0], 0.5)


@THEME.forgery("a region renamed in a statement", cpp=UNTRUE, alone=UNTRUE, run=UNTRUE)
def _(case: Case) -> None:
    statement_of(case.table, "tall")["region"] = "everywhere"


@THEME.forgery("a statement under another region's name", cpp=UNTRUE, alone=UNTRUE, run=UNTRUE)
def _(case: Case) -> None:
    statement_of(case.table, "tall")["region"] = "ends"


@THEME.forgery("a region renamed wherever it stands", cpp=true("everywhere"), alone=LOOSE)
def _(case: Case) -> None:
    rename_region(case.table, "ends", "everywhere")


@THEME.forgery("two regions with each other's name", cpp=true(), alone=LOOSE, bounded=True)
def _(case: Case) -> None:
    rename_region(case.table, "ends", "")
    rename_region(case.table, "tube", "ends")
    rename_region(case.table, "", "tube")


@THEME.forgery("a region of no boxes, and no statement about its condition")
def _(case: Case) -> None:
    table = case.table
    without(table, ["brisk"])
    table["model"]["regions"]["ends"] = []


@THEME.forgery(
    "root boxes of two statements exchanged", cpp=UNTRUE, alone=UNTRUE, run=UNTRUE, bounded=True
)
def _(case: Case) -> None:
    one, two = statement_of(case.table, "tall"), _of_ends(case)[0]
    one["root"], two["root"] = two["root"], one["root"]


@THEME.forgery("a premise's region is called something else", about="walk", cpp=true(), alone=LOOSE)
def _(case: Case) -> None:
    statement_of(case.table, "set/inertia")["region"] = "on average"


@THEME.forgery(
    "a premise under the name of the spec's region", about="walk", cpp=true(), alone=LOOSE
)
def _(case: Case) -> None:
    statement_of(case.table, "set/inertia")["region"] = "tube"


@THEME.forgery("root boxes of two premises exchanged", about="walk")
def _(case: Case) -> None:
    one, two = (statement_of(case.table, f"set/foot-{what}") for what in ("rises", "falls"))
    one["root"], two["root"] = two["root"], one["root"]


@THEME.forgery("a premise on the step without its strips", about="walk")
def _(case: Case) -> None:
    statement_of(case.table, "set/forward")["root"] = root((0.0, 0.0), (1.0, 1.0))


def _along(case: Case, boxes: list[dict]) -> None:
    """The force's region is these boxes alone, and it is still said to hold along trajectories."""
    table, name = case.table, "normal-force"
    whole = statement_of(table, name)
    own = [copy.deepcopy(whole) for _ in boxes]
    strips = [s for s in table["statements"] if s["region"] == "strips"]
    bounds = {s["root"]["low"][0]: s["bounds"][name] for s in strips if name in s["bounds"]}
    roots = {s["root"]["low"][0]: s["root"] for s in strips if name in s["bounds"]}
    scale, bound = whole["scales"][name], whole["bounds"][name]
    without(table, [name])
    for statement, box in zip(own, boxes, strict=True):
        statement |= {"conditions": [name], "region": "chosen", "root": box}
        statement |= {"scales": {name: scale}, "bounds": {name: bound}}
    for low, box in roots.items():
        strip = json.loads(json.dumps(own[0])) if own else copy.deepcopy(whole)
        strip |= {"conditions": [name], "region": "strips", "root": box, "tree": "-"}
        own.append(strip | {"scales": {name: scale}, "bounds": {name: bounds[low]}})
    table["statements"] = own + table["statements"]
    table["model"]["regions"]["chosen"] = boxes
    table["model"]["conditions"][name]["region"] = "chosen"


@THEME.forgery(
    "a force along trajectories, proved on half of the step",
    about="walk",
    cpp=true(OF_A_REGION),
    alone=true(OF_A_REGION),
)
def _(case: Case) -> None:
    _along(case, [root((0.0, 0.0), (0.5, 1.0))])


@THEME.forgery(
    "a force along trajectories, proved on two boxes with a gap of one last place",
    about="walk",
    cpp=true(OF_A_REGION),
    alone=true(OF_A_REGION),
)
def _(case: Case) -> None:
    after = float.fromhex(number((0.5).hex(), ulps=1))
    _along(case, [root((0.0, 0.0), (0.5, 1.0)), root((after, 0.0), (1.0, 1.0))])


@THEME.forgery("a force along trajectories, on a region of no boxes", about="walk")
def _(case: Case) -> None:
    _along(case, [])
    name = "normal-force"
    without(case.table, [name])


@THEME.forgery("a region of no boxes for all that holds along trajectories", about="walk")
def _(case: Case) -> None:
    table = case.table
    carried = parameters(table, 2)["carried"]
    without(table, carried)
    table["model"]["regions"]["chosen"] = []
    for name in carried:
        table["model"]["conditions"][name]["region"] = "chosen"


@THEME.forgery("a statement twice, the weaker one first", cpp=true(), alone=LOOSE, run=LOOSE)
def _(case: Case) -> None:
    weak = copy.deepcopy(statement_of(case.table, "tall"))
    weak["bounds"]["tall"] = 0.0
    case.table["statements"].insert(0, weak)


@THEME.forgery("a statement twice, the weaker one last", cpp=true(), alone=LOOSE, run=LOOSE)
def _(case: Case) -> None:
    weak = copy.deepcopy(statement_of(case.table, "tall"))
    weak["bounds"]["tall"] = 0.0
    case.table["statements"].append(weak)


@THEME.forgery(
    "a premise twice, the weaker one first", about="walk", cpp=true(), alone=LOOSE, run=LOOSE
)
def _(case: Case) -> None:
    weak = copy.deepcopy(statement_of(case.table, "set/foot-above"))
    weak["bounds"]["set/foot-above"] = -1.0
    first(case.table, "set/foot-above")
    case.table["statements"].insert(0, weak)


@THEME.forgery(
    "a premise twice, the weaker one last", about="walk", cpp=true(), alone=LOOSE, run=LOOSE
)
def _(case: Case) -> None:
    weak = copy.deepcopy(statement_of(case.table, "set/foot-above"))
    weak["bounds"]["set/foot-above"] = -1.0
    case.table["statements"].append(weak)


@THEME.forgery(
    "a statement twice, the second one false", cpp=refused("rejected"), alone=NO, bounded=True
)
def _(case: Case) -> None:
    strong = copy.deepcopy(statement_of(case.table, "tall"))
    strong["bounds"]["tall"] = 1.0
    case.table["statements"].append(strong)
