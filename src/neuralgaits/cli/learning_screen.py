"""What was learned from logs, as tables for a person, on stdout."""

from collections.abc import Mapping
from typing import Any

from rich.console import Console
from rich.table import Table
from rich.text import Text

_LANDINGS = (
    ("z1_m", "hip position z1", "m"),
    ("z2_kg_m2_s", "momentum z2", "kg m²/s"),
    ("output_rad", "outputs", "rad"),
    ("rate_rad_s", "output rates", "rad/s"),
)


def show_fit(result: Mapping[str, Any]) -> None:
    """Errors with and without the residual, at touchdowns too, and what was used."""
    learned, nominal = result["heldout_error"], result["nominal_heldout_error"]
    share = f"{100.0 * learned / nominal:.3g} %" if nominal else "all"
    better = learned < nominal
    verdict = Text("learned" if better else "not learned", "green" if better else "red")
    _print(Text.assemble(verdict, f": {share} of the model's error is left on held-out strides"))
    table = _table("error over 0.1 s, in steps and momenta", "model", "learned", "best table")
    table.add_row(
        "learned from", _number(result["nominal_train_error"]), _number(result["train_error"]), ""
    )
    floor = _number(result["binned_floor"])
    table.add_row("held out", _number(nominal), _number(learned), floor)
    _print(table)
    _landings(result["touchdowns"])
    bounds = ("what dz may still be off by", "error_bound"), ("largest residual", "bound")
    table = _table("", "m/s", "N m")
    for label, name in bounds:
        table.add_row(label, *(_number(value) for value in result[name]))
    _print(table)
    strides = ", ".join(f"{count} {name}" for name, count in result["strides"].items())
    out = ", ".join(f"{count} {reason}" for reason, count in result["left_out"].items() if count)
    facts = _table("", "")
    facts.show_header = False
    facts.add_row("used", f"{result['walked_s']:.1f} s of walking, strides: {strides}")
    facts.add_row("rows left out", out or "none")
    facts.add_row("time", f"{result['wall_s']:.0f} s")
    facts.add_row("residual", result["residual"])
    facts.add_row("next", f"neuralgaits refine {result['run']}")
    _print(facts)


def _landings(touchdowns: Mapping[str, Any]) -> None:
    """What the residual of the flow cannot see."""
    before, after = touchdowns["before"], touchdowns["after"]
    if before is None:
        return
    head = f"error at {touchdowns['count']} held-out touchdowns"
    table = _table(head, "model", "learned")
    for name, label, unit in _LANDINGS:
        corrected = "-" if after is None else f"{_number(after[name])} {unit}"
        table.add_row(label, f"{_number(before[name])} {unit}", corrected)
    _print(table)


def _print(item: Table | Text) -> None:
    Console(highlight=False).print(item)


def _table(*head: str) -> Table:
    return Table(*head, box=None, pad_edge=False, header_style="bold")


def _number(value: float) -> str:
    return f"{value:.3g}"
