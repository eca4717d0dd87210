"""Run folders that are altered in every file at once, each sha256 made anew.

Robot, weights, spec, config, summary and proof agree with each other in their hashes; what none of
them can change is what the run's own files are traced to. Pages, figures and export are asked.
"""

import json
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

import numpy as np
from safetensors.numpy import load_file, save_file

from neuralgaits.barriers import specs
from neuralgaits.robots.mjcf.loader import robot_from_text
from neuralgaits.runs import plain
from neuralgaits.workflows.demo import FOLDER, TOLD
from support.forgeries.base import Answer, Case, Table, Theme, refused
from support.forgeries.edits import constant, constantly, more_outputs, number, put, sha256, without
from support.forgeries.edits import program_of as program_in
from support.forgeries.runs import PROOF, SUMMARY, renew_summary

THEME = Theme("walk")
NOTHING, NO_MORE = refused("none"), refused("none 1 2 3")
"""What a page may show as proved: no level; or no more than is."""
IN_NO_CONDITION = "larger feet", "knees of a smaller range"
"""With these in every file, what is proved is proved of that robot as well."""
CONFIG, ROBOT, WEIGHTS = "config.json", "robot.xml", "policy.safetensors"
Change = Callable[[Any], object]


def renew(folder: Path) -> None:
    """Make every sha256 of a run anew, of whatever lies there now."""
    config, proof = (json.loads((folder / name).read_text()) for name in (CONFIG, PROOF))
    config["copies"] = {n: sha256((folder / n).read_bytes()) for n in config["copies"]}
    proof["robot"]["sha256"] = config["copies"][ROBOT]
    proof["spec"]["sha256"] = config["copies"]["spec.py"]
    proof["weights_sha256"] = sha256((folder / WEIGHTS).read_bytes())
    put(proof, program_in(proof))
    for name, table in ((CONFIG, config), (PROOF, proof)):
        (folder / name).write_text(json.dumps(table))
    renew_summary(folder)


def altered(what: str, answer: Answer = NOTHING, **changes: Any) -> None:
    """Register a run with some of its files changed: `config`, `proof`, `summary`, `robot`."""

    @THEME.forgery(what, cpp=None, alone=None, run=None, report=answer, bounded=True)
    def _(case: Case) -> None:
        folder = case.folder()
        for name, change in changes.items():
            _FILES[name](folder, change)
        renew(folder)


def _json(file: str) -> Callable[[Path, Change], None]:
    def edit(folder: Path, change: Change) -> None:
        table = json.loads((folder / file).read_text())
        change(table)
        (folder / file).write_text(json.dumps(table))

    return edit


def _text(folder: Path, change: Change) -> None:
    text = (folder / ROBOT).read_text()
    other = str(change(text))
    assert other != text
    (folder / ROBOT).write_text(other)


def _tensors(folder: Path, change: Change) -> None:
    arrays = load_file(folder / WEIGHTS)
    change(arrays)
    save_file({n: np.ascontiguousarray(a) for n, a in arrays.items()}, folder / WEIGHTS)


_FILES = {
    "config": _json(CONFIG),
    "proof": _json(PROOF),
    "summary": _json(SUMMARY),
    "robot": _text,
    "weights": _tensors,
}


def _replaced(old: str, new: str) -> Change:
    return lambda text: text.replace(old, new)


def _of_model(part: Iterable[Any], name: str, factor: float) -> Change:
    """A number of the proof's model, so that it is the file's."""

    def change(table: Table) -> None:
        found = table["model"]["robot"]
        for key in part:
            found = found[key]
        found[name] = number(found[name], factor)

    return change


def _described_anew(old: str, new: str) -> Change:
    """The spec as it is for the altered robot."""

    def change(table: Table) -> None:
        text = (FOLDER / ROBOT).read_text().replace(old, new)
        robot = robot_from_text(text, table["robot"])
        table["described"] = plain(specs.load(table["spec"], robot).describe())

    return change


SHIN, THIGH = ("leg", 0), ("leg", 1)
for _what, _old, _new, _part, _name, _factor in (
    ("a heavier torso", 'mass="13"', 'mass="14"', ("torso",), "mass", 14 / 13),
    ("a lighter thigh", 'mass="3.4261"', 'mass="3.0"', THIGH, "mass", 3.0 / 3.4261),
    ("a heavier shin", 'mass="0.85216"', 'mass="0.9"', SHIN, "mass", 0.9 / 0.85216),
    ("a higher torso", "0 0 0.21483", "0 0 0.25", ("torso",), "along", 0.25 / 0.21483),
    ("more inertia", "0.194 0.194 0.194", "0.3 0.3 0.3", ("torso",), "inertia", 0.3 / 0.194),
    ("a longer thigh", "0 0 -0.4064", "0 0 -0.42", THIGH, "length", 0.42 / 0.4064),
    ("lighter rotors", 'armature="0.42632"', 'armature="0.3"', SHIN, "armature", 0.3 / 0.42632),
    ("stronger motors", '"-41 41"', '"-80 80"', SHIN, "torque_limit", 80 / 41),
    ("more gravity", "0 0 -9.81", "0 0 -9.9", (), "gravity", 9.9 / 9.81),
    ("another friction", "0.6 0.005", "0.9 0.005", (), "friction", 1.5),
    ("larger feet", 'size="0.003"', 'size="0.006"', (), "foot_radius", 2.0),
    ("knees of a smaller range", 'range="0 1.5"', 'range="0 1.0"', SHIN, "upper", 1.0 / 1.5),
):  # fmt: skip
    altered(f"{_what}, in the robot file", robot=_replaced(_old, _new))
    altered(
        f"{_what}, in config and model, too",
        NO_MORE if _what in IN_NO_CONDITION else NOTHING,
        robot=_replaced(_old, _new),
        proof=_of_model(_part, _name, _factor),
        config=_described_anew(_old, _new),
    )


def _scaled(name: str, factor: float) -> Change:
    return lambda arrays: arrays.update({name: arrays[name] * factor})


for _array in ("policy.network.weights[2]", "tube.lower", "tube.upper", "policy.cubic"):
    altered(f"other weights, {_array}", weights=_scaled(_array, 1.0 + 1e-9))
for _array in ("policy.network.weights[2]", "tube.lower"):
    altered(
        f"other weights, {_array}, in the Program, too",
        weights=_scaled(_array, 1.1),
        proof=lambda t, name=_array: constant(t, name, lambda values: 1.1 * values),
    )


def _without_condition(name: str, *, also_claimed: bool = True) -> dict[str, Any]:
    """A condition taken out of config, summary, model, Program, statements and theorem."""

    def config(table: Table) -> None:
        rows = table["described"]["conditions"]
        table["described"]["conditions"] = [row for row in rows if row["name"] != name]

    def summary(table: Table) -> None:
        del table["conditions"][name]

    def proof(table: Table) -> None:
        del table["model"]["conditions"][name]
        outputs = table["program"]["outputs"]
        table["program"]["outputs"] = [row for row in outputs if row[0] != name]
        without(table, [name])
        carried = table["theorems"][0]["parameters"]["carried"]
        if also_claimed and name in carried:
            carried.remove(name)

    return {"config": config, "summary": summary, "proof": proof}


for _name in ("knee", "torque-upper", "normal-force", "friction-forward", "foot-clears"):
    altered(f"a spec without {_name}, everywhere", **_without_condition(_name))
altered("a spec without a barrier, everywhere", **_without_condition("torso-upper"))


def _condition(name: str, change: Change) -> dict[str, Any]:
    """A condition's numbers changed in config and model."""

    def config(table: Table) -> None:
        change(next(row for row in table["described"]["conditions"] if row["name"] == name))

    return {"config": config, "proof": lambda t: change(t["model"]["conditions"][name])}


def _set(path: str, value: Any) -> Change:
    def change(row: Table) -> None:
        *outer, last = path.split(".")
        for key in outer:
            row = row[key]
        assert last in row
        row[last] = value

    return change


altered("a softer limit of the torso", **_condition("torso-upper", _set("quantity.bound", 0.5)))
altered("a slower barrier", **_condition("torso-lower", _set("alpha", 100.0)))
altered("a smaller scale", **_condition("knee", _set("scale", 0.01)))
altered("another region", **_condition("knee", _set("region", "guard")))
altered("another kind", **_condition("torso-lower", _set("kind", "Pointwise")))
altered("a config of another spec", config=_set("spec", "rugged"))
altered(
    "a config and proof of another spec",
    config=_set("spec", "rugged"),
    proof=_set("spec.name", "rugged"),
)
altered(
    "a config and proof that call the robot otherwise",
    config=_set("robot", "rabbit"),
    proof=_set("robot.name", "rabbit"),
)
altered("a config of a smaller network", config=_set("hidden", [16, 16]))


def _smaller_region(table: Table) -> None:
    table["described"]["regions"]["tube"][0]["high"] = [0.5, 1.0]


def _smaller_region_too(table: Table) -> None:
    table["model"]["regions"]["tube"][0]["high"] = ["0x1p-1", "0x1p+0"]


altered("a region cut in half in the config", config=_smaller_region)
altered(
    "a region cut in half in config and model", config=_smaller_region, proof=_smaller_region_too
)


def _bounds(change: Callable[[str, float], float]) -> Change:
    def edit(table: Table) -> None:
        for statement in table["statements"]:
            bounds = statement["bounds"]
            for name, bound in bounds.items():
                bounds[name] = change(name, bound)

    return edit


altered("bounds of twice their size", proof=_bounds(lambda name, bound: 2.0 * abs(bound) + 0.1))
altered("one bound of ten times its size",
        proof=_bounds(lambda name, bound: bound * (10.0 if name == "knee" else 1.0)))  # fmt: skip
altered("premises with more to spare",
        proof=_bounds(lambda name, bound: bound + 99.0 * name.startswith("set/")))  # fmt: skip
altered("a better return map",
        proof=_bounds(lambda name, bound: bound + 9.0 * (name == "orbit/gain")))  # fmt: skip


def _trees(text: str) -> Change:
    def edit(table: Table) -> None:
        for statement in table["statements"]:
            statement["tree"] = text

    return edit


altered("trees that end too early", proof=_trees("0-"))
altered("trees that go on", proof=_trees("--------"))
altered("trees along an axis that is none", proof=_trees("5--"))
altered("a Program that says 1", proof=constantly)
altered("a Program with one output more", proof=lambda t: more_outputs(t, {"sure": "knee"}))


def _levels(numbers: list[int]) -> Change:
    def change(table: Table) -> None:
        of = {entry["level"]: entry for entry in table["levels"]}
        table["levels"] = [of.get(n, of[3]) | {"level": n} for n in numbers]

    return change


for _numbers in ([2, 2, 3], [3, 2], [2, 3, 3], [2, 3, 4, 5], [2, 3, 5], [3], [2, 3, 4, 4]):
    altered(f"levels {_numbers} in the summary", summary=_levels(_numbers), answer=NO_MORE)
    altered(
        f"levels {_numbers} in a summary of level 5",
        summary=lambda t, n=_numbers: (_levels(n)(t), t.update(level=5)),
        answer=NO_MORE,
    )
altered("a box of robots in the summary", summary=lambda t: t.update(parameters={"mass": 0.02}))
altered("a floor in the summary", summary=lambda t: t.update(parameters={"floor": 0.01}))
altered(
    "a floor in summary and theorem",
    summary=lambda t: t.update(parameters={"floor": 0.01}),
    proof=lambda t: t["theorems"][0]["parameters"].update(floor=(0.01).hex()),
)
altered("less friction in the summary", summary=lambda t: t.update(parameters={"friction": 0.1}))
altered("ranges in the summary", summary=lambda t: t.update(within={"speed": [0.5, 0.9]}),
        answer=NO_MORE)  # fmt: skip


def _undecided_but_whole(table: Table) -> None:
    table["conditions"]["knee"] |= {"verdict": "undecided", "margin": 9.0}


altered("a condition that is open and proved in part", summary=_undecided_but_whole)


@THEME.forgery("the proof of a gait with commands", cpp=None, alone=None, run=None, report=NOTHING)
def _(case: Case) -> None:
    import gzip

    folder = case.folder()
    proof = json.loads(gzip.decompress((TOLD / f"{PROOF}.gz").read_bytes()))
    (folder / PROOF).write_text(json.dumps(proof))
    renew(folder)
