"""Results as tables for a person, on stdout."""

import math
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from rich.console import Console
from rich.table import Table
from rich.text import Text

Result = Mapping[str, Any]

_FIGURES = (
    ("speed_m_s", "speed", "m/s"),
    ("step_time_s", "time of a step", "s"),
    ("poincare.step_length_m", "length of a step, model", "m"),
    ("poincare.multiplier", "Poincaré multiplier, model", ""),
    ("cost_of_transport", "mechanical cost of transport", ""),
    ("peak_torque_nm", "largest torque", "N m"),
    ("max_joint_rate_rad_s", "largest joint rate", "rad/s"),
    ("max_output_error_rad", "largest output error", "rad"),
    ("min_normal_force_n", "smallest normal force", "N"),
    ("saturated_fraction", "share of ticks at the torque limit", ""),
    ("real_time_factor", "simulated seconds a second", ""),
)
"""Figures of a walk a person sees, with label and unit; `--json` has all."""


def show_training(result: Result) -> None:
    """Whether the conditions hold on fresh samples, those that do not, and what to do next."""
    conditions = result["conditions"]
    broken = {name: entry for name, entry in conditions.items() if entry["max_violation"] > 0.0}
    if broken:
        count = Text(f"{len(broken)} of {len(conditions)} conditions fail", "yellow")
        _print(Text.assemble(count, " somewhere on fresh samples"))
        worst = sorted(broken.items(), key=lambda item: -item[1]["max_violation"])
        rows = [
            (name, _number(entry["mean_violation"]), _number(entry["max_violation"]))
            for name, entry in worst
        ]
        _print(_table(("condition", "mean violation", "max violation"), rows))
    else:
        _print(
            Text.assemble(Text("trained", "green"), f": {_held(len(conditions))} on fresh samples")
        )
    if result.get("certificate") is not None:
        _print(_proof_of_training(result["certificate"]))
    _facts(result, ("robot", "spec", "seed", "loss"))
    spent = {"time": f"{_seconds(result, 'wall_s')}, {_seconds(result, 'compile_s')} compiling"}
    walk = f"neuralgaits simulate {result['run']}"
    _facts(spent | {"run": result["run"], "next": walk}, ("time", "run", "next"))


def _proof_of_training(proof: Result) -> Text:
    """The last certificate of a training, and what it took."""
    repairs = f"{proof['repairs']} repairs of {proof['repair_steps']} steps"
    verdict = Text(proof["verdict"], _COLOURS[proof["verdict"]])
    if proof["smallest_margin"] is None:
        names = ", ".join(sorted(proof["failing"]))
        return Text.assemble(
            verdict, f" at level 1 after {repairs}: {proof['open_boxes']} boxes open ({names})"
        )
    margin = f"smallest margin {proof['smallest_margin']:.3g} of its scale"
    return Text.assemble(verdict, f" at level 1 after {repairs}, {margin}")


def show_walks(result: Result) -> None:
    """How far each episode came, what stopped it, and the gait's figures."""
    walks, falls = result["steps_walked"], result["fell"]
    stayed = len(falls) - sum(bool(fell) for fell in falls)
    lowest, highest = (min(walks), max(walks)) if walks else (0, 0)
    span = f"{lowest}" if lowest == highest else f"{lowest} to {highest}"
    verdict = Text("walks", "green") if stayed == len(falls) else Text("falls", "red")
    _print(Text.assemble(verdict, f": {stayed} of {len(falls)} episodes stayed up, {span} steps"))
    rows = [(reason, str(count)) for reason, count in _reasons(result).items()]
    if rows:
        _print(_table(("fell because", "episodes"), rows))
    flat = dict(_flat(result))
    rows = [
        (label, f"{_number(flat[name])} {unit}".rstrip())
        for name, label, unit in _FIGURES
        if flat.get(name) is not None
    ]
    _print(_table(("figure", "value"), rows))
    if "link" in result:
        _link(result["link"])
    changed = [f"{name}={_number(value)}" for name, value in _disturbed(result)]
    asked = {name: result.get(name) for name in ("plant", "controller", "start", "push", "run")}
    known = {name: value for name, value in asked.items() if value is not None}
    _facts(known | ({"disturb": ", ".join(changed)} if changed else {}), (*asked, "disturb"))


def _link(link: Result) -> None:
    """What the connection to a controller process did."""
    trips = link["round_trip_us"] or {"p50": math.nan, "p99": math.nan}
    words = (
        f"{link['law']} in a process of its own, {link['mode']}: {link['ticks']} ticks, "
        f"{link['packets_lost']} of {link['packets_sent']} packets lost, "
        f"{link['packets_late']} late, {link['deadline_misses']} deadlines missed, "
        f"round trip {trips['p50']:.0f} us, p99 {trips['p99']:.0f} us"
    )
    _print(Text(words))


_COLOURS = {"proved": "green", "refuted": "red", "rejected": "red", "undecided": "yellow"}


def show_proof(result: Result) -> None:
    """The verdict on each condition, with its margin (in scales) or the state that breaks it."""
    rows = []
    for name, entry in result["conditions"].items():
        point, detail = entry["counterexample"], ""
        if point is not None:
            detail = f"{point['margin']:.3g} at z = ({point['z'][0]:.6g}, {point['z'][1]:.6g})"
        elif entry["verdict"] == "undecided":
            detail = f"{entry['undecided_boxes']} boxes left"
        # Rounded down: less than everything never reads as everything.
        share = f"{math.floor(1e4 * entry['proved_fraction']) / 100:g} %"
        verdict = Text(entry["verdict"], _COLOURS[entry["verdict"]])
        margin, boxes = _number(entry["margin"]), _number(entry["boxes"])
        rows.append((name, verdict, share, margin, boxes, detail))
    head = ("condition", "verdict", "proved", "margin", "boxes", "")
    _print(_table(head, rows))
    _levels(result)
    reason = f": {result['reason']}" if result.get("reason") else ""
    verdict = Text(result["verdict"], _COLOURS[result["verdict"]])
    _print(Text.assemble(verdict, f" at level {result['level']}{reason}"))
    facts = {"boxes": result["boxes"], "time": _seconds(result, "wall_s")}
    facts |= {name: result.get(name) for name in ("proof", "map")}
    if "full_order_proof" in result:
        facts["proof of level 4"] = result["full_order_proof"]
    _facts(facts, facts)


def show_check(result: Result) -> None:
    """The verdict and why, what the file claims, and what the claim rests on."""
    colour = _COLOURS[result["verdict"]]
    reason = f": {result['reason']}" if result["reason"] else ""
    _print(Text.assemble(Text(result["verdict"], colour), reason))
    weights = f"weights of sha256 {result['weights_sha256'][:12]}..."
    _print(Text(f"claims for {result['robot']}, spec {result['spec']}, {weights}"))
    for statement in result["statements"]:
        _print(Text(f"  {statement}"))
    _levels(result)
    if result["unclaimed"]:
        _print(Text(f"not claimed: {', '.join(result['unclaimed'])}"))
    _print(Text("assuming that"))
    for assumption in result["assumptions"]:
        _print(Text(f"  {assumption}"))
    _facts({"boxes": result["boxes"], "time": _seconds(result, "wall_s")}, ("boxes", "time"))


def _levels(result: Result) -> None:
    """What was concluded about trajectories, sentence by sentence."""
    for level in result["levels"]:
        verdict = Text(level["verdict"], _COLOURS[level["verdict"]])
        reason = f": {level['reason']}" if level["reason"] else ""
        _print(Text.assemble(f"level {level['level']} ", verdict, reason))
        for sentence in level["words"]:
            _print(Text(f"  {sentence}"))
        rows = [
            (one["name"], _number(one["value"]), one["unit"], one["meaning"])
            for one in level["constants"]
        ]
        if rows:
            _print(_table(("constant", "value", "unit", "meaning"), rows))


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


def _held(count: int) -> str:
    return "its condition holds" if count == 1 else f"all {count} conditions hold"


def _seconds(result: Result, name: str) -> str:
    return f"{result[name]:.0f} s" if name in result else "-"


def _reasons(result: Result) -> Counter[str]:
    """How many episodes fell for each reason."""
    pairs = zip(result["fell"], result.get("fall_reasons", ()), strict=False)
    return Counter(str(reason) for fell, reason in pairs if fell)


def _disturbed(result: Result) -> Iterable[tuple[str, Any]]:
    """The disturbances that are not what they are by default."""
    from neuralgaits.simulation.disturbance import Disturbance

    usual = vars(Disturbance())
    disturb = result.get("disturb") or {}
    return [(name, value) for name, value in disturb.items() if value != usual.get(name)]


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
