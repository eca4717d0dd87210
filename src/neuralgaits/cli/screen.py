"""Results as tables for a person, on stdout."""

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from rich.console import Console
from rich.table import Table
from rich.text import Text

Result = Mapping[str, Any]


def show_training(result: Result) -> None:
    """The run, its loss, and how far each condition is from holding on fresh samples."""
    rows = [
        (name, _number(entry["mean_violation"]), _number(entry["max_violation"]))
        for name, entry in result["conditions"].items()
    ]
    _print(_table(("condition", "mean violation", "max violation"), rows))
    _facts(result, ("run", "robot", "spec", "seed", "steps", "loss"))
    _facts(result, ("compile_s", "train_s", "wall_s"))


def show_walks(result: Result) -> None:
    """How far each episode came, and the gait's figures."""
    walks, falls = result["steps_walked"], result["fell"]
    stayed = len(falls) - sum(bool(fell) for fell in falls)
    lowest, highest = (min(walks), max(walks)) if walks else (0, 0)
    span = f"{lowest}" if lowest == highest else f"{lowest} to {highest}"
    verdict = Text("walks", "green") if stayed == len(falls) else Text("falls", "red")
    _print(Text.assemble(verdict, f": {stayed} of {len(falls)} episodes stayed up, {span} steps"))
    rows = [
        (name, _number(value))
        for name, value in _flat(result)
        if name not in ("steps_walked", "fell")
    ]
    _print(_table(("figure", "value"), rows))


def show_robot(result: Result) -> None:
    """Links, actuators and the whole."""
    _print(
        _table(
            ("link", "length m", "inertia kg m²"),
            [
                (link["name"], _number(link["length_m"]), _number(link["inertia_kg_m2"]))
                for link in result["links"]
            ],
        )
    )
    columns = ("torque_limit_nm", "lower_rad", "upper_rad", "armature_kg_m2", "damping_nms_rad")
    _print(
        _table(
            (
                "actuated joint",
                "torque N m",
                "from rad",
                "to rad",
                "armature kg m²",
                "damping N m s",
            ),
            [
                (motor["joint"], *(_number(motor[column]) for column in columns))
                for motor in result["actuators"]
            ],
        )
    )
    _facts(result, [name for name in result if name not in ("links", "actuators")])


def show_names(result: Result) -> None:
    """Built-in robots and specs with a line about each."""
    for kind in ("robots", "specs"):
        rows = [(entry["name"], entry["about"]) for entry in result[kind]]
        _print(_table((kind[:-1], "about"), rows))


def show_findings(result: Result) -> None:
    """What was looked at on this machine, and the line that mends it."""
    rows = []
    for name, finding in result.items():
        if isinstance(finding, Mapping):
            bad = Text("missing", "red") if finding["needed"] else Text("optional", "yellow")
            state = Text("ok", "green") if finding["ok"] else bad
            rows.append((name, state, finding["found"], finding["fix"] or ""))
    _print(_table(("what", "state", "found", "fix"), rows))


def _print(item: Table | Text) -> None:
    Console(highlight=False).print(item)


def _table(head: Sequence[str], rows: Iterable[Sequence[str | Text]]) -> Table:
    table = Table(*head, box=None, pad_edge=False, header_style="bold")
    for row in rows:
        table.add_row(*(cell if isinstance(cell, Text) else Text(cell) for cell in row))
    return table


def _facts(result: Result, names: Iterable[str]) -> None:
    table = _table(("", ""), [(name, _number(result[name])) for name in names if name in result])
    table.show_header = False
    _print(table)


def _flat(result: Result, prefix: str = "") -> Iterable[tuple[str, Any]]:
    for name, value in result.items():
        if isinstance(value, Mapping):
            yield from _flat(value, f"{prefix}{name}.")
        else:
            yield f"{prefix}{name}", value


def _number(value: Any) -> str:
    if isinstance(value, float):
        return f"{value:.4g}"
    if isinstance(value, list | tuple):
        return ", ".join(_number(item) for item in value)
    return "-" if value is None else str(value)
