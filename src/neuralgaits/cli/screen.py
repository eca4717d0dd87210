"""Results as tables for a person, on stdout."""

import math
from collections import Counter
from collections.abc import Iterable, Mapping
from typing import Any

from rich.text import Text

from neuralgaits.cli.tables import ROWS, number, show_facts, show_sentence, show_table, verdict
from neuralgaits.runs.commands import command, named

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
        show_sentence(count, " somewhere on fresh samples")
        worst = sorted(broken.items(), key=lambda item: -item[1]["max_violation"])
        rows = [
            (name, number(entry["mean_violation"]), number(entry["max_violation"]))
            for name, entry in worst
        ]
        show_table(("condition", "mean violation", "max violation"), rows[:ROWS])
        if len(rows) > ROWS:
            show_sentence(f"and {len(rows) - ROWS} more, by {rows[ROWS][2]} at most")
    else:
        show_sentence(Text("trained", "green"), f": {_held(len(conditions))} on fresh samples")
    if result.get("certificate") is not None:
        show_sentence(_proof_of_training(result["certificate"]))
    facts = {name: result[name] for name in ("robot", "spec", "seed", "loss") if name in result}
    facts["time"] = f"{_seconds(result, 'wall_s')}, {_seconds(result, 'compile_s')} compiling"
    facts |= {"run": result["run"], "next": command("simulate", named(result["run"]))}
    show_facts(facts.items())


def _proof_of_training(proof: Result) -> Text:
    """The last certificate of a training, and what it took."""
    repairs = f"{proof['repairs']} repairs of {proof['repair_steps']} steps"
    found = verdict(proof["verdict"])
    if proof["smallest_margin"] is None:
        names = ", ".join(sorted(proof["failing"]))
        return Text.assemble(
            found, f" at level 1 after {repairs}: {proof['open_boxes']} boxes open ({names})"
        )
    margin = f"smallest margin {proof['smallest_margin']:.3g} of its scale"
    return Text.assemble(found, f" at level 1 after {repairs}, {margin}")


def show_walks(result: Result) -> None:
    """How far each episode came, what stopped it, and the gait's figures."""
    walks, falls = result["steps_walked"], result["fell"]
    stayed = len(falls) - sum(bool(fell) for fell in falls)
    lowest, highest = (min(walks), max(walks)) if walks else (0, 0)
    span = f"{lowest}" if lowest == highest else f"{lowest} to {highest}"
    answer = Text("walks", "green") if stayed == len(falls) else Text("falls", "red")
    show_sentence(answer, f": {stayed} of {len(falls)} episodes stayed up, {span} steps")
    rows = [(reason, str(count)) for reason, count in _reasons(result).items()]
    if rows:
        show_table(("fell because", "episodes"), rows)
    flat = dict(_flat(result))
    rows = [
        (label, f"{number(flat[name])} {unit}".rstrip())
        for name, label, unit in _FIGURES
        if flat.get(name) is not None
    ]
    show_table(("figure", "value"), rows)
    if "link" in result:
        _link(result["link"])
    changed = [f"{name}={number(value)}" for name, value in _disturbed(result)]
    asked = {
        name: result.get(name) for name in ("plant", "controller", "engine", "start", "push", "run")
    }
    known = {name: value for name, value in asked.items() if value is not None}
    show_facts((known | ({"disturb": ", ".join(changed)} if changed else {})).items())


def _link(link: Result) -> None:
    """What the connection to a controller process did."""
    trips = link["round_trip_us"] or {"p50": math.nan, "p99": math.nan}
    words = (
        f"{link['law']} in a process of its own, {link['mode']}: {link['ticks']} ticks, "
        f"{link['packets_lost']} of {link['packets_sent']} packets lost, "
        f"{link['packets_late']} late, {link['deadline_misses']} deadlines missed, "
        f"round trip {trips['p50']:.0f} us, p99 {trips['p99']:.0f} us"
    )
    show_sentence(words)


def show_robot(result: Result) -> None:
    """Links, actuators and the whole."""
    show_table(
        ("link", "length m", "inertia kg m²"),
        [
            (link["name"], number(link["length_m"]), number(link["inertia_kg_m2"]))
            for link in result["links"]
        ],
    )
    columns = ("torque_limit_nm", "lower_rad", "upper_rad", "armature_kg_m2", "damping_nms_rad")
    show_table(
        ("actuated joint", "torque N m", "from rad", "to rad", "armature kg m²", "damping N m s"),
        [
            (motor["joint"], *(number(motor[column]) for column in columns))
            for motor in result["actuators"]
        ],
    )
    show_facts(item for item in result.items() if item[0] not in ("links", "actuators"))


def show_names(result: Result) -> None:
    """Built-in robots and specs with a line about each."""
    for kind in ("robots", "specs"):
        rows = [(entry["name"], entry["about"]) for entry in result[kind]]
        show_table((kind[:-1], "about"), rows)


def show_findings(result: Result) -> None:
    """What was looked at on this machine, and the line that mends it."""
    rows = []
    for name, finding in result.items():
        if isinstance(finding, Mapping):
            bad = Text("missing", "red") if finding["needed"] else Text("optional", "yellow")
            state = Text("ok", "green") if finding["ok"] else bad
            rows.append((name, state, finding["found"], finding["fix"] or ""))
    show_table(("what", "state", "found", "fix"), rows)


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
