"""A robot's own log files, with a file that says what their columns are: see `column_file`.

What a file of the project's own format holds besides is computed: the leg that stands from the
contacts, rates from angles, z from both, desired outputs from the policy that walked.
"""

from difflib import get_close_matches
from typing import NamedTuple

import numpy as np

from neuralgaits._types import Float, Int
from neuralgaits.errors import InputError
from neuralgaits.gait import AbstractPolicy
from neuralgaits.logs.checks import check_times
from neuralgaits.logs.column_file import PAGE, ColumnFile, Source, joints_of
from neuralgaits.logs.contacts import UNKNOWN, loaded, stance_legs
from neuralgaits.logs.labels import Labels
from neuralgaits.logs.outliers import ANGLE_RAD, stand_out
from neuralgaits.logs.rates import HALF_WINDOW_S, rates
from neuralgaits.logs.sensed import Sensed, States, asked, feet_apart, stance_first, states
from neuralgaits.logs.sheet import REPAIR, Text, sheet_of
from neuralgaits.logs.strides import GAP_PERIODS, GAP_S
from neuralgaits.logs.table import Log
from neuralgaits.robots import PlanarBiped

AGREEING = 0.5
"""Share of rows with one foot on the ground in which it is the one that stands."""


class _Joints(NamedTuple):
    """Quantities of all joints in the signs and zeros of the theory, NaN where the file has none.

    Legs as in the robot file, joints from the lowest up.
    """

    angles: Float[np.ndarray, "k 2 j"]
    rates: Float[np.ndarray, "k 2 j"]
    torques: Float[np.ndarray, "k 2 j"]
    desired: Float[np.ndarray, "k 2 j"]
    desired_rates: Float[np.ndarray, "k 2 j"]


def read(
    text: Text, robot: PlanarBiped, columns: ColumnFile, policy: AbstractPolicy | None
) -> tuple[Log, Labels]:
    """The log of a file with a robot's own columns.

    Args:
        text: of the file.
        robot: the run's own model.
        columns: what its columns are.
        policy: that walked, for desired outputs that the file does not hold.

    Raises: InputError for a column that is not there, for a broken row, for contacts that name no
        leg, and where desired outputs are needed that nobody knows.
    """
    found, rows = _quantities(text, columns)
    source, t = str(text.path), found["time"]
    check_times(t, rows, source, columns.sources["time"].column)
    joints, pitch, dpitch = _joints(found, robot), *_pitch(found, robot)
    contact = np.column_stack(
        [_contact(text, robot, columns, found, rows, foot) for foot in robot.layout.feet]
    )
    stance = stance_legs(robot, t, contact, feet_apart(robot, pitch, joints.angles))
    if np.all(stance == UNKNOWN):
        raise InputError(
            f"log {source}, columns {_both_contacts(robot, columns)}: expected rows in which one "
            "foot alone is on the ground, found none: name each foot's own column in "
            f"{columns.path}, and its sign"
        )
    single = (stance != UNKNOWN) & (contact[:, 0] != contact[:, 1])
    # Exchanged, the swing foot is ahead of its foothold for less than half of a step.
    if np.mean(contact[single, 1] == stance[single]) < AGREEING:
        raise InputError(
            f"log {source}, columns {_both_contacts(robot, columns)}: expected the foot that lands "
            "to be the one in front, found it behind in most rows: exchange the two lines of "
            f"[contact] in {columns.path}, or mend the signs of its angles"
        )
    piece = _pieces(t, stance)
    spoilt = _spoilt(np.column_stack([pitch, _flat(joints.angles)]), piece)
    dpitch = _filled(dpitch[:, None], t, pitch[:, None], piece, spoilt[:, :1])[:, 0]
    shape = joints.angles.shape
    turning = _filled(_flat(joints.rates), t, _flat(joints.angles), piece, spoilt[:, 1:])
    # A piece too short for a rate is a gap like the others.
    good = (stance != UNKNOWN) & np.isfinite(dpitch) & np.isfinite(turning).all(axis=1)
    if not good.any():
        raise InputError(
            f"log {source}: expected at least 3 rows of one stance phase, found none: log faster, "
            f"or mend the contacts in {columns.path}"
        )
    sensed = Sensed(pitch[good], dpitch[good], joints.angles[good], turning.reshape(shape)[good])
    leg, velocity = stance[good], _hip_velocity(found)
    state = states(robot, leg, sensed, None if velocity is None else velocity[good])
    qd, dqd = _desired(text, robot, columns, policy, joints, state, t, piece, leg, good)
    torque = np.nan_to_num(joints.torques[good])
    log = Log(
        t=t[good],
        stance=leg,
        q=state.q,
        dq=state.dq,
        qd=qd,
        dqd=dqd,
        tau=stance_first(robot, leg, torque),
        pitch=sensed.pitch,
        dpitch=sensed.dpitch,
        z=state.z,
        z2_plant=None,
        rows=rows[good],
        joint_names=robot.joint_names,
        source=source,
        computed=_computed(robot, columns),
        torques_logged=columns.has("torques"),
    )
    return log, _labels(robot, columns)


def _flat(by_leg: Float[np.ndarray, "k 2 j"]) -> Float[np.ndarray, "k two_j"]:
    return by_leg.reshape(len(by_leg), -1)


def _quantities(
    text: Text, columns: ColumnFile
) -> tuple[dict[str, Float[np.ndarray, " k"]], Int[np.ndarray, " k"]]:
    """Numbers of every quantity in SI units, by key, and where each row stands in the file."""
    width, wanted = len(text.header), columns.sources
    names = tuple(dict.fromkeys(source.column for source in wanted.values()))
    _check_header(text, columns, names)
    place = [text.header.index(name) for name in names]
    for row, cells in text.cells:
        if len(cells) != width:
            raise InputError(
                f"log {text.path}, row {row}, column {min(len(cells), width) + 1}: expected "
                f"{width} columns, found {len(cells)}: {REPAIR}"
            )
    # Columns that nobody asked for may hold words.
    chosen = [(row, [cells[i] for i in place]) for row, cells in text.cells]
    sheet = sheet_of(Text(text.path, names, chosen), names)
    at = {name: sheet.numbers[:, i] for i, name in enumerate(names)}
    return {key: source.si(at[source.column]) for key, source in wanted.items()}, sheet.rows


def _check_header(text: Text, columns: ColumnFile, names: tuple[str, ...]) -> None:
    missing = [name for name in names if name not in text.header]
    if not text.header or missing:
        near = _like(missing[0], text.header) if missing else []
        found = ", ".join(text.header)[:160] or f"{text.width} columns without names"
        if len(text.header) == 1:
            remedy = "separate columns by commas"
        elif near:
            remedy = f"write {near[0]!r} for {missing[0]!r} in {columns.path}"
        else:
            remedy = f"name columns of the log in {columns.path}"
        raise InputError(
            f"log {text.path}, row 1: expected the columns {', '.join(missing or names)} that "
            f"{columns.path} names, found {found}: {remedy}"
        )
    twice = [name for name in names if text.header.count(name) > 1]
    if twice:
        raise InputError(
            f"log {text.path}, row 1: expected every column once, found {twice[0]} twice: rename "
            "or delete one"
        )


def _like(name: str, header: tuple[str, ...]) -> list[str]:
    """A column that may have been meant, if there is one."""
    same = [cell for cell in header if cell.casefold() == name.casefold()]
    return same[:1] or get_close_matches(name, header, n=1)


def _pitch(
    found: dict[str, Float[np.ndarray, " k"]], robot: PlanarBiped
) -> tuple[Float[np.ndarray, " k"], Float[np.ndarray, " k"]]:
    """Up-angle of the root link, and its rate: NaN if the file has none."""
    layout = robot.layout
    rate = found.get("pitch_rate", np.full(len(found["pitch"]), np.nan))
    return layout.pitch_sign * found["pitch"] + layout.root_angle, layout.pitch_sign * rate


def _joints(found: dict[str, Float[np.ndarray, " k"]], robot: PlanarBiped) -> _Joints:
    layout = robot.layout
    signs, offsets = np.array(layout.leg_joint_signs), np.array(layout.leg_joint_offsets)
    unknown = np.full(len(found["time"]), np.nan)

    def by_leg(table: str) -> Float[np.ndarray, "k 2 j"]:
        columns = [
            [found.get(f"{table}.{name}", unknown) for name in leg] for leg in layout.leg_joints
        ]
        return signs * np.moveaxis(np.array(columns), -1, 0)

    return _Joints(
        angles=by_leg("joints") + offsets,
        rates=by_leg("rates"),
        torques=by_leg("torques"),
        desired=by_leg("desired") + offsets,
        desired_rates=by_leg("desired_rates"),
    )


def _hip_velocity(found: dict[str, Float[np.ndarray, " k"]]) -> Float[np.ndarray, "k 2"] | None:
    if "hip_velocity.x" not in found:
        return None
    return np.column_stack([found["hip_velocity.x"], found["hip_velocity.z"]])


def _contact(
    text: Text,
    robot: PlanarBiped,
    columns: ColumnFile,
    found: dict[str, Float[np.ndarray, " k"]],
    rows: Int[np.ndarray, " k"],
    foot: str,
) -> np.ndarray:
    """Whether a foot is on the ground. [k]."""
    source = columns.sources[f"contact.{foot}"]
    value = found[source.key]
    if source.factor is not None:
        return loaded(robot, value)
    bad = np.flatnonzero((value != 0.0) & (value != 1.0))
    if bad.size:
        raise InputError(
            f"log {text.path}, row {rows[bad[0]]}, column {source.column}: expected 0 or 1, found "
            f'{value[bad[0]]:g}: write unit = "N" for {source.key} in {columns.path} if it is a '
            "force"
        )
    return value == 1.0


def _both_contacts(robot: PlanarBiped, columns: ColumnFile) -> str:
    return " and ".join(columns.sources[f"contact.{foot}"].column for foot in robot.layout.feet)


def _pieces(t: Float[np.ndarray, " k"], stance: Int[np.ndarray, " k"]) -> Int[np.ndarray, " k"]:
    """A number that changes at touchdowns and gaps."""
    steps = np.diff(t)
    gap = steps > max(GAP_PERIODS * float(np.median(steps)), GAP_S)
    return np.concatenate([[0], np.cumsum(gap | (np.diff(stance) != 0))])


def _spoilt(angles: Float[np.ndarray, "k c"], piece: Int[np.ndarray, " k"]) -> np.ndarray:
    """Glitches of encoders, which would spoil the rates of the rows around them. [k, c]."""
    parts = np.split(angles, np.flatnonzero(np.diff(piece)) + 1)
    return np.concatenate([stand_out(part, ANGLE_RAD) for part in parts])


def _filled(
    given: Float[np.ndarray, "k c"],
    t: Float[np.ndarray, " k"],
    angles: Float[np.ndarray, "k c"],
    piece: Int[np.ndarray, " k"],
    spoilt: np.ndarray,
) -> Float[np.ndarray, "k c"]:
    """Rates of a file, and of the angles for columns that it has none of."""
    absent = np.isnan(given).all(axis=0)
    filled = given.copy()
    if absent.any():
        filled[:, absent] = rates(t, angles[:, absent], piece, spoilt[:, absent])
    return filled


def _desired(
    text: Text,
    robot: PlanarBiped,
    columns: ColumnFile,
    policy: AbstractPolicy | None,
    joints: _Joints,
    state: States,
    t: Float[np.ndarray, " k"],
    piece: Int[np.ndarray, " k"],
    leg: Int[np.ndarray, " g"],
    good: np.ndarray,
) -> tuple[Float[np.ndarray, "g m"], Float[np.ndarray, "g m"]]:
    """Desired outputs and their rates in the rows that are good."""
    if columns.has("desired"):
        angles = _flat(joints.desired)
        sharp = np.zeros(angles.shape, dtype=bool)
        turning = _filled(_flat(joints.desired_rates), t, angles, piece, sharp)
        turning = turning.reshape(joints.desired.shape)
        given = (stance_first(robot, leg, part[good]) for part in (joints.desired, turning))
        return next(given), next(given)
    if policy is None or policy.step is not None:
        why = "no policy is given" if policy is None else "its policy is told commands"
        raise InputError(
            f"log {text.path}: expected desired joint angles, found no table [desired] in "
            f"{columns.path}, and {why}: name their columns there; see {PAGE}"
        )
    return asked(robot, policy, state)


def _computed(robot: PlanarBiped, columns: ColumnFile) -> tuple[str, ...]:
    """What the file does not hold, in words."""
    window = f"{2e3 * HALF_WINDOW_S:g} ms"
    found = ["stance leg from the contacts"]
    slow = [name for name in joints_of(robot) if f"rates.{name}" not in columns.sources]
    slow += [] if columns.has("pitch_rate") else ["pitch"]
    if slow:
        found.append(f"rates of {', '.join(slow)} by parabolas over {window}")
    foot = "with" if columns.has("hip_velocity") else "without"
    found.append(f"z from angles and rates, {foot} the speed of the stance foot")
    if not columns.has("desired"):
        found.append("desired outputs and rates from the run's policy at that z")
    elif not columns.has("desired_rates"):
        found.append(f"rates of desired outputs by parabolas over {window}")
    if not columns.has("torques"):
        found.append("no torques: nothing is said of them")
    return tuple(found)


def _labels(robot: PlanarBiped, columns: ColumnFile) -> Labels:
    """What quantities are called in the log."""
    first, second = robot.layout.leg_joints

    def said(table: str, joint: str) -> str:
        source: Source | None = columns.sources.get(f"{table}.{joint}")
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
        if robot.torso is None:
            orders = [(*order[: len(first)], *order[len(first) + 1 :]) for order in orders]
        for i, joint in enumerate(robot.joint_names[1:]):
            labels[f"{prefix}_{joint}"] = (said(table, orders[0][i]), said(table, orders[1][i]))
    pitch = columns.sources["pitch"].column
    rate = columns.sources.get("pitch_rate")
    dpitch = f"{pitch} (its rate)" if rate is None else rate.column
    contacts = _both_contacts(robot, columns)
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
