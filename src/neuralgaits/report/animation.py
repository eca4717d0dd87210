"""A recorded walk as plain data for the page: the robot's shapes, and their poses over time.

All motion is in one plane, so a body's pose is three numbers in each frame: x, z and the angle
about +y. Shapes carry the rest. The page interpolates between frames and computes nothing.
"""

from collections.abc import Sequence
from typing import Any, NamedTuple

import mujoco
import numpy as np

from neuralgaits._types import Float
from neuralgaits.robots.layout import MjcfLayout
from neuralgaits.robots.link_rods import bones, is_drawn

FRAME_S = 0.02
"""Time between two frames [s]; the page interpolates, and 50 frames a second show an impact."""


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


def shapes(model: mujoco.MjModel, motion: BodyMotion, layout: MjcfLayout) -> list[dict[str, Any]]:
    """Return the robot's shapes, placed in the frames of their bodies in the first state.

    Args:
        model: compiled model.
        motion: poses of the model; only the first set is used.
        layout: layout of the robot; rods stand for links if its file has no shapes.

    Returns: one dict for each shape, with body (counted from 0), kind, size (m), pos (m), quat and
        colour.
    """
    drawn_shapes = [
        _shape(model, geom, motion) for geom in range(model.ngeom) if is_drawn(model, geom)
    ]
    for bone in bones(model, layout):
        along, quat = bone.ends[1] - bone.ends[0], np.zeros(4)
        length = float(np.linalg.norm(along))
        mujoco.mju_quatZ2Vec(quat, along / length)
        size = np.array([bone.radius, 0.5 * length, 0.0])
        rod = _placed(model, bone.body, motion, "capsule", size, bone.ends.mean(axis=0), quat)
        drawn_shapes.append(rod | {"colour": list(bone.colour[:3])})
    return drawn_shapes


def contacts(
    model: mujoco.MjModel, motion: BodyMotion, feet: Sequence[str]
) -> list[dict[str, Any]]:
    """Return the centre and radius of each foot's sphere in its body, where ground forces act."""
    rows = []
    for name in feet:
        geom = model.geom(name).id
        shape = _shape(model, geom, motion)
        rows.append({"body": shape["body"], "pos": shape["pos"], "radius": shape["size"][0]})
    return rows


def _bodies(model: mujoco.MjModel) -> np.ndarray:
    """Return the ids of the robot's bodies; floors are mocap bodies and left out."""
    return 1 + np.flatnonzero(model.body_mocapid[1:] < 0)


def _shape(model: mujoco.MjModel, geom: int, motion: BodyMotion) -> dict[str, Any]:
    kinds = {
        mujoco.mjtGeom.mjGEOM_SPHERE: "sphere",
        mujoco.mjtGeom.mjGEOM_CAPSULE: "capsule",
        mujoco.mjtGeom.mjGEOM_ELLIPSOID: "ellipsoid",
        mujoco.mjtGeom.mjGEOM_CYLINDER: "cylinder",
        mujoco.mjtGeom.mjGEOM_BOX: "box",
    }
    kind = kinds.get(mujoco.mjtGeom(model.geom_type[geom]))
    size, centre = model.geom_size[geom], np.zeros(3)
    if kind is None:
        # A mesh is shown as the box around it: its file need not be in the run.
        kind = "box"
        centre = model.geom_aabb[geom][:3]
        size = model.geom_aabb[geom][3:]
    local = np.zeros(3)
    mujoco.mju_rotVecQuat(local, centre, model.geom_quat[geom])
    local += model.geom_pos[geom]
    material, body = model.geom_matid[geom], int(model.geom_bodyid[geom])
    colour = model.mat_rgba[material] if material >= 0 else model.geom_rgba[geom]
    placed = _placed(model, body, motion, kind, size, local, model.geom_quat[geom])
    return placed | {"colour": _short(colour[:3], 3)}


def _placed(
    model: mujoco.MjModel,
    body: int,
    motion: BodyMotion,
    kind: str,
    size: np.ndarray,
    pos: np.ndarray,
    quat: np.ndarray,
) -> dict[str, Any]:
    """Place a shape in the frame of its body at angle 0; the shape takes over the body's y."""
    place = np.zeros(3)
    turn = np.zeros(4)
    number = int(_bodies(model).searchsorted(body))
    mujoco.mju_rotVecQuat(place, np.ascontiguousarray(pos), motion.first[number])
    mujoco.mju_mulQuat(turn, motion.first[number], np.ascontiguousarray(quat))
    place[1] += motion.y[number]
    return {
        "body": number,
        "kind": kind,
        "size": _short(size),
        "pos": _short(place),
        "quat": _short(turn),
    }


def _turn(first: np.ndarray, now: np.ndarray) -> np.ndarray:
    """Return the angle about +y between two sets of quaternions (rad). [b]."""
    w = np.sum(first * now, axis=1)
    # y of now times the conjugate of first.
    y = now[:, 2] * first[:, 0] - now[:, 0] * first[:, 2]
    y += now[:, 1] * first[:, 3] - now[:, 3] * first[:, 1]
    return 2.0 * np.arctan2(y, w)


def _short(values: np.ndarray, digits: int = 5) -> list[float]:
    return [round(float(value), digits) for value in values]
