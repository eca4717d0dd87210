"""Points of a shape that can meet a level floor, seen from the side."""

import itertools

import mujoco
import numpy as np

from neuralgaits._types import Float
from neuralgaits.robots.mjcf.foot_geoms import extent


def low_points(model: mujoco.MjModel, data: mujoco.MjData, geom: int) -> Float[np.ndarray, "p 2"]:
    """Return points of a geom, x and z in the world (m), the lowest among them.

    Corners of boxes, vertices of meshes, points under the centres of spheres and of the ends of
    capsules; of other shapes the lower corners of a box around them.
    """
    place, turn = data.geom_xpos[geom], data.geom_xmat[geom].reshape(3, 3)
    size, kind = model.geom_size[geom], int(model.geom_type[geom])
    shapes = mujoco.mjtGeom
    if kind == int(shapes.mjGEOM_SPHERE):
        return np.array([[place[0], place[2] - size[0]]])
    if kind == int(shapes.mjGEOM_CAPSULE):
        ends = place + np.outer((-size[1], size[1]), turn[:, 2])
        return ends[:, [0, 2]] - np.array([0.0, size[0]])
    if kind == int(shapes.mjGEOM_BOX):
        signs = np.array(list(itertools.product((-1.0, 1.0), repeat=3)))
        return (place + (signs * size) @ turn.T)[:, [0, 2]]
    if kind == int(shapes.mjGEOM_MESH):
        mesh = int(model.geom_dataid[geom])
        start, count = int(model.mesh_vertadr[mesh]), int(model.mesh_vertnum[mesh])
        return (place + model.mesh_vert[start : start + count] @ turn.T)[:, [0, 2]]
    low, high = extent(model, data, [geom])
    return np.array([[low[0], low[2]], [high[0], low[2]]])
