"""Result of `fit --joints` as tables for a person, on stdout."""

import math
import statistics
from typing import Any

from rich.text import Text

from neuralgaits.cli.screen_tables import show_facts, show_sentence, show_table
from neuralgaits.records.identified_joints import Estimate, IdentifiedJoints
from neuralgaits.robots.parameter_box import MOST_SHARE
from neuralgaits.runs.shell_words import command, named


def show_joints(result: IdentifiedJoints) -> None:
    """Show the numbers of every joint with intervals, and where to go with them."""
    verdict = Text("identified", "green") if result.better else Text("not identified", "red")
    errors = zip(*((one.nominal_error_nm, one.error_nm) for one in result.joints), strict=True)
    file, identified = (math.sqrt(statistics.fmean(e**2 for e in some)) for some in errors)
    show_sentence(
        verdict,
        f": torques of held-out strides are explained to {identified:.3g} N m rms, by the robot "
        f"file to {file:.3g} N m",
    )
    quantities = (
        ("friction_nm", "dry friction", "N m"),
        ("damping_nms_rad", "viscous friction", "N m s/rad"),
        ("armature_kg_m2", "rotor inertia", "kg m²"),
        ("delay_s", "torque delay", "s"),
    )
    for joint in result.joints:
        rows = []
        for field, what, unit in quantities:
            one: Estimate = getattr(joint, field)
            interval = f"{one.low:.4f} to {one.high:.4f}"
            rows.append((f"{what} [{unit}]", f"{one.value:.4f}", interval, f"{one.file:.4f}"))
        show_table((", ".join(joint.names), "from logs", "95 % interval", "file"), rows)
    out = ", ".join(f"{count} {reason}" for reason, count in result.left_out.items() if count)
    strides = f"{result.strides} strides, {result.heldout_strides} more held out"
    show_facts(
        [
            ("used", f"{result.walked_s:.1f} s of walking, {strides}"),
            ("rows left out", out or "none"),
            *(("computed", what) for what in result.computed),
            *_boxes(result),
            ("file", result.file),
            *([] if result.written is None else [("robot file", result.written)]),
        ]
    )


def _boxes(result: IdentifiedJoints) -> list[tuple[str, Any]]:
    """Return lines about boxes of rotor inertias that hold all intervals."""
    rows: list[tuple[str, Any]] = []
    if (half := result.rotor_of_file) is not None and half <= MOST_SHARE:
        box = f"rotor={100.0 * half:.3g}%"
        rows.append(("rotors", command("certify", named(result.run), "--parameters", box)))
    if result.written is not None and (half := result.rotor_of_estimates) is not None:
        rows.append(("around new file", f"rotor={100.0 * half:.3g}%"))
    return rows
