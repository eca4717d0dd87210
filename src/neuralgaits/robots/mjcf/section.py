"""The sagittal section of a robot in space: a new file of the links that move in the plane.

Root, out-of-plane joints, arms and waist are what `section_plan` says. Masses are those of MuJoCo's
bodies, welded and seen from the side. Every change is one line.
"""

from xml.etree import ElementTree

import mujoco
import numpy as np

from neuralgaits.robots.mjcf.compiled import compile_text
from neuralgaits.robots.mjcf.model_contents import model_name
from neuralgaits.robots.mjcf.physical_numbers import refuse_unphysical
from neuralgaits.robots.mjcf.planar_tree import body_name
from neuralgaits.robots.mjcf.refused_physics import refuse_loops
from neuralgaits.robots.mjcf.section_changes import lines_about_plan
from neuralgaits.robots.mjcf.section_feet import SectionFoot, section_foot
from neuralgaits.robots.mjcf.section_links import SectionLink, equal_legs, section_links
from neuralgaits.robots.mjcf.section_motors import write_motors
from neuralgaits.robots.mjcf.section_pictures import write_pictures
from neuralgaits.robots.mjcf.section_plan import (
    SectionPlan,
    at_posture,
    plan_section,
    posture,
)
from neuralgaits.robots.mjcf.skeleton import find_floor

Element = ElementTree.Element


def needs_section(model: mujoco.MjModel) -> bool:
    """Return whether a robot has joints that only a section leaves out: arms, or hinges across.

    Its root may be a free joint, or slides and a hinge of one body; anything else is a chain.
    """
    data = at_posture(model, posture(model, frozenset())[0])
    welded = [int(one) for one in model.body_weldid]
    roots = {top for top in welded if top and welded[model.body_parentid[top]] == 0}
    if len(roots) != 1:
        # Two legs of a body that is fixed to the world.
        fixed = {int(model.body_rootid[top]) for top in roots}
        return len(roots) == 2 and len(fixed) == 1 and not fixed & roots
    root = roots.pop()
    tops = sorted({top for top in welded if top})
    below = [top for top in tops if welded[model.body_parentid[top]] == root]
    kinds = [int(kind) for kind in model.jnt_type[model.jnt_bodyid == root]]
    planar, free = [2, 2, 3], [0]
    if len(below) not in (1, 2) or kinds not in (planar, free):
        return bool(below)
    branches = any(
        sum(welded[model.body_parentid[one]] == top for one in tops) > 1 for top in tops[1:]
    )
    hinges = [j for j in range(model.njnt) if int(model.jnt_bodyid[j]) != root]
    across = any(abs(abs(data.xaxis[j][1]) - 1.0) > 1e-6 for j in hinges)
    several = any(model.body_jntnum[top] > 1 for top in tops if top != root)
    return branches or across or several


def section(text: str, name: str, weld: frozenset[str]) -> tuple[str, tuple[str, ...]]:
    """Write the sagittal section of a robot.

    Args:
        text: MJCF text of a robot, in the plane or in space.
        name: name of the robot, unless the file names its model.
        weld: names of joints to weld beside those that a section welds.

    Returns: MJCF text, and the changes, one line each.
    Raises: RobotError naming the body or joint that is in the way.
    """
    model = compile_text(text, name)
    refuse_unphysical(model)
    refuse_loops(model)
    qpos, named = posture(model, weld)
    data = at_posture(model, qpos)
    plan = plan_section(model, data, weld)
    links, alike = equal_legs(section_links(model, data, plan), plan)
    feet = [
        # The last link of a leg can be a foot if another hinge is above its own.
        section_foot(model, data, links[leg[-1]], has_ankle=len(leg) >= 2)
        for leg in plan.legs
    ]
    root = ElementTree.Element("mujoco", model=model_name(model, name))
    ElementTree.SubElement(root, "compiler", angle="radian", autolimits="true")
    gravity = " ".join(f"{value:.15g}" for value in model.opt.gravity)
    ElementTree.SubElement(root, "option", gravity=gravity, timestep=repr(model.opt.timestep))
    world = ElementTree.SubElement(root, "worldbody")
    _write_floor(world, model, data)
    names = _write_base(world, model, plan, links)
    _write_legs(world, model, data, plan, links, feet)
    write_pictures(world, model, data, links)
    of_motors = write_motors(ElementTree.SubElement(root, "actuator"), model, plan)
    ElementTree.indent(root)
    changes = (
        *lines_about_plan(model, plan, named, names),
        *alike,
        *(foot.source for foot in feet if foot.source),
        *of_motors,
    )
    return ElementTree.tostring(root, encoding="unicode") + "\n", changes


def _write_floor(world: Element, model: mujoco.MjModel, data: mujoco.MjData) -> None:
    """Write a level floor where the file has its own, or at height 0."""
    floor = find_floor(model, data)
    height = 0.0 if floor is None else float(data.geom_xpos[floor][2])
    attributes = {"name": "floor", "type": "plane", "size": "0 0 0.1", "pos": f"0 0 {height!r}"}
    ElementTree.SubElement(world, "geom", attributes | {"contype": "1", "conaffinity": "0"})


def _write_base(
    world: Element, model: mujoco.MjModel, plan: SectionPlan, links: dict[int, SectionLink]
) -> tuple[str, ...]:
    """Write the base and its root joints. Returns: names of these."""
    base = links[-1]
    body = ElementTree.SubElement(world, "body", name=base.name, pos=_place(base.anchor))
    joint_names = {model.joint(joint).name for leg in plan.legs for joint in leg}
    prefix = next(p for p in ("root", "base", "section_root") if f"{p}_pitch" not in joint_names)
    root_joints = (("x", "slide", "1 0 0"), ("z", "slide", "0 0 1"), ("pitch", "hinge", "0 1 0"))
    names = tuple(f"{prefix}_{end}" for end, _, _ in root_joints)
    for label, (_, kind, axis) in zip(names, root_joints, strict=True):
        ElementTree.SubElement(body, "joint", name=label, type=kind, axis=axis)
    _write_inertial(body, base)
    return names


def _write_legs(
    world: Element,
    model: mujoco.MjModel,
    data: mujoco.MjData,
    plan: SectionPlan,
    links: dict[int, SectionLink],
    feet: list[SectionFoot],
) -> None:
    base = world.find("body")
    assert base is not None
    for leg, foot in zip(plan.legs, feet, strict=True):
        parent = base
        above = links[-1].anchor
        across = links[leg[0]].across
        for joint in leg:
            link = links[joint]
            place = _place(link.anchor - above, across)
            parent = ElementTree.SubElement(parent, "body", name=link.name, pos=place)
            ElementTree.SubElement(parent, "joint", _joint(model, data, joint))
            _write_inertial(parent, link)
            above, across = link.anchor, 0.0
        _write_foot(parent, foot, above)


def _joint(model: mujoco.MjModel, data: mujoco.MjData, joint: int) -> dict[str, str]:
    """Return the attributes of a kept hinge: its own coordinate, range, rotor and damping."""
    dof = int(model.jnt_dofadr[joint])
    attributes = {
        "name": model.joint(joint).name
        or f"{body_name(model, int(model.jnt_bodyid[joint]))}_joint",
        "axis": f"0 {1 if data.xaxis[joint][1] > 0.0 else -1} 0",
        "armature": repr(float(model.dof_armature[dof])),
        "damping": repr(float(np.ravel(model.dof_damping[dof])[0])),
    }
    if model.jnt_limited[joint]:
        attributes["range"] = " ".join(repr(float(end)) for end in model.jnt_range[joint])
    return attributes


def _write_inertial(body: Element, link: SectionLink) -> None:
    if link.mass > 0.0:
        ElementTree.SubElement(
            body,
            "inertial",
            pos=_place(link.com - link.anchor),
            mass=repr(link.mass),
            diaginertia=" ".join([repr(link.inertia)] * 3),
        )


def _write_foot(body: Element, foot: SectionFoot, above: complex) -> None:
    size = foot.size
    if foot.kind == "box":
        size = (size[0], 0.03, size[1])
    attributes = {
        "name": foot.name or f"{body.get('name')}_{'sole' if foot.kind == 'box' else 'point'}",
        "type": foot.kind,
        "size": " ".join(repr(value) for value in size),
        "pos": _place(foot.place - above),
        "mass": "0",
        "contype": "0",
        "conaffinity": "1",
        "condim": str(foot.condim),
        "priority": "1",
        "friction": f"{foot.friction:.10g} 0.005 0.0001",
        "solref": "0.002 1",
    }
    ElementTree.SubElement(body, "geom", attributes)


def _place(place: complex, across: float = 0.0) -> str:
    """Write a place in the plane; picometres are rounding of kinematics."""
    return " ".join(repr(round(value, 12) + 0.0) for value in (place.real, across, place.imag))
