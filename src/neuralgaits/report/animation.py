"""A recorded walk as plain data for the page: the robot's shapes, and their poses over time.

All motion is in one plane, so a body's pose is three numbers in each frame: x, z and the angle
about +y. Shapes carry the rest. The page interpolates between frames and computes nothing.
"""

# pyright: reportAttributeAccessIssue=false
# MuJoCo ships no type stubs.

from collections.abc import Sequence
from typing import Any, NamedTuple

import mujoco
import numpy as np

from neuralgaits._types import Float

FRAME_S = 0.02
"""Time between two frames [s]; the page interpolates, and 50 frames a second show an impact."""
_KINDS = {
    mujoco.mjtGeom.mjGEOM_SPHERE: "sphere",
    mujoco.mjtGeom.mjGEOM_CAPSULE: "capsule",
    mujoco.mjtGeom.mjGEOM_ELLIPSOID: "ellipsoid",
    mujoco.mjtGeom.mjGEOM_CYLINDER: "cylinder",
    mujoco.mjtGeom.mjGEOM_BOX: "box",
}
# MuJoCo's own viewer hides groups from 3 on: helpers of a model, not its picture.
_SHOWN_GROUPS = 3
# A robot file without pictures is drawn as sticks of this thickness, in leg lengths.
_STICK_RADIUS = 0.03
_SHORTEST_STICK = 0.05
_STICK_COLOURS = ((0.27, 0.31, 0.37), (0.95, 0.55, 0.16), (0.10, 0.42, 0.75))
"""Colours of root, first leg and second leg: those of the built-in robots."""


class BodyMotion(NamedTuple):
    """Poses of a robot's b bodies over T states; world and floors are left out."""

    poses: Float[np.ndarray, "T b 3"]
    """x, z [m], and the angle about +y since the first state [rad]."""
    y: Float[np.ndarray, " b"]
    """Positions across the plane of motion, which never change [m]."""
    first: Float[np.ndarray, "b 4"]
    """Quaternions of the bodies in the first state."""
    momenta: Float[np.ndarray, "T 2"]
    """Linear momentum of the robot [kg m/s], (x, z)."""


def motion(model: mujoco.MjModel, states: Float[np.ndarray, "T s"]) -> BodyMotion:
    """Convert MuJoCo states (time, qpos, qvel) into a planar robot's poses at each state."""
    data, own = mujoco.MjData(model), _bodies(model)
    places, turns, momenta = [], [], []
    for state in states:
        data.qpos[:] = state[1 : 1 + model.nq]
        data.qvel[:] = state[1 + model.nq : 1 + model.nq + model.nv]
        mujoco.mj_kinematics(model, data)
        mujoco.mj_comPos(model, data)
        mujoco.mj_comVel(model, data)
        mujoco.mj_subtreeVel(model, data)
        places.append(data.xpos[own][:, [0, 2]])
        turns.append(data.xquat[own])
        momenta.append(data.subtree_linvel[0][[0, 2]] * model.body_subtreemass[0])
    angles = np.unwrap([_turn(turns[0], now) for now in turns], axis=0)
    poses = np.concatenate([places, angles[..., None]], axis=2)
    return BodyMotion(poses, data.xpos[own, 1], turns[0], np.array(momenta))


def ground_force(
    momenta: Float[np.ndarray, "T 2"], weight: float, frame_s: float
) -> Float[np.ndarray, "T 2"]:
    """Return the mean force of the ground between neighbouring frames (N), (forward, up).

    The force follows from Newton's law for the whole robot: the rate of change of momentum, plus
    the weight. If no other force acts on the robot, it is the total force on the feet.
    """
    rate = np.diff(momenta, axis=0, append=momenta[-1:]) / frame_s
    force = rate + np.array([0.0, weight])
    if len(force) > 1:
        force[-1] = force[-2]
    return force


def shapes(
    model: mujoco.MjModel,
    moved: BodyMotion,
    feet: Sequence[str],
    leg_length: float,
) -> list[dict[str, Any]]:
    """Return the robot's shapes, placed in the frames of their bodies in the first state.

    Args:
        model: compiled model.
        moved: poses of the model; only the first set is used.
        feet: names of the two foot geoms.
        leg_length: leg length of the robot (m), which scales the sticks.

    Returns: one dict for each shape, with body (counted from 0), kind, size (m), pos (m), quat and
        colour.
    """
    found = [_shape(model, geom, moved) for geom in range(model.ngeom) if _is_drawn(model, geom)]
    feet_ids = [model.geom(name).id for name in feet]
    pictured = {int(model.geom_bodyid[g]) for g in range(model.ngeom) if _is_drawn(model, g)}
    if pictured <= {int(model.geom_bodyid[g]) for g in feet_ids}:
        found += _sticks(model, moved, feet_ids, leg_length)
    return found


def contacts(model: mujoco.MjModel, moved: BodyMotion, feet: Sequence[str]) -> list[dict[str, Any]]:
    """Return the centre and radius of each foot's sphere in its body, where ground forces act."""
    found = []
    for name in feet:
        geom = model.geom(name).id
        shape = _shape(model, geom, moved)
        found.append({"body": shape["body"], "pos": shape["pos"], "radius": shape["size"][0]})
    return found


def _bodies(model: mujoco.MjModel) -> np.ndarray:
    """Return the ids of the robot's bodies; floors are mocap bodies and left out."""
    return 1 + np.flatnonzero(model.body_mocapid[1:] < 0)


def _is_drawn(model: mujoco.MjModel, geom: int) -> bool:
    """Return whether MuJoCo's viewer would draw this geom as part of the robot."""
    plane = model.geom_type[geom] == mujoco.mjtGeom.mjGEOM_PLANE
    return bool(
        model.geom_bodyid[geom] > 0
        and not plane
        and model.body_mocapid[model.geom_bodyid[geom]] < 0
        and model.geom_group[geom] < _SHOWN_GROUPS
        and _rgba(model, geom)[3] > 0.0
    )


def _rgba(model: mujoco.MjModel, geom: int) -> np.ndarray:
    material = model.geom_matid[geom]
    return model.mat_rgba[material] if material >= 0 else model.geom_rgba[geom]


def _shape(model: mujoco.MjModel, geom: int, moved: BodyMotion) -> dict[str, Any]:
    kind = _KINDS.get(mujoco.mjtGeom(model.geom_type[geom]))
    size, centre = model.geom_size[geom], np.zeros(3)
    if kind is None:
        # A mesh is shown as the box around it: its file need not be in the run.
        kind, centre, size = "box", model.geom_aabb[geom][:3], model.geom_aabb[geom][3:]
    local = np.zeros(3)
    mujoco.mju_rotVecQuat(local, centre, model.geom_quat[geom])
    local += model.geom_pos[geom]
    return _placed(
        model, int(model.geom_bodyid[geom]), moved, kind, size, local, model.geom_quat[geom]
    ) | {"colour": _short(_rgba(model, geom)[:3], 3)}


def _placed(
    model: mujoco.MjModel,
    body: int,
    moved: BodyMotion,
    kind: str,
    size: np.ndarray,
    pos: np.ndarray,
    quat: np.ndarray,
) -> dict[str, Any]:
    """Place a shape in the frame of its body at angle 0; the shape takes over the body's y."""
    place, turn, number = np.zeros(3), np.zeros(4), int(_bodies(model).searchsorted(body))
    mujoco.mju_rotVecQuat(place, np.ascontiguousarray(pos), moved.first[number])
    mujoco.mju_mulQuat(turn, moved.first[number], np.ascontiguousarray(quat))
    place[1] += moved.y[number]
    return {
        "body": number,
        "kind": kind,
        "size": _short(size),
        "pos": _short(place),
        "quat": _short(turn),
    }


def _sticks(
    model: mujoco.MjModel, moved: BodyMotion, feet: Sequence[int], leg_length: float
) -> list[dict[str, Any]]:
    """Return a capsule from each body's origin to those of its children, and to its foot."""
    ends = [
        (int(model.body_parentid[body]), model.body_pos[body])
        for body in range(2, model.nbody)
        if model.body_mocapid[body] < 0
    ]
    ends += [(int(model.geom_bodyid[geom]), model.geom_pos[geom]) for geom in feet]
    ends += [(1, 2.0 * model.body_ipos[1])]
    legs = {_branch(model, int(model.geom_bodyid[geom])): leg for leg, geom in enumerate(feet)}
    found = []
    for body, end in ends:
        length = float(np.linalg.norm(end))
        if body == 0 or length < _SHORTEST_STICK * leg_length:
            continue
        quat = np.zeros(4)
        mujoco.mju_quatZ2Vec(quat, end / length)
        size = np.array([_STICK_RADIUS * leg_length, 0.5 * length, 0.0])
        leg = legs.get(_branch(model, body), -1)
        found.append(
            _placed(model, body, moved, "capsule", size, 0.5 * end, quat)
            | {"colour": list(_STICK_COLOURS[leg + 1])}
        )
    return found


def _branch(model: mujoco.MjModel, body: int) -> int:
    """Return the child of the root body whose branch contains a body; the root for the root."""
    while body > 1 and int(model.body_parentid[body]) > 1:
        body = int(model.body_parentid[body])
    return body


def _turn(first: np.ndarray, now: np.ndarray) -> np.ndarray:
    """Return the angle about +y between two sets of quaternions (rad). [b]."""
    w = np.sum(first * now, axis=1)
    # y of now times the conjugate of first.
    y = now[:, 2] * first[:, 0] - now[:, 0] * first[:, 2]
    y += now[:, 1] * first[:, 3] - now[:, 3] * first[:, 1]
    return 2.0 * np.arctan2(y, w)


def _short(values: np.ndarray, digits: int = 5) -> list[float]:
    return [round(float(value), digits) for value in values]
