"""Forgeries of proofs about bipeds in three dimensions, and the true file they start from."""

import copy
import json
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from neuralgaits.certificate.proof_file.proof_from_run import proof_of
from neuralgaits.certificate.proof_file.writer import prove
from neuralgaits.certificate.search.root_turns import explore
from neuralgaits.programs import Program
from neuralgaits.records.certified import PROOF
from neuralgaits.systems.family_certificate import condition_problems
from neuralgaits.systems.family_run import FamilyRun
from neuralgaits.systems.proof_model import model_data
from neuralgaits.systems.walker3d.spatial_levels import TABLE
from support.forgeries.base import Case, Table, Theme
from support.forgeries.edits import (
    claim,
    first,
    number,
    program_of,
    put,
    sha256,
    statement_of,
    without,
)
from support.forgeries.systems import OF_ANY, Subject

THEME = Theme("space")
QUICK = ("chart", "clearance", "touchdown", "approach")
"""Conditions of few boxes, which are searched for the true file."""
SUBJECT = Subject(
    "space",
    "touchdown",
    lambda t: t["model"]["robot"],
    "thigh.mass",
    "policy.landing",
    1,
    family=True,
)
_NEGATED = "an operation that is another, under the hash before"
for _what, _change in OF_ANY:
    if _what == _NEGATED:  # It is this one here already.
        continue
    THEME.forgery(_what)(partial(lambda case, change: change(case, SUBJECT), change=_change))


def write_proof(run: FamilyRun, program: Program) -> None:
    """Write a proof of all conditions beside a run: of most of them one leaf, a bound of 0.001.

    These are true, but not of one leaf: tests take them as checked.
    """
    problems = [one for one in condition_problems(program, TABLE, 0.4) if one.names[0] in QUICK]
    states = explore(problems, [None] * len(problems), lambda *_: None)
    searched = tuple(one for pair in zip(problems, states, strict=True) for one in prove(*pair))
    model = model_data(run, program)
    table = json.loads(proof_of(run.folder, program, searched, model, TABLE.chart).content())
    for name, region in TABLE.conditions.items():
        if name not in QUICK:
            for box in table["model"]["regions"][region]:
                told = claim(name, copy.deepcopy(box), region=region, bound=0.001)
                table["statements"].append(told)
    (run.path / PROOF).parent.mkdir(exist_ok=True)
    (run.path / PROOF).write_text(json.dumps(table))


def _kind(what: str) -> Callable[[Callable[[Table], Any]], None]:
    """Register a change of the table."""

    def register(change: Callable[[Table], Any]) -> None:
        @THEME.forgery(what)
        def _(case: Case) -> None:
            change(case.table)

    return register


def _replaced(table: Table, old: float, new: float) -> None:
    """Change an unnamed number of the Program, wherever it stands."""
    program = program_of(table)
    rows, found = [], False
    for row in program.constants:
        hits = (row.name is None) & np.isclose(row.array, old, rtol=1e-12, atol=0.0)
        found |= bool(np.any(hits))
        rows.append(type(row)(row.name, np.where(hits, new, row.array)))
    assert found, old
    put(table, replace(program, constants=tuple(rows)))


def _tube(table: Table, name: str, change: Callable[[float], float]) -> None:
    """Change the first numbers of the tube, in the model."""
    values = table["model"]["tube"][name]["values"]
    values[:9] = [change(float.fromhex(value)).hex() for value in values[:9]]


@_kind("a tube half as wide again")
def _(table: Table) -> None:
    _tube(table, "axes", lambda x: 1.5 * x)


@_kind("a tube beside its place")
def _(table: Table) -> None:
    _tube(table, "centre", lambda x: x + 1e-4)


@_kind("a number of the policy, in the model alone")
def _(table: Table) -> None:
    values = table["model"]["policy"]["pitch"]["values"]
    values[0] = number(values[0], 1.001)


@_kind("a policy's number in model and Program")
def _(table: Table) -> None:
    values = table["model"]["policy"]["ends"]["values"]
    old = float.fromhex(values[0])
    values[0] = (1.001 * old).hex()
    _replaced(table, old, 1.001 * old)


@_kind("a sum in place of a difference, under the hash before")
def _(table: Table) -> None:
    rows = table["program"]["operations"]
    next(row for row in rows if row[0] == "sub")[0] = "add"


@_kind("two outputs of the Program swapped")
def _(table: Table) -> None:
    program = program_of(table)
    rows = {row.name: row for row in program.outputs}
    one, other = rows["inward"], rows["inlet"]
    swapped = {
        "inward": type(one)("inward", one.shape, other.value),
        "inlet": type(one)("inlet", one.shape, one.value),
    }
    outputs = tuple(swapped.get(row.name, row) for row in program.outputs)
    put(table, replace(program, outputs=outputs))


@_kind("no exponent of convergence")
def _(table: Table) -> None:
    _replaced(table, 0.02, 1e-9)


@_kind("a lower normal force")
def _(table: Table) -> None:
    _replaced(table, 0.3, 1e-9)


@_kind("a slower hip")
def _(table: Table) -> None:
    _replaced(table, 0.2, 1e-9)


@_kind("a foot that may be below the floor")
def _(table: Table) -> None:
    _replaced(table, 0.01, -0.01)


@_kind("one end of the radius alone")
def _(table: Table) -> None:
    table["statements"].remove(statement_of(table, "inward"))


@_kind("one end of the radius twice, in the model, too")
def _(table: Table) -> None:
    boxes = table["model"]["regions"]["surface"]
    boxes[1] = copy.deepcopy(boxes[0])
    for statement in table["statements"]:
        if "inward" in statement["conditions"]:
            statement["root"] = copy.deepcopy(boxes[0])


@_kind("a region that is missing")
def _(table: Table) -> None:
    table["model"]["regions"].pop("touchdown")


@_kind("a region more")
def _(table: Table) -> None:
    regions = table["model"]["regions"]
    regions["everywhere"] = copy.deepcopy(regions["tube"])


@_kind("the surface's condition on the middle line")
def _(table: Table) -> None:
    table["model"]["conditions"]["inward"]["region"] = "middle line"
    table["statements"].remove(statement_of(table, "inward"))
    told = statement_of(table, "inward")
    told["region"] = "middle line"
    told["root"] = copy.deepcopy(table["model"]["regions"]["middle line"][0])


@_kind("an empty face: half a chart of no width")
def _(table: Table) -> None:
    for statement in table["statements"]:
        if "friction" in statement["conditions"]:
            statement["root"]["high"] = list(statement["root"]["low"])


@_kind("a scale of nearly nothing")
def _(table: Table) -> None:
    first(table, "inward")["scales"]["inward"] = 1e-9
    table["model"]["conditions"]["inward"]["scale"] = 1e-9


@_kind("a kind of condition that is another")
def _(table: Table) -> None:
    table["model"]["conditions"]["inward"]["kind"] = "Pointwise"


@_kind("a bound that is no number")
def _(table: Table) -> None:
    first(table, "closer")["bounds"]["closer"] = float("nan")


@_kind("a bound beyond all numbers")
def _(table: Table) -> None:
    first(table, "closer")["bounds"]["closer"] = float("inf")


@_kind("a bound below 0 where it must be above")
def _(table: Table) -> None:
    for statement in table["statements"]:
        if "closer" in statement["conditions"]:
            statement["bounds"]["closer"] = -0.001


@_kind("a number of the robot beyond all numbers")
def _(table: Table) -> None:
    table["model"]["robot"]["hip_width"] = "0x1p+1023"


@_kind("Taylor models of a huge degree")
def _(table: Table) -> None:
    first(table, "clearance")["degree"] = 10**6


@_kind("a level that this family has not")
def _(table: Table) -> None:
    table["theorems"] = [*(table.get("theorems") or []), {"level": 4, "parameters": {}}]


@_kind("less gravity")
def _(table: Table) -> None:
    table["model"]["robot"]["gravity"] = (1.62).hex()


@_kind("more friction")
def _(table: Table) -> None:
    table["model"]["robot"]["friction"] = (1.0).hex()


@_kind("stronger motors")
def _(table: Table) -> None:
    robot = table["model"]["robot"]
    name = next(key for key in robot if key.startswith("torque_limits"))
    robot[name] = number(robot[name], 2.0)


@_kind("two axes that change their names")
def _(table: Table) -> None:
    third, fourth = table["chart"][2], table["chart"][3]
    third["name"], fourth["name"] = fourth["name"], third["name"]


@_kind("a cart-pole's name")
def _(table: Table) -> None:
    table["model"]["family"] = "cartpole"


@_kind("other words for the spec")
def _(table: Table) -> None:
    table["spec"] = {"name": "walking for ever"}


@_kind("all of level 3's conditions left out")
def _(table: Table) -> None:
    without(table, ["closer", "approach"])
    for name in ("closer", "approach"):
        table["model"]["conditions"].pop(name)


def _of_run(what: str, file: str) -> Callable[[Callable[[bytes], bytes]], None]:
    """Register a change of a file of the run, its name in the config known."""

    def register(change: Callable[[bytes], bytes]) -> None:
        @THEME.forgery(what)
        def _(case: Case) -> None:
            place = Path(case.folder()) / file
            content = change(place.read_bytes())
            assert content != place.read_bytes(), what
            place.write_bytes(content)
            config = case.run / "config.json"
            known = json.loads(config.read_text())
            if file in known.get("copies", {}):
                known["copies"][file] = sha256(content)
                config.write_text(json.dumps(known))

    return register


_of_run("a run whose torso is heavier", "robot.xml")(
    lambda b: b.replace(b'mass="14"', b'mass="15"')
)
_of_run("a run with a byte of its weights changed", "policy.safetensors")(
    lambda b: b[:-3] + bytes([b[-3] ^ 1]) + b[-2:]
)
