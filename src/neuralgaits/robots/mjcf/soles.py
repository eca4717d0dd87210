"""Soles of flat feet: where a foot on an ankle meets the floor while it is level."""

import itertools
from typing import NamedTuple

import mujoco
import numpy as np

from neuralgaits._types import Float
from neuralgaits.errors import RobotError
from neuralgaits.robots.mjcf.refuse_or_note import refuse


class Sole(NamedTuple):
    """The sole of a foot in the plane, at zero coordinates."""

    geom: int
    """Number of its geom."""
    heel: float
    """Place of its rear end, x [m]."""
    toe: float
    """Place of its front end, x [m]."""
    level: float
    """Height, z [m]."""


def read_sole(
    model: mujoco.MjModel, data: mujoco.MjData, geoms: list[int], name: str, ankle: complex
) -> Sole:
    """Return the sole of a foot: one box, or one capsule along the foot, level at zero coordinates.

    Args:
        model: compiled robot file.
        data: data of the model at zero coordinates.
        geoms: geoms of the foot that collide with the floor.
        name: name of the foot's body.
        ankle: place of its joint, x + i z (m).

    Raises: RobotError naming the body, what is wrong with its foot, and the remedy.
    """
    if len(geoms) != 1:
        raise RobotError(
            f"{len(geoms)} geoms of foot {name} collide with the floor: a flat foot is one box or "
            'one capsule; set contype="0" conaffinity="0" on the others'
        )
    geom = geoms[0]
    if not model.geom(geom).name:
        refuse(f"the {_shape(model, geom)} of foot {name} has no name: give it one")
    ends = _lowest(model, data, geom)
    if ends is None:
        raise RobotError(
            f"foot {name} is a {_shape(model, geom)}: expected a box or a capsule along the foot; "
            "replace it, or end the leg in a point foot with "
            "`neuralgaits inspect FILE --planarise OUT.xml`"
        )
    level = float(ends[:, 2].min())
    level_m = 1e-4  # Largest difference in height of points of one sole [m].
    if float(np.ptp(ends[:, 2])) > level_m:
        refuse(
            f"foot {name} is not level at zero coordinates: turn its {_shape(model, geom)} until "
            "its sole is parallel to the floor"
        )
    heel, toe = float(ends[:, 0].min()), float(ends[:, 0].max())
    behind, ahead, high = ankle.real - heel, toe - ankle.real, ankle.imag - level
    shortest_m = 0.02  # Shortest sole that is treated [m].
    if min(behind, ahead) < -level_m or behind + ahead < shortest_m:
        refuse(
            f"foot {name} reaches {1e3 * behind:.3g} mm behind its ankle and {1e3 * ahead:.3g} mm "
            f"ahead, too little to hold the robot: expected none below 0, and "
            f"{1e3 * shortest_m:g} mm in all; move or lengthen it"
        )
    if high <= 0.0:
        refuse(f"the ankle of foot {name} is not above its sole: move one of them")
    return Sole(geom, heel, toe, level)


def _shape(model: mujoco.MjModel, geom: int) -> str:
    return mujoco.mjtGeom(model.geom_type[geom]).name.removeprefix("mjGEOM_").lower()


def _lowest(
    model: mujoco.MjModel, data: mujoco.MjData, geom: int
) -> Float[np.ndarray, "p 3"] | None:
    """Return points of a geom's sole in the world (m); None for a shape that has none."""
    place, turn = data.geom_xpos[geom], data.geom_xmat[geom].reshape(3, 3)
    size, kind = model.geom_size[geom], model.geom_type[geom]
    if kind == mujoco.mjtGeom.mjGEOM_CAPSULE:
        along = turn[:, 2] * size[1]
        return np.stack([place - along, place + along]) - np.array([0.0, 0.0, size[0]])
    if kind != mujoco.mjtGeom.mjGEOM_BOX:
        return None
    signs = np.array(list(itertools.product((-1.0, 1.0), repeat=3)))
    corners = place + (signs * size) @ turn.T
    # A level box has four corners below its middle; of a tilted one they differ in height.
    return corners[np.argsort(corners[:, 2])[:4]]
