"""Names of a robot's own log quantities for messages, and notes on the computed ones."""

from neuralgaits.logs.formats.column_file import ColumnFile, ColumnSource, joints_of
from neuralgaits.logs.labels import Labels
from neuralgaits.logs.rates import HALF_WINDOWS_S
from neuralgaits.robots.robot_file import RobotFile


def both_contacts(robot: RobotFile, columns: ColumnFile) -> str:
    """Return the names of the contact columns of both feet."""
    return " and ".join(columns.sources[f"contact.{foot}"].column for foot in robot.layout.feet)


def computed(robot: RobotFile, columns: ColumnFile) -> tuple[str, ...]:
    """Describe the quantities that the file lacks and that are computed."""
    shortest, longest = HALF_WINDOWS_S
    window = f"{2e3 * shortest:g} to {2e3 * longest:g} ms, as long as the noise asks for"
    sources = ["stance leg from the contacts"]
    slow = [name for name in joints_of(robot) if f"rates.{name}" not in columns.sources]
    slow += [] if columns.has("pitch_rate") else ["pitch"]
    if slow:
        sources.append(f"rates of {', '.join(slow)} by parabolas over {window}")
    foot = "with" if columns.has("hip_velocity") else "without"
    sources.append(f"z from angles and rates, {foot} the speed of the stance foot")
    if not columns.has("desired"):
        sources.append("desired outputs and rates from the run's policy at that z")
    elif not columns.has("desired_rates"):
        sources.append(f"rates of desired outputs by parabolas over {window}")
    if not columns.has("torques"):
        sources.append("no torques: nothing is said of them")
    return tuple(sources)


def labels_of(robot: RobotFile, columns: ColumnFile) -> Labels:
    """Return the log's names of the quantities."""
    first, second = robot.layout.leg_joints

    def described(table: str, joint: str) -> str:
        source: ColumnSource | None = columns.sources.get(f"{table}.{joint}")
        if source is not None:
            return source.column
        own = {"rates": "joints", "desired_rates": "desired"}.get(table)
        if own is not None and f"{own}.{joint}" in columns.sources:
            return f"{columns.sources[f'{own}.{joint}'].column} (its rate)"
        return f"{table}.{joint} (computed)"

    labels: dict[str, tuple[str, str]] = {}
    tables = {"q": "joints", "dq": "rates", "qd": "desired", "dqd": "desired_rates"}
    for prefix, table in {**tables, "tau": "torques"}.items():
        orders = [(*own, *reversed(other)) for own, other in ((first, second), (second, first))]
        if not robot.layout.torso:
            orders = [(*order[: len(first)], *order[len(first) + 1 :]) for order in orders]
        for i, joint in enumerate(robot.joint_names[1:]):
            labels[f"{prefix}_{joint}"] = (
                described(table, orders[0][i]),
                described(table, orders[1][i]),
            )
    pitch = columns.sources["pitch"].column
    rate = columns.sources.get("pitch_rate")
    dpitch = f"{pitch} (its rate)" if rate is None else rate.column
    contacts = both_contacts(robot, columns)
    whole = {
        "t": columns.sources["time"].column,
        "stance": contacts,
        "pitch": pitch,
        "dpitch": dpitch,
        f"q_{robot.joint_names[0]}": pitch,
        f"dq_{robot.joint_names[0]}": dpitch,
        "z1": "z1 (computed)",
        "z2": "z2 (computed)",
    }
    return labels | {name: (label, label) for name, label in whole.items()}
