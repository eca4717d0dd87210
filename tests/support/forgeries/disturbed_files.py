"""Level 5 with other premises, clocks and laws than those that were proved, and of other runs."""

from collections.abc import Callable
from dataclasses import replace

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
)
from support.forgeries.disturbed import FALLS
from support.forgeries.edits import (
    constant,
    constantly,
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


def kind_of(
    what: str,
    *abouts: About,
    theme: Theme = THEME,
    cpp: Answer | None = NO,
    alone: Answer = FALLS,
    run: Answer = NO,
    bounded: bool = False,
) -> Callable[[Callable[[Case], Content | None]], None]:
    """Register a change of several of the proofs; a checker in C++ may take minutes for some."""

    def register(change: Callable[[Case], Content | None]) -> None:
        for about in abouts or (theme.about,):
            answers = {"cpp": cpp, "alone": alone, "run": run}
            theme.forgery(f"{what} ({about})", about=about, bounded=bounded, **answers)(change)

    return register


def premise_of(case: Case, name: str) -> Table:
    return statement_of(case.table, f"disturbed/{name}")


def _premise(name: str) -> None:
    @kind_of(f"no statement of disturbed/{name}", alone=REJECTED)
    def _(case: Case) -> None:
        without(case.table, [f"disturbed/{name}"])

    @kind_of(f"less than nothing proved of disturbed/{name}", alone=FALLS)
    def _(case: Case) -> None:
        premise_of(case, name)["bounds"][f"disturbed/{name}"] = -1.0

    @kind_of(f"disturbed/{name} on half of its box", alone=REJECTED)
    def _(case: Case) -> None:
        corner = premise_of(case, name)["root"]["high"]
        corner[1] = number(corner[1], 0.5)


for _name in PREMISES:
    _premise(_name)


@kind_of("a premise under the label of level 4", alone=REJECTED)
def _(case: Case) -> None:
    premise_of(case, "decay")["region"] = "full order"


@kind_of("a premise in the scale 2", alone=REJECTED)
def _(case: Case) -> None:
    premise_of(case, "decay")["scales"]["disturbed/decay"] = 2.0


@kind_of("the kick on the step alone", "free", alone=REJECTED)
def _(case: Case) -> None:
    premise_of(case, "kick")["root"]["high"][0] = (1.0).hex()


@kind_of("the decay on the step alone", "law", alone=REJECTED)
def _(case: Case) -> None:
    premise_of(case, "decay")["root"] |= {"low": ["0x0.0p+0", "0x0.0p+0"]}


@kind_of("a leaf that is missing", alone=REJECTED)
def _(case: Case) -> None:
    premise_of(case, "decay")["tree"] = "0-"


@kind_of("a premise renamed, in the Program too", alone=FALLS)
def _(case: Case) -> None:
    rename(case.table, "disturbed/kick-slope", "disturbed/kick-slopes")


@kind_of("two premises under each other's names", cpp=None, alone=LOOSE)
def _(case: Case) -> None:
    """Each has the value of the other: what bounds the Program cannot know."""
    for old, new in (("jerk", "x"), ("jerk-push", "jerk"), ("x", "jerk-push")):
        rename(case.table, f"disturbed/{old}", f"disturbed/{new}")


def _twin(name: str, old: str) -> None:
    @kind_of(f"disturbed/{name} that computes {old}", cpp=None, alone=LOOSE)
    def _(case: Case) -> None:
        more_outputs(case.table, {f"disturbed/{name}": old})


for _name in ("rest", "jerk", "kick", "kick-slope", "kick-push"):
    _twin(_name, "full/inertia")


@kind_of("premises of level 5 that say 1", "held", "lawfree", cpp=None, alone=LOOSE)
def _(case: Case) -> None:
    names = [row[0] for row in case.table["program"]["outputs"]]
    constantly(case.table, [name for name in names if name.startswith("disturbed/")])


@kind_of("level 5 claimed without level 4's theorem", alone=UNREADABLE, run=UNREADABLE)
def _(case: Case) -> None:
    del case.table["theorems"][-2]


@kind_of("its theorem under level 4", alone=UNREADABLE, run=UNREADABLE)
def _(case: Case) -> None:
    case.table["theorems"][-1]["level"] = 4


@kind_of("its theorem twice", alone=UNREADABLE, run=UNREADABLE)
def _(case: Case) -> None:
    case.table["theorems"].append(case.table["theorems"][-1])


@kind_of("level 5 before level 4", alone=UNREADABLE, run=UNREADABLE)
def _(case: Case) -> None:
    case.table["theorems"][-2:] = case.table["theorems"][:-3:-1]


@kind_of("a parameter that is not known", alone=UNREADABLE, run=UNREADABLE)
def _(case: Case) -> None:
    parameters(case.table, 5)["trust"] = "me"


@kind_of("a premise of level 4 left out", "held", "lawfree", alone=REJECTED)
def _(case: Case) -> None:
    without(case.table, ["full/impulse"])


@kind_of("a condition left out", "held", "lawfree", alone=UNTRUE)
def _(case: Case) -> None:
    without(case.table, ["knee"])


@kind_of("another run's level 5 with this run's hashes", "held", "lawfree", cpp=None, alone=LOOSE)
def _(case: Case) -> None:
    constant(case.table, "policy.network.weights[2]", lambda w: w * (1.0 + 1e-9))


@kind_of("a chart with an axis of robots", alone=REJECTED)
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


@kind_of("footholds of unknown height", "held", "lawfree", alone=REJECTED)
def _(case: Case) -> None:
    parameters(case.table, 2)["floor"] = (0.01).hex()


@kind_of("a robot with soles", alone=NO)
def _(case: Case) -> None:
    case.table["model"]["robot"]["sole"] = {name: (0.1).hex() for name in ("toe", "heel")}


@kind_of("the model of a heavier robot", cpp=None, alone=LOOSE)
def _(case: Case) -> None:
    torso = case.table["model"]["robot"]["torso"]
    torso["mass"] = number(torso["mass"], 1.0625)


@kind_of("level 5 claimed, and level 4 not", cpp=None, alone=LOOSE, run=LOOSE)
def _(case: Case) -> None:
    """It rests on level 4, which is concluded all the same."""
    case.table["theorems"][-2]["claimed"] = False
