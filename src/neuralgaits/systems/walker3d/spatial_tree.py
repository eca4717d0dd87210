"""Where the parts of the biped are in a compiled robot file, and what is not its tree."""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import mujoco
import numpy as np

from neuralgaits._types import Float, Int
from neuralgaits.robots.mjcf.model_contents import HINGE, SLIDE, at_zero, joint_label, joints_on

CLOSE = 1e-9
"""Largest difference of lengths [m] and directions that are equal."""


@dataclass(frozen=True)
class SpatialTree:
    """Numbers of the parts in MuJoCo's model; the right leg first.

    Attributes:
        root: joints of the root: x, y, z, roll, pitch.
        joints: hip roll, hip pitch and knee of either leg. [2][3]
        motors: on them, in the same order. [2][3]
        bodies: torso, then thigh and shin of either leg.
        feet: spheres that meet the floor.
        yaw: joint of a yaw that is free; None if it is held, as in every robot file.
    """

    root: tuple[int, ...]
    joints: tuple[tuple[int, ...], tuple[int, ...]]
    motors: tuple[tuple[int, ...], tuple[int, ...]]
    bodies: tuple[int, ...]
    feet: tuple[int, int]
    yaw: int | None = None

    @property
    def coordinates(self) -> Int[np.ndarray, "11"]:
        """Return where root, right leg and left leg are among MuJoCo's coordinates.

        Each joint has one, so that these are the numbers of the joints; a file may have the left
        leg first.
        """
        return np.array([*self.root, *self.joints[0], *self.joints[1]])

    def with_free_yaw(self) -> "SpatialTree":
        """Return the tree with a hinge between the slides and the lean: what follows moves on."""
        x, y, z, roll, pitch = self.root
        right, left = (tuple(joint + 1 for joint in leg) for leg in self.joints)
        root = (x, y, z, roll + 1, pitch + 1)
        return replace(self, root=root, joints=(right, left), yaw=roll)


def children_of(model: mujoco.MjModel, body: int) -> list[int]:
    """Return the bodies with joints that hang on a body, or on what is welded to it."""
    children = []
    for child in range(1, model.nbody):
        above = int(model.body_weldid[model.body_parentid[child]])
        if int(model.body_weldid[child]) == child and above == body:
            children.append(child)
    return children


def tree_of(model: mujoco.MjModel) -> tuple[SpatialTree | None, list[str]]:
    """Return where the parts are, or why the file's tree is another's."""
    data, moving = at_zero(model), children_of(model, 0)
    if len(moving) != 1:
        return None, [f"expected one robot, found {len(moving)} moving bodies on the world"]
    problems = [*_root_problems(model, data, moving[0])]
    thighs = sorted(children_of(model, moving[0]), key=lambda body: float(data.xpos[body, 1]))
    if len(thighs) != 2:
        return None, [*problems, f"expected two legs on the torso, found {len(thighs)}: no arms"]
    legs = []
    bodies = [moving[0]]
    feet = []
    for side, thigh in zip(("right", "left"), thighs, strict=True):
        shins = children_of(model, thigh)
        joints = joints_on(model, thigh)
        wrong = len(shins) != 1 or bool(children_of(model, shins[0]))
        if wrong or len(joints) != 2 or len(joints_on(model, shins[0])) != 1:
            problems.append(
                f"the {side} leg: expected a thigh with a roll and a pitch hinge and a shin with a "
                "knee, found another chain: lock or delete other joints (ankles, hip yaw)"
            )
            continue
        legs.append((*joints, *joints_on(model, shins[0])))
        bodies += [thigh, shins[0]]
        feet += _feet(model, shins[0])
        problems += _axis_problems(model, data, legs[-1])
        if len(_feet(model, shins[0])) != 1:
            problems.append(
                f"the {side} shin: expected one sphere that can touch the floor, its foot, found "
                f"{len(_feet(model, shins[0]))}: give all other geoms contype and conaffinity 0"
            )
    motors = []
    for leg in legs:
        motors.append(tuple(_motor(model, joint, problems) for joint in leg))
    if model.nu > 6:
        problems.append(f"expected six motors, one a joint, found {model.nu}: delete the others")
    if problems:
        return None, problems
    return SpatialTree(
        tuple(joints_on(model, moving[0])),
        (legs[0], legs[1]),
        (motors[0], motors[1]),
        tuple(bodies),
        (feet[0], feet[1]),
    ), []


def _root_problems(model: mujoco.MjModel, data: mujoco.MjData, root: int) -> Iterator[str]:
    joints = joints_on(model, root)
    if any(int(model.jnt_type[j]) not in (SLIDE, HINGE) for j in joints):
        yield (
            "the torso has a free or ball joint, so that its yaw is free, which the "
            "theory has not: give it slides x, y, z and hinges roll, pitch"
        )
        return
    root_joints = [(int(model.jnt_type[j]), data.xaxis[j]) for j in joints]
    if any(kind == HINGE and abs(axis[2]) > 1.0 - CLOSE for kind, axis in root_joints):
        yield (
            "the torso's yaw is free, and point feet of this model do not resist twisting: delete "
            "that hinge, and simulate with --disturb torsional_friction_m=0.05 to free it"
        )
        return
    expected_joints = ((SLIDE, 0), (SLIDE, 1), (SLIDE, 2), (HINGE, 0), (HINGE, 1))
    alike = len(root_joints) == len(expected_joints) and all(
        kind == expected and _is_axis(axis, number)
        for (kind, axis), (expected, number) in zip(root_joints, expected_joints, strict=True)
    )
    if not alike:
        yield (
            "the torso: expected slides x, y, z and hinges roll (axis 1 0 0), pitch (0 1 0) in one "
            "body and in this order, found others: write them so"
        )
    elif any(np.abs(data.xanchor[j] - data.xanchor[joints[3]]).max() > CLOSE for j in joints[3:]):
        yield "the torso: expected its roll and pitch about one point, found two: give them one pos"


def _axis_problems(
    model: mujoco.MjModel, data: mujoco.MjData, leg: tuple[int, ...]
) -> Iterator[str]:
    for joint, (number, words) in zip(leg, ((0, "roll"), (1, "pitch"), (1, "pitch")), strict=True):
        name = joint_label(model, joint)
        if int(model.jnt_type[joint]) != HINGE or not _is_axis(data.xaxis[joint], number):
            axis = "1 0 0" if number == 0 else "0 1 0"
            yield f'joint {name}: expected a {words} hinge, found another: use axis="{axis}"'
    roll, pitch, knee = (data.xanchor[joint] for joint in leg)
    if np.abs(roll - pitch)[1:].max() > CLOSE:
        yield (
            f"the axis of {joint_label(model, leg[0])} does not meet the hip's pitch axis at the "
            "leg: give both joints one pos"
        )
    if np.abs(knee - pitch)[:2].max() > CLOSE or not knee[2] < pitch[2]:
        yield (
            f"joint {joint_label(model, leg[2])} is not straight below the hip where all angles "
            "are 0: move it there"
        )


def _is_axis(axis: Float[np.ndarray, "3"], number: int) -> bool:
    return bool(np.abs(axis - np.eye(3)[number]).max() <= CLOSE)


def _feet(model: mujoco.MjModel, body: int) -> list[int]:
    """Return the spheres of a body, or of what is welded to it, that can touch something."""
    sphere = int(mujoco.mjtGeom.mjGEOM_SPHERE)
    return [
        geom
        for geom in range(model.ngeom)
        if int(model.body_weldid[model.geom_bodyid[geom]]) == body
        and int(model.geom_type[geom]) == sphere
        and (model.geom_contype[geom] or model.geom_conaffinity[geom])
    ]


def _motor(model: mujoco.MjModel, joint: int, problems: list[str]) -> int:
    """Return the motor of a joint; -1, and a problem, if it has no plain one with limits."""
    kind = int(mujoco.mjtTrn.mjTRN_JOINT)
    motors = [
        motor
        for motor in range(model.nu)
        if int(model.actuator_trntype[motor]) == kind
        and int(model.actuator_trnid[motor, 0]) == joint
    ]
    name = joint_label(model, joint)
    if len(motors) != 1:
        problems.append(f"joint {name}: expected one motor, found {len(motors)}")
        return -1
    plain = (
        model.actuator_gaintype[motors[0]] == int(mujoco.mjtGain.mjGAIN_FIXED)
        and model.actuator_biastype[motors[0]] == int(mujoco.mjtBias.mjBIAS_NONE)
        and model.actuator_dyntype[motors[0]] == int(mujoco.mjtDyn.mjDYN_NONE)
    )
    limited = bool(model.actuator_ctrllimited[motors[0]])
    low, high = model.actuator_ctrlrange[motors[0]]
    if not plain or not limited or low != -high or not high > 0.0:
        problems.append(
            f"joint {name}: expected a <motor> with equal limits either way, found another "
            'actuator: use <motor> with ctrlrange="-80 80" or its own'
        )
    return motors[0]
