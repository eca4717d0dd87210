"""Pictures of a sagittal section: the shapes of the file, where they are, without contact."""

from xml.etree import ElementTree

import mujoco
import numpy as np

from neuralgaits.robots.mjcf.section_links import SectionLink

Element = ElementTree.Element


def write_pictures(
    world: Element, model: mujoco.MjModel, data: mujoco.MjData, links: dict[int, SectionLink]
) -> None:
    """Draw the links of a section.

    Args:
        world: <worldbody> with the bodies of the links.
        model: the robot of the file.
        data: data of the model at the posture.
        links: links by the joint that moves each.
    """
    bodies = {body.get("name"): body for body in world.iter("body")}
    for link in links.values():
        body = bodies[link.name]
        geoms = [g for g in range(model.ngeom) if int(model.geom_bodyid[g]) in link.bodies]
        pictures = [_picture_of(model, data, geom, link) for geom in geoms]
        for attributes in filter(None, pictures):
            ElementTree.SubElement(body, "geom", attributes)
        if not any(pictures):
            _draw_sticks(body, link)


def _draw_sticks(body: Element, link: SectionLink) -> None:
    """Draw a link without shapes: to the joints below it, and a torso to twice its centre."""
    ends = [below.get("pos", "0 0 0") for below in body.findall("body")]
    if link.joint < 0:
        up = 2.0 * (link.com - link.anchor)
        ends.append(f"{up.real:.6g} 0 {up.imag:.6g}")
    radius = 0.03  # Radius of the stick that shows a link of which the file has meshes only [m].
    for end in ends:
        if np.linalg.norm([float(word) for word in end.split()]) > radius:
            attributes = {"type": "capsule", "fromto": f"0 0 0 {end}", "size": repr(radius)}
            ElementTree.SubElement(body, "geom", attributes | _PICTURE_ONLY)


_PICTURE_ONLY = {"contype": "0", "conaffinity": "0", "mass": "0"}


def _picture_of(
    model: mujoco.MjModel, data: mujoco.MjData, geom: int, link: SectionLink
) -> dict[str, str] | None:
    """Return the attributes of a copy of a geom, or None of one that is no plain shape."""
    kind = mujoco.mjtGeom(model.geom_type[geom]).name.removeprefix("mjGEOM_").lower()
    if kind not in ("sphere", "capsule", "ellipsoid", "cylinder", "box"):
        return None
    place = data.geom_xpos[geom] - np.array([link.anchor.real, link.across, link.anchor.imag])
    turn = np.zeros(4)
    mujoco.mju_mat2Quat(turn, data.geom_xmat[geom])
    return {
        "type": kind,
        "size": _numbers(model.geom_size[geom]),
        "pos": _numbers(place),
        "quat": _numbers(turn),
        "rgba": _numbers(model.geom_rgba[geom]),
        **_PICTURE_ONLY,
    }


def _numbers(values: np.ndarray) -> str:
    return " ".join(f"{float(value):.6g}" for value in values)
