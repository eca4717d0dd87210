"""Programs that are not the spec's: constants, outputs, operations, inputs, hashes."""

from dataclasses import replace

import numpy as np

from neuralgaits.programs import Constant, Input
from support.forgeries.base import LOOSE, NO, REJECTED, UNTRUE, Case, Table, Theme, refused, true
from support.forgeries.edits import (
    constant,
    constantly,
    first,
    more_constants,
    more_outputs,
    program_of,
    put,
    renew,
    shifted,
    statement_of,
)

THEME = Theme("small")
LAST_LAYER = "policy.network.weights[2]"


@THEME.forgery("policy weights times -3", about="walk", cpp=REJECTED, alone=REJECTED, bounded=True)
def _(case: Case) -> None:
    first(case.table, "set/foot-rises")
    constant(case.table, LAST_LAYER, lambda w: -3.0 * w)


@THEME.forgery(
    "policy weights times -3 under the old hash", about="walk", cpp=REJECTED, alone=REJECTED
)
def _(case: Case) -> None:
    old = case.table["program_hash"]
    constant(case.table, LAST_LAYER, lambda w: -3.0 * w)
    case.table["program_hash"] = old


@THEME.forgery("a policy weight by one last place", cpp=true(), alone=LOOSE)
def _(case: Case) -> None:
    constant(case.table, LAST_LAYER, lambda w: np.nextafter(w, np.inf))


@THEME.forgery("a fence of the tube by one last place", cpp=true(), alone=LOOSE)
def _(case: Case) -> None:
    constant(case.table, "tube.lower", lambda w: np.nextafter(w, np.inf))


@THEME.forgery("fences of the tube exchanged", cpp=UNTRUE, alone=LOOSE, about="walk")
def _(case: Case) -> None:
    arrays = program_of(case.table).parameters
    constant(case.table, "tube.lower", lambda _: arrays["tube.upper"])
    constant(case.table, "tube.upper", lambda _: arrays["tube.lower"])


def _rename_constant(table: Table, old: str | None, new: str | None) -> None:
    for row in table["program"]["constants"]:
        if row[0] == old:
            row[0] = new
            break
    renew(table)


@THEME.forgery("a weight without its name", cpp=REJECTED, alone=LOOSE)
def _(case: Case) -> None:
    _rename_constant(case.table, "policy.cubic", None)


@THEME.forgery(
    "a weight changed, without its name, and as numbers in the model", cpp=true(), alone=LOOSE
)
def _(case: Case) -> None:
    table, name = case.table, "policy.cubic"
    constant(table, name, lambda w: w + 1e-9)
    array = program_of(table).parameters[name]
    _rename_constant(table, name, None)
    values = [float(x).hex() for x in array.ravel()]
    table["model"]["policy"]["arrays"]["cubic"] = {"shape": list(array.shape), "values": values}


@THEME.forgery("two weights with each other's name", cpp=LOOSE, alone=LOOSE)
def _(case: Case) -> None:
    one, two = (f"policy.network.biases[{k}]" for k in (0, 1))
    _rename_constant(case.table, one, "")
    _rename_constant(case.table, two, one)
    _rename_constant(case.table, "", two)


@THEME.forgery("a further constant with a weight's name", cpp=UNTRUE, alone=LOOSE)
def _(case: Case) -> None:
    more_constants(case.table, {"policy.more": [1.0]})


@THEME.forgery("two constants with one name", cpp=refused("unreadable rejected"), alone=LOOSE)
def _(case: Case) -> None:
    more_constants(case.table, {"policy.cubic": np.ones((4, 4))})


@THEME.forgery(
    "a number of the formulas doubled: a mass, a length", cpp=true(), alone=LOOSE, bounded=True
)
def _(case: Case) -> None:
    program = program_of(case.table)
    rows = list(program.constants)
    place = next(k for k, c in enumerate(rows) if c.name is None and c.array.size > 4)
    rows[place] = replace(rows[place], array=2.0 * rows[place].array)
    put(case.table, replace(program, constants=tuple(rows)))


@THEME.forgery("a Program whose outputs are all 1, level 1", cpp=true(), alone=LOOSE)
def _(case: Case) -> None:
    constantly(case.table)


@THEME.forgery(
    "a Program whose outputs are all 1, levels 1 to 3", about="walk", cpp=true(), alone=LOOSE
)
def _(case: Case) -> None:
    constantly(case.table)


@THEME.forgery("a Program whose outputs are all 1, level 4", about="full", cpp=true(), alone=LOOSE)
def _(case: Case) -> None:
    constantly(case.table)


@THEME.forgery("one output is the constant 1", cpp=true(), alone=LOOSE)
def _(case: Case) -> None:
    constantly(case.table, ["tall"])


@THEME.forgery("an output of the orbit is the constant 1", about="walk", cpp=true(), alone=LOOSE)
def _(case: Case) -> None:
    constantly(case.table, ["orbit/expansion"])


@THEME.forgery("a Program that says nothing of xi, level 4", about="full", cpp=NO, alone=NO)
def _(case: Case) -> None:
    """Outputs at u alone: nothing is then proved of outputs off zero."""
    constantly(case.table)
    program = program_of(case.table)
    put(case.table, _without_second_input(program))


@THEME.forgery("a Program of one xi, level 4", about="full", cpp=NO, alone=LOOSE)
def _(case: Case) -> None:
    constantly(case.table)
    program = program_of(case.table)
    put(case.table, replace(program, inputs=(Input("u", (2,)), Input("xi", (1,)))))


@THEME.forgery("a Program with xi, levels 1 to 3", about="walk", cpp=NO, alone=LOOSE)
def _(case: Case) -> None:
    constantly(case.table)
    program = program_of(case.table)
    outputs = tuple(replace(row, value=row.value + 1) for row in program.outputs)
    put(case.table, replace(program, inputs=(Input("u", (2,)), Input("xi", (8,))), outputs=outputs))


def _without_second_input(program):
    """Of a Program without operations."""
    outputs = tuple(replace(row, value=row.value - 1) for row in program.outputs)
    return replace(program, inputs=program.inputs[:1], outputs=outputs)


@THEME.forgery("two outputs exchanged", cpp=true(), alone=LOOSE, bounded=True)
def _(case: Case) -> None:
    rows = case.table["program"]["outputs"]
    rows[0][2], rows[1][2] = rows[1][2], rows[0][2]
    renew(case.table)


@THEME.forgery("an output under another name", cpp=refused("rejected unreadable"))
def _(case: Case) -> None:
    rows = case.table["program"]["outputs"]
    rows[0][0] = "brisker"
    renew(case.table)


@THEME.forgery("an output of another shape", cpp=refused("rejected unreadable"))
def _(case: Case) -> None:
    case.table["program"]["outputs"][0][1] = [2]


@THEME.forgery("an operation changed", cpp=true(), alone=LOOSE, bounded=True)
def _(case: Case) -> None:
    program = program_of(case.table)
    rows = list(program.operations)
    place = max(k for k, row in enumerate(rows) if row.kind in ("add", "sub"))
    rows[place] = replace(rows[place], kind={"add": "sub", "sub": "add"}[rows[place].kind])
    put(case.table, replace(program, operations=tuple(rows)))


@THEME.forgery("an operation changed under the old hash", cpp=REJECTED, alone=REJECTED)
def _(case: Case) -> None:
    rows = case.table["program"]["operations"]
    row = next(row for row in rows if row[0] == "add")
    row[0] = "sub"


@THEME.forgery("a constant added that nothing reads", cpp=true(), alone=LOOSE)
def _(case: Case) -> None:
    put(case.table, shifted(program_of(case.table), [Constant(None, np.ones(3))]))


@THEME.forgery("an output added that nothing is said of", cpp=UNTRUE, alone=LOOSE)
def _(case: Case) -> None:
    more_outputs(case.table, {"upright": "tall"})


@THEME.forgery("the hash of nothing", cpp=REJECTED, alone=REJECTED)
def _(case: Case) -> None:
    case.table["program_hash"] = "0" * 64


@THEME.forgery(
    "a statement of an output that is exchanged with a stronger one",
    cpp=true(),
    alone=LOOSE,
    bounded=True,
)
def _(case: Case) -> None:
    """What is said of the slow condition is proved of the other."""
    statement_of(case.table, "brisk")
    program = program_of(case.table)
    (strong,) = [row.value for row in program.outputs if row.name == "tall"]
    outputs = tuple(replace(row, value=strong) for row in program.outputs)
    put(case.table, replace(program, outputs=outputs))
