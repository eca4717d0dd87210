"""Parameters of the two legs, in the coordinates of `PlanarBiped`, checked to be equal."""

from dataclasses import dataclass, fields, replace

import mujoco
import numpy as np

from neuralgaits.robots.derive import LegData
from neuralgaits.robots.mjcf.motors_and_ranges import Motor, read_motor, read_range
from neuralgaits.robots.mjcf.physical_numbers import refuse_large_foot, refuse_quantity
from neuralgaits.robots.mjcf.planar_tree import Joint, PlanarTree
from neuralgaits.robots.mjcf.refuse_or_note import attempt, notes_problems, refuse
from neuralgaits.robots.mjcf.skeleton import Skeleton


@dataclass(frozen=True)
class LegJoint:
    """A leg joint seen both ways: coordinate here = sign * coordinate in the file + offset.

    Attributes:
        joint: joint of the file.
        sign: +1 or -1.
        offset: [rad], in (-pi, pi].
        motor: motor that drives it.
    """

    joint: Joint
    sign: float
    offset: float
    motor: Motor


def link_directions(tree: PlanarTree, skeleton: Skeleton) -> dict[int, tuple[complex, complex]]:
    """Compute the lower end and the direction of each link at zero coordinates.

    A leg link points from its lower joint (or foot centre) to its upper joint. A torso starts at
    the hip and points straight up at zero pitch, wherever its centre of mass lies.

    Returns: for each link, lower end and line to the upper end, x + i z (m). Raises: RobotError if
    a leg link has no length.
    """
    lines = {}
    for leg, foot in zip(skeleton.legs, skeleton.feet, strict=True):
        lower = foot.centre
        for place, index in enumerate(leg):
            upper = (
                skeleton.hip
                if place == len(leg) - 1
                else _joint_anchor(tree, index, leg[place + 1])
            )
            if abs(upper - lower) < 1e-6:  # [m]
                refuse(
                    f"body {tree.links[index].name} has no length: its lower and upper joint (or "
                    "foot) are at one point; move one of them"
                )
            lines[index] = (lower, upper - lower)
            lower = upper
    if skeleton.torso is not None:
        lines[skeleton.torso] = (skeleton.hip, 1j)
    return lines


def _joint_anchor(tree: PlanarTree, lower: int, upper: int) -> complex:
    """Return the anchor of the joint between two neighbouring links, whichever is the parent."""
    child = lower if tree.links[lower].parent == upper else upper
    return tree.links[child].joint.anchor


def up_angle(line: complex) -> float:
    """Up-angle of a line, counter-clockwise from +z. Returns: (rad) in (-pi, pi]."""
    return float(np.angle(line / 1j))


def leg_joints(
    model: mujoco.MjModel,
    tree: PlanarTree,
    skeleton: Skeleton,
    lines: dict[int, tuple[complex, complex]],
) -> tuple[tuple[LegJoint, ...], tuple[LegJoint, ...]]:
    """Return the joints of both legs, lowest first, hip last.

    Raises: RobotError if one is not actuated.
    """
    first, second = skeleton.legs
    ends = (skeleton.torso,) * 2 if skeleton.torso is not None else (second[-1], first[-1])
    return tuple(
        tuple(
            _leg_joint(model, tree, lines, lower, upper)
            for lower, upper in zip(leg, (*leg[1:], end), strict=True)
        )
        for leg, end in zip((first, second), ends, strict=True)
    )  # pyright: ignore[reportReturnType]


def _leg_joint(
    model: mujoco.MjModel,
    tree: PlanarTree,
    lines: dict[int, tuple[complex, complex]],
    lower: int,
    upper: int,
) -> LegJoint:
    """Joint coordinate here: angle of the upper link minus angle of the lower one."""
    lower_is_child = tree.links[lower].parent == upper
    joint = tree.links[lower if lower_is_child else upper].joint
    sign = -joint.sign if lower_is_child else joint.sign
    offset = float(np.angle(lines[upper][1] / lines[lower][1]))
    motor = attempt(Motor("", np.nan, np.nan), read_motor, model, joint.index)
    return LegJoint(joint, sign, offset, motor)


def leg_data(
    model: mujoco.MjModel,
    tree: PlanarTree,
    skeleton: Skeleton,
    lines: dict[int, tuple[complex, complex]],
    joints: tuple[tuple[LegJoint, ...], tuple[LegJoint, ...]],
) -> LegData:
    """Return the parameters of a leg, after checking that both legs have the same.

    Raises: RobotError naming the first quantity and bodies that differ.
    """
    quantities = {
        "length": "link length [m]",
        "com": "centre of mass [m]",
        "mass": "mass [kg]",
        "inertia": "inertia [kg m^2]",
        "armature": "armature [kg m^2]",
        "damping": "damping [N m s/rad]",
        "torque_limit": "torque limit [N m]",
        "lower": "lower joint limit [rad]",
        "upper": "upper joint limit [rad]",
        "foot_radius": "foot radius [m]",
        "friction": "foot friction",
        "sole": "reach of the sole [m]",
    }
    first, second = (_one_leg(model, tree, skeleton, lines, joints[i], i) for i in range(2))
    first, second = _with_turned_joints(model, joints, first, second)
    joint_fields = ("armature", "damping", "torque_limit", "lower", "upper")
    for field in fields(LegData):
        one, other = getattr(first, field.name), getattr(second, field.name)
        for leg, values in enumerate((one, other)):
            for i, value in enumerate(values):
                where = f"body {tree.links[skeleton.legs[leg][i]].name}"
                if field.name in joint_fields:
                    where = f"joint {joints[leg][i].joint.name}"
                refuse_quantity(field.name, quantities[field.name], value.real, where)
        if notes_problems():
            # A number that is not there is named where it is missing, and no difference.
            other, one = (
                np.where(np.isnan(one), one, other),
                np.where(np.isnan(other), other, one),
            )
            if np.isnan(one).all():
                continue
        largest = np.nanmax if notes_problems() else np.max
        scale = max(largest(np.abs(one), initial=1e-12), largest(np.abs(other), initial=1e-12))
        wrong = np.flatnonzero(np.abs(one - other) > 1e-6 * scale)
        if wrong.size:
            i = int(wrong[0])
            names = [tree.links[leg[i]].name for leg in skeleton.legs]
            refuse(
                f"legs of unequal data: {quantities[field.name]} is {_number_text(one[i])} at "
                "body "
                f"{names[0]} and {_number_text(other[i])} at body {names[1]}; make the legs equal"
            )
    refuse_large_foot(
        float(first.foot_radius[0]), float(np.sum(first.length)), skeleton.feet[0].name
    )
    return first


def _with_turned_joints(
    model: mujoco.MjModel,
    joints: tuple[tuple[LegJoint, ...], tuple[LegJoint, ...]],
    first: LegData,
    second: LegData,
) -> tuple[LegData, LegData]:
    """Refuse pairs of joints whose ranges differ only because one axis points the other way.

    Returns: the data of both legs, with one range for such a pair, so that it is refused once.
    """
    lower, upper = second.lower.copy(), second.upper.copy()
    signs = np.sign(np.concatenate([[joint.sign for joint in leg] for leg in joints]))
    for i, pair in enumerate(zip(*joints, strict=True)):
        if pair[0].sign == pair[1].sign or pair[0].joint.index == pair[1].joint.index:
            continue
        ends = [(leg.lower[i], leg.upper[i]) for leg in (first, second)]
        turned = _range(model, replace(pair[1], sign=-pair[1].sign))
        if np.allclose(*ends, rtol=1e-6) or not np.allclose(ends[0], turned, rtol=1e-6):
            continue
        lower[i], upper[i] = ends[0]
        # The axis to write again is the one that fewer joints of the robot share.
        odd = 0 if pair[0].sign * np.sum(signs) < 0.0 else 1
        joint, other = pair[odd].joint, pair[1 - odd].joint
        axis = model.jnt_axis[joint.index]
        refuse(
            f"joint {joint.name} turns the other way than {other.name} "
            f"(axis {_axis_text(axis)}), with the same range: write "
            f'axis="{_axis_text(-axis)}", or turn its range round'
        )
    return first, replace(second, lower=lower, upper=upper)


def _axis_text(axis: np.ndarray) -> str:
    return " ".join(f"{part + 0.0:.6g}" for part in axis)


def _number_text(value: complex) -> str:
    """Return a number, or both parts of a place: along the link, and ahead of it."""
    if not np.iscomplexobj(value):
        return f"{value:.6g}"
    return f"({value.real:.6g} along, {-value.imag + 0.0:.6g} ahead)"


def _one_leg(
    model: mujoco.MjModel,
    tree: PlanarTree,
    skeleton: Skeleton,
    lines: dict[int, tuple[complex, complex]],
    joints: tuple[LegJoint, ...],
    leg: int,
) -> LegData:
    links = [tree.links[i] for i in skeleton.legs[leg]]
    ends = [lines[i] for i in skeleton.legs[leg]]
    dofs = [int(model.jnt_dofadr[j.joint.index]) for j in joints]
    ranges = np.array([_range(model, joint) for joint in joints])
    foot = skeleton.feet[leg]
    return LegData(
        length=np.array([abs(line) for _, line in ends]),
        com=np.array(
            [
                (link.com - lower) / (line / abs(line))
                for link, (lower, line) in zip(links, ends, strict=True)
            ]
        ),
        mass=np.array([link.mass for link in links]),
        inertia=np.array([link.inertia for link in links]),
        armature=model.dof_armature[dofs].copy(),
        damping=np.array([float(np.ravel(model.dof_damping[d])[0]) for d in dofs]),
        torque_limit=np.array([joint.motor.limit for joint in joints]),
        lower=ranges[:, 0],
        upper=ranges[:, 1],
        foot_radius=np.array([foot.radius]),
        friction=np.array([foot.friction]),
        sole=np.array(foot.sole),
    )


def _range(model: mujoco.MjModel, joint: LegJoint) -> tuple[float, float]:
    ends = attempt((np.nan, np.nan), read_range, model, joint.joint.index)
    ends = sorted(joint.sign * end + joint.offset for end in ends)
    return ends[0], ends[1]
