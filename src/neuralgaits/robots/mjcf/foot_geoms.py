"""Feet of a robot file: which geoms of a leg's last link meet the floor, and what foot they are.

A point foot is the one sphere of that link that collides with the floor; nothing else on it may. A
flat foot is a last link of its own, on an ankle: a box or a capsule, see `soles`.
"""

from dataclasses import dataclass

import mujoco
import numpy as np

from neuralgaits.errors import RobotError
from neuralgaits.robots.mjcf.physical_numbers import refuse_frictionless, refuse_odd_contact
from neuralgaits.robots.mjcf.planar_tree import Link, PlanarTree, in_plane
from neuralgaits.robots.mjcf.refuse_or_note import refuse
from neuralgaits.robots.mjcf.refused_physics import refuse_excluded
from neuralgaits.robots.mjcf.soles import read_sole


@dataclass(frozen=True)
class Foot:
    """A foot.

    Attributes:
        name: name of its geom.
        centre: centre of the sphere of a point foot, or the place on a flat one's sole that is
            under the ankle, at zero coordinates, x + i z [m].
        radius: radius of the sphere; of a flat foot, the height of its ankle above the sole [m].
        friction: sliding coefficient of the contact with the floor.
        sole: distances by which it reaches behind and ahead of the ankle [m]; () for a point foot.
    """

    name: str
    centre: complex
    radius: float
    friction: float
    sole: tuple[float, ...] = ()


def touching(model: mujoco.MjModel, bodies: tuple[int, ...], floor: int) -> list[int]:
    """Return the geoms of a link that collide with the floor.

    Args:
        model: compiled robot file.
        bodies: bodies of the link.
        floor: geom number.
    """
    kind, affinity = model.geom_contype, model.geom_conaffinity
    meets = (kind & affinity[floor]) | (kind[floor] & affinity)
    return [int(g) for g in np.flatnonzero(meets) if model.geom_bodyid[g] in bodies]


def is_flat_foot(
    model: mujoco.MjModel,
    data: mujoco.MjData,
    tree: PlanarTree,
    leg: tuple[int, ...],
    floor: int,
) -> bool:
    """Return whether a leg ends in a foot on an ankle: longer than high, and not just a sphere.

    Args:
        model: compiled robot file.
        data: data of the model at zero coordinates.
        tree: links and joints of the robot.
        leg: its links, lowest first.
        floor: geom number.
    """
    link = tree.links[leg[0]]
    geoms = touching(model, link.bodies, floor)
    is_sphere = [model.geom_type[g] == mujoco.mjtGeom.mjGEOM_SPHERE for g in geoms]
    if len(leg) < 2 or not geoms or (len(geoms) == 1 and is_sphere[0]):
        return False
    length, height = _size(model, data, link, geoms)
    return length > height


def _size(
    model: mujoco.MjModel, data: mujoco.MjData, link: Link, geoms: list[int]
) -> tuple[float, float]:
    """Return length and height of a link's geoms and its joint together (m)."""
    anchor = np.array([link.joint.anchor.real, 0.0, link.joint.anchor.imag])
    low, high = extent(model, data, geoms)
    length, _, height = np.maximum(high, anchor) - np.minimum(low, anchor)
    return float(length), float(height)


def extent(
    model: mujoco.MjModel, data: mujoco.MjData, geoms: list[int]
) -> tuple[np.ndarray, np.ndarray]:
    """Lowest and highest world coordinates of geoms' boxes [m]. [3], [3]."""
    low, high = np.full(3, np.inf), np.full(3, -np.inf)
    for geom in geoms:
        turn = data.geom_xmat[geom].reshape(3, 3)
        centre = data.geom_xpos[geom] + turn @ model.geom_aabb[geom, :3]
        reach = np.abs(turn) @ model.geom_aabb[geom, 3:]
        low, high = np.minimum(low, centre - reach), np.maximum(high, centre + reach)
    return low, high


def point_foot(
    model: mujoco.MjModel, data: mujoco.MjData, tree: PlanarTree, index: int, floor: int
) -> Foot:
    """Read the point foot of a link. Raises: RobotError naming the body, and the remedy."""
    link = tree.links[index]
    geoms = touching(model, link.bodies, floor)
    spheres = [g for g in geoms if model.geom_type[g] == mujoco.mjtGeom.mjGEOM_SPHERE]
    length, height = _size(model, data, link, geoms) if geoms else (0.0, 0.0)
    if not spheres and 3.0 * length > height:
        raise RobotError(
            f"body {link.name} is no foot that is treated: with its joint it is "
            f"{1e3 * length:.3g} mm long and {1e3 * height:.3g} mm high; make it a flat one, whose "
            "sole is level, along the robot, and longer than its ankle is high; or a point foot, a "
            '<geom type="sphere"> that collides with the floor'
        )
    if not spheres:
        raise RobotError(
            f'body {link.name} has no foot: add a <geom type="sphere"> that collides with the '
            "floor at its end"
        )
    if len(geoms) > 1:
        refuse(
            f"{len(geoms)} geoms of body {link.name} collide with the floor: a point foot is one "
            'sphere; set contype="0" conaffinity="0" on the others'
        )
    geom = spheres[0]
    name = model.geom(geom).name
    if not name:
        refuse(f"the foot sphere of body {link.name} has no name: give it one")
    _refuse_contact(model, geom, floor)
    return Foot(
        name,
        in_plane(data.geom_xpos[geom]),
        float(model.geom_size[geom, 0]),
        _contact_friction(model, geom, floor),
    )


def flat_foot(
    model: mujoco.MjModel, data: mujoco.MjData, tree: PlanarTree, index: int, floor: int
) -> Foot:
    """Read the flat foot that a link is. Raises: RobotError naming the body, and the remedy."""
    link = tree.links[index]
    ankle = link.joint.anchor
    sole = read_sole(model, data, touching(model, link.bodies, floor), link.name, ankle)
    _refuse_contact(model, sole.geom, floor)
    return Foot(
        model.geom(sole.geom).name,
        complex(ankle.real, sole.level),
        ankle.imag - sole.level,
        _contact_friction(model, sole.geom, floor),
        # Nanometres: MuJoCo turns quaternions with rounding.
        (round(ankle.real - sole.heel, 9) + 0.0, round(sole.toe - ankle.real, 9) + 0.0),
    )


def _refuse_contact(model: mujoco.MjModel, foot: int, floor: int) -> None:
    """Refuse a contact of foot and floor that no formula has. Raises: RobotError."""
    refuse_frictionless(model, foot, floor)
    refuse_odd_contact(model, foot, floor)
    refuse_excluded(model, foot, floor)


def _contact_friction(model: mujoco.MjModel, foot: int, floor: int) -> float:
    """Return the friction by MuJoCo's rule: higher priority decides, else the larger value."""
    values = model.geom_friction[[foot, floor], 0]
    priorities = model.geom_priority[[foot, floor]]
    if priorities[0] == priorities[1]:
        return float(values.max())
    return float(values[int(np.argmax(priorities))])
