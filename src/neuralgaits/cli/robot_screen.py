"""Robot files, built-in names and this machine, for a person."""

from pathlib import Path

from rich.text import Text

from neuralgaits.cli.screen_tables import (
    number,
    show_break,
    show_facts,
    show_sentence,
    show_table,
)
from neuralgaits.records.inspected import RobotFacts
from neuralgaits.records.installed import BuiltIn, Machine
from neuralgaits.runs.shell_words import command


def show_robot(result: RobotFacts) -> None:
    """Show links, joints by both names, actuators and overall properties."""
    show_table(
        ("link", "your body", "length m", "mass kg", "centre of mass m", "inertia kg m²"),
        [
            (
                link.name,
                link.body,
                number(link.length_m),
                number(link.mass_kg),
                _centre(link.centre_of_mass_m),
                number(link.inertia_kg_m2),
            )
            for link in result.links
        ],
    )
    show_break()
    show_table(
        ("actuated joint", "your joint", "your motor"),
        [(motor.joint, motor.file_joint, motor.file_motor) for motor in result.actuators],
    )
    columns = {
        "torque N m": "torque_limit_nm",
        "from rad": "lower_rad",
        "to rad": "upper_rad",
        "armature kg m²": "armature_kg_m2",
        "damping N m s/rad": "damping_nms_rad",
    }
    show_break()
    show_table(
        ("actuated joint", *columns),
        [
            (motor.joint, *(number(getattr(motor, column)) for column in columns.values()))
            for motor in result.actuators
        ],
    )
    show_break()
    show_facts(_robot_facts(result))
    for line in result.left_out:
        show_sentence(Text("left out", "yellow"), f": {line}")
    for line in result.warnings:
        show_sentence(Text("warning", "yellow"), f": {line}")


def show_inspected(result: RobotFacts, robot: str | Path) -> None:
    """Show a robot of this name or path, that it is understood, and what to do with it."""
    show_robot(result)
    feet = "point feet" if result.flat_feet is None else "flat feet"
    show_facts([("fits", f"a planar biped on {feet}"), ("next", command("train", str(robot)))])


def _robot_facts(result: RobotFacts) -> list[tuple[str, str]]:
    """Return a robot's overall properties in words, with units."""
    torso = "no torso" if result.torso is None else "with a torso"
    above = "the foot's centre" if result.flat_feet is None else "the ankle"
    facts = [
        ("robot", f"{result.robot}, {number(result.mass_kg)} kg, {torso}"),
        ("coordinates", ", ".join(result.coordinates)),
        ("no motor", f"{result.underactuation} of {len(result.coordinates)} coordinates"),
        ("feet", f"stance {result.stance_foot}, swing {result.swing_foot}"),
        ("hips", f"{number(result.hip_height_m)} m above {above} on a straight leg"),
        (
            "floor",
            f"friction {number(result.friction)}, gravity {number(result.gravity_m_s2)} m/s²",
        ),
    ]
    if result.flat_feet is None:
        return [*facts, ("foot radius", f"{number(result.foot_radius_m)} m")]
    feet = result.flat_feet
    sole = f"sole from {number(feet.heel_m)} m behind the ankle to {number(feet.toe_m)} m ahead"
    under = f"{number(feet.ankle_height_m)} m under it, {number(feet.mass_kg)} kg"
    return [*facts, ("flat feet", f"{sole}, {under}")]


def _centre(place: tuple[float, float]) -> str:
    """Format a centre of mass: its distance up the link and, if it is off the line, to the side."""
    up, ahead = place
    if abs(ahead) < 1e-9:
        return number(up)
    return f"{number(up)}, {number(abs(ahead))} {'ahead' if ahead > 0.0 else 'behind'}"


def show_planarised(result: RobotFacts) -> None:
    """Show the changes to a robot file, one on each line, and the robot of the new file."""
    if result.changes:
        show_sentence(
            Text("changed", "yellow"),
            f": {len(result.changes)} thing{'' if len(result.changes) == 1 else 's'}",
        )
        for change in result.changes:
            show_sentence("- ", change, hang=2)
    else:
        show_sentence(Text("nothing to change", "green"), ": the new file is a copy")
    show_robot(result)
    show_facts([("written", result.written), ("next", command("train", str(result.written)))])


def show_written(result: BuiltIn) -> None:
    """Show where a built-in robot was written."""
    facts = [("robot", one.name) for one in result.robots]
    next_line = command("inspect", str(result.written))
    show_facts([*facts, ("written", result.written), ("next", next_line)])


def show_names(result: BuiltIn) -> None:
    """Show the built-in robots and specs with a line about each."""
    for kind, entries in (("robot", result.robots), ("spec", result.specs)):
        if kind == "spec" and entries:
            show_break()
        show_table((kind, "about"), [(entry.name, entry.about) for entry in entries])


def show_findings(result: Machine) -> None:
    """Show the findings about this machine, with a fix for each problem."""
    rows = []
    for name, finding in result.findings.items():
        bad = Text("missing", "red") if finding.needed else Text("optional", "yellow")
        state = Text("ok", "green") if finding.ok else bad
        rows.append((name, state, finding.found, finding.fix or ""))
    show_table(("what", "state", "found", "fix"), rows)
    missing = [name for name, one in result.findings.items() if one.needed and not one.ok]
    optional = sum(not one.needed and not one.ok for one in result.findings.values())
    if missing:
        needed = Text(f"missing: {', '.join(missing)}", "red")
    else:
        needed = Text("everything needed is there", "green")
    parts = f"{optional} optional part{'' if optional == 1 else 's'} missing"
    show_sentence(needed, f"; {parts}" if optional else "")
