"""Feet of a sagittal section: the sole that the file draws, as one box, or the tip of a leg."""

from dataclasses import dataclass

import mujoco
import numpy as np

from neuralgaits.errors import RobotError
from neuralgaits.robots.mjcf.low_points import low_points
from neuralgaits.robots.mjcf.planar_tree import body_name, in_plane
from neuralgaits.robots.mjcf.section_links import SectionLink
from neuralgaits.robots.mjcf.skeleton import find_floor

_TIP_M = 0.003
"""Radius of a sphere at the tip of a leg that the file draws otherwise [m]."""


@dataclass(frozen=True)
class SectionFoot:
    """Foot that a leg stands on.

    Attributes:
        kind: "sphere" or "box".
        place: its centre in the world at the posture, x + i z [m].
        size: radius of the sphere, or half length and half height of the box [m].
        friction: sliding coefficient of foot and floor together.
        condim: dimension of the contact, as the file has it.
        source: what in the file it is made of.
        name: name of the geom in the file, or "".
    """

    kind: str
    place: complex
    size: tuple[float, ...]
    friction: float
    condim: int
    source: str
    name: str = ""


def section_foot(
    model: mujoco.MjModel, data: mujoco.MjData, link: SectionLink, *, has_ankle: bool
) -> SectionFoot:
    """Return what a leg stands on.

    Args:
        model: the robot.
        data: data of the model at the posture.
        link: lowest link of the leg.
        has_ankle: whether the leg has enough hinges for the link to be a foot on an ankle.

    Raises: RobotError if nothing in the file says where the leg ends.
    """
    geoms = [g for g in range(model.ngeom) if int(model.geom_bodyid[g]) in link.bodies]
    solid = [g for g in geoms if model.geom_contype[g] or model.geom_conaffinity[g]]
    geoms = solid or geoms
    if not geoms:
        return _frame_tip(model, data, link)
    points = {geom: low_points(model, data, geom) for geom in geoms}
    lowest = min(geoms, key=lambda geom: float(points[geom][:, 1].min()))
    level = float(points[lowest][:, 1].min())
    friction, condim = _contact(model, data, lowest)
    every = np.concatenate(list(points.values()))
    thickness = 0.01  # Of the sole: points so far above the lowest one belong to it [m].
    sole = every[every[:, 1] <= level + thickness, 0]
    heel, toe = float(sole.min()), float(sole.max())
    high = link.anchor.imag - level
    ankle = link.anchor.real
    shortest = 0.02  # [m]
    # A foot is longer than its ankle is high.
    flat = toe - heel >= shortest and max(toe, ankle) - min(heel, ankle) > high > 0.0
    if has_ankle and flat:
        half = min(0.0125, high / 4.0)
        is_mesh = model.geom_type[lowest] == mujoco.mjtGeom.mjGEOM_MESH
        what = "its mesh ends" if is_mesh else "its shapes end"
        return SectionFoot(
            "box",
            complex((heel + toe) / 2.0, level + half),
            ((toe - heel) / 2.0, half),
            friction,
            condim,
            f"sole of {link.name}: box from {1e3 * (ankle - heel):.4g} mm behind the ankle to "
            f"{1e3 * (toe - ankle):.4g} mm ahead, where {what}",
        )
    if has_ankle:
        _refuse_tilted(link, every)
    if model.geom_type[lowest] == mujoco.mjtGeom.mjGEOM_SPHERE:
        radius = float(model.geom_size[lowest, 0])
        place, name = in_plane(data.geom_xpos[lowest]), model.geom(lowest).name
        return SectionFoot("sphere", place, (radius,), friction, condim, "", name)
    return SectionFoot(
        "sphere",
        complex((heel + toe) / 2.0, level + _TIP_M),
        (_TIP_M,),
        friction,
        condim,
        f"point foot of {link.name}: sphere of {1e3 * _TIP_M:g} mm at its lower end",
    )


def _refuse_tilted(link: SectionLink, points: np.ndarray) -> None:
    """Refuse a box or mesh on an ankle that stands on an edge, since it is no point and not flat.

    Args:
        link: the foot.
        points: low points of its shapes, x and z (m). [p, 2]
    """
    length = float(np.ptp(points[:, 0]))
    if length < 2.0 * abs(link.anchor.imag - float(points[:, 1].min())):
        return
    raise RobotError(
        f"foot {link.name} stands on an edge at zero coordinates, with a sole of "
        f"{1e3 * length:.3g} mm: expected one that is level there; turn the robot's base "
        "or the foot in the file"
    )


def _frame_tip(model: mujoco.MjModel, data: mujoco.MjData, link: SectionLink) -> SectionFoot:
    """Return a point foot at the lowest frame that hangs from a link without shapes."""
    first = link.bodies[0]
    frames = [body for body in link.bodies if body != first]
    if not frames:
        raise RobotError(
            f"link {link.name} ends a leg and has no shape and no link fixed to it, so nothing "
            "says where its foot is: give it a <collision> (put its mesh there, or write a box or "
            "sphere), or fix a link to it where the foot is"
        )
    frame = min(frames, key=lambda body: float(data.xpos[body, 2]))
    place = complex(data.xpos[frame, 0], data.xpos[frame, 2])
    change = (
        f"point foot of {link.name}: sphere of {1e3 * _TIP_M:g} mm at {body_name(model, frame)}"
    )
    friction = 1.0  # MuJoCo's own.
    return SectionFoot("sphere", place, (_TIP_M,), friction, 3, change)


def _contact(model: mujoco.MjModel, data: mujoco.MjData, geom: int) -> tuple[float, int]:
    """Return friction and condim of a foot on the file's floor, or on one like itself."""
    floor = find_floor(model, data)
    pair = [geom] if floor is None else [geom, floor]
    priorities = model.geom_priority[pair]
    deciding = [one for one in pair if model.geom_priority[one] == priorities.max()]
    friction = float(model.geom_friction[deciding, 0].max())
    return friction, int(model.geom_condim[deciding].max())
