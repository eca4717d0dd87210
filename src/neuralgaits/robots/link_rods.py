"""Rods along the links of a robot whose file has no shapes, so that there is something to show."""

from typing import NamedTuple

import mujoco
import numpy as np

from neuralgaits._types import Float
from neuralgaits.robots.layout import MjcfLayout


class Bone(NamedTuple):
    """A rod fixed to a body."""

    body: int
    """Number of the body in the compiled model, since bodies may have no names."""
    ends: Float[np.ndarray, "2 3"]
    """End points in the body's frame [m]."""
    radius: float
    """Radius of the rod [m]."""
    colour: tuple[float, float, float, float]
    """Red, green, blue, opacity."""


def is_drawn(model, geom: int) -> bool:
    """Return whether MuJoCo's viewer would draw a geom as part of the robot."""
    body, material = int(model.geom_bodyid[geom]), int(model.geom_matid[geom])
    colour = model.mat_rgba[material] if material >= 0 else model.geom_rgba[geom]
    # Floors are planes, or mocap bodies; groups from 3 on are helpers of a model, not its picture.
    return bool(
        body > 0
        and model.geom_type[geom] != mujoco.mjtGeom.mjGEOM_PLANE
        and model.body_mocapid[body] < 0
        and model.geom_group[geom] < 3
        and colour[3] > 0.0
    )


def bones(model, layout: MjcfLayout) -> list[Bone]:
    """Return the rods of a compiled model: from foot to hip, and along the torso.

    Returns: none if the file draws more than feet and floor itself.
    """
    if sum(is_drawn(model, geom) for geom in range(model.ngeom)) > len(layout.feet):
        return []
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    mujoco.mj_comPos(model, data)
    # Radius of a rod in leg lengths.
    radius, rods = 0.022 * layout.leg_length, []
    # Colours (RGBA) of leg 0, leg 1 and torso, as in the built-in robots.
    colours = ((0.95, 0.55, 0.16, 1.0), (0.10, 0.42, 0.75, 1.0), (0.27, 0.31, 0.37, 1.0))
    for leg, joints in enumerate(layout.leg_joints):
        foot = model.geom(layout.feet[leg])
        body, below = int(foot.bodyid[0]), data.geom_xpos[foot.id]
        for name in joints:
            joint = model.joint(name)
            above = data.xanchor[joint.id]
            rods.append(_bone(data, body, (below, above), radius, colours[leg]))
            # Only the last, the hip, may be a joint of the other leg.
            body, below = int(model.body_parentid[joint.bodyid[0]]), above
    if layout.torso:
        root = int(model.joint(layout.root_joints[2]).bodyid[0])
        centre = _centre(model, data, root)
        # In the torso's own plane, between the legs.
        hip = np.array([below[0], centre[1], below[2]])
        if np.linalg.norm(centre - hip) > 0.0:
            rods.append(_bone(data, root, (hip, 2.0 * centre - hip), radius, colours[2]))
    return rods


def _centre(model, data, root: int) -> np.ndarray:
    """Centre of mass of a body and all that is welded to it. [3] (m)."""
    one = np.flatnonzero(model.body_weldid == model.body_weldid[root])
    return model.body_mass[one] @ data.xipos[one] / model.body_mass[one].sum()


def _bone(data, body: int, ends, radius: float, colour) -> Bone:
    turn = data.xmat[body].reshape(3, 3)
    local = [(place - data.xpos[body]) @ turn for place in ends]
    return Bone(body, np.array(local), radius, colour)
