"""A robot file read as a planar tree: links welded of bodies, joined by hinges across the plane.

Everything is measured in the world at the file's zero coordinates, as complex numbers x + i z,
so it does not matter how the file nests frames, tilts bodies, offsets them along y or turns
joint axes. A link's angle is counter-clockwise seen with +x to the right and +z up; a hinge
about +y turns the other way, hence the minus sign of `Joint.sign`.
"""

from dataclasses import dataclass

import mujoco
import numpy as np

from neuralgaits.errors import RobotError
from neuralgaits.robots.mjcf.model_contents import HINGE, SLIDE, at_zero, joints_on
from neuralgaits.robots.mjcf.refuse_or_note import refuse

_AXIS_TOLERANCE = 1e-6


@dataclass(frozen=True)
class Joint:
    """A hinge from a link to its parent.

    Attributes:
        index: joint number in MuJoCo.
        name: name of the joint.
        anchor: where it sits at zero coordinates, x + i z [m].
        sign: d(counter-clockwise angle of child against parent)/d(joint coordinate).
    """

    index: int
    name: str
    anchor: complex
    sign: float


@dataclass(frozen=True)
class Link:
    """Bodies that move as one.

    Attributes:
        name: name of the first body.
        bodies: body numbers in MuJoCo.
        parent: index of the parent link; None for the root.
        joint: hinge to the parent; for the root, its pitch hinge.
        mass: [kg].
        com: centre of mass at zero coordinates, x + i z [m].
        inertia: about the axis through the centre of mass across the plane [kg m^2].
    """

    name: str
    bodies: tuple[int, ...]
    parent: int | None
    joint: Joint
    mass: float
    com: complex
    inertia: float


@dataclass(frozen=True)
class PlanarTree:
    """The links in file order, root first, and the names of the root's slides along x and z."""

    links: tuple[Link, ...]
    slides: tuple[str, str]

    def children(self, index: int) -> tuple[int, ...]:
        """Links that hang from a link, in file order."""
        return tuple(i for i, link in enumerate(self.links) if link.parent == index)


def body_name(model: mujoco.MjModel, index: int) -> str:
    """A body's name, or its number where the file gives none."""
    return model.body(index).name or f"number {index}"


def joint_name(model: mujoco.MjModel, index: int) -> str:
    """A joint's name.

    Raises: RobotError if the file gives none: logs and controllers find joints by name.
    """
    name = model.joint(index).name
    if not name:
        body = body_name(model, int(model.jnt_bodyid[index]))
        refuse(f"a joint of body {body} has no name: give it one")
        return f"of body {body}"
    return name


def read_tree(model: mujoco.MjModel) -> PlanarTree:
    """Read a compiled model as a planar tree.

    Raises: RobotError naming the body or joint that is not planar, and the remedy.
    """
    if model.nq != model.nv:
        for bad in (i for i in range(model.njnt) if int(model.jnt_type[i]) not in (SLIDE, HINGE)):
            refuse(
                f"joint {joint_name(model, bad)} turns in space: a planar robot has a root of "
                "slide x, slide z and hinge y, and hinges along y elsewhere"
            )
    data = at_zero(model)
    welded = [int(i) for i in model.body_weldid]
    tops = _tops(model)
    roots = [top for top in tops if welded[model.body_parentid[top]] == 0]
    if len(roots) != 1:
        names = ", ".join(body_name(model, top) for top in roots)
        if not roots:
            raise RobotError(
                "expected one moving robot in the file, found none: add a <body> with joints to "
                "<worldbody>"
            )
        raise RobotError(f"expected one moving robot in the file, found {names}: keep one")
    slides, pitch = _root_joints(model, data, roots[0])
    number = {top: i for i, top in enumerate(tops)}
    links = []
    for top in tops:
        is_root = top == roots[0]
        joint = pitch if is_root else _hinge(model, data, top)
        parent = None if is_root else number[welded[model.body_parentid[top]]]
        bodies = tuple(i for i, w in enumerate(welded) if w == top)
        links.append(_link(model, data, bodies, parent, joint))
    return PlanarTree(tuple(links), slides)


def _tops(model: mujoco.MjModel) -> list[int]:
    """Return the bodies that move against their parents, in file order."""
    return sorted({int(top) for top in model.body_weldid} - {0})


def in_plane(vector: np.ndarray) -> complex:
    """Return x + i z of a vector in space."""
    return complex(vector[0], vector[2])


def _link(
    model: mujoco.MjModel,
    data: mujoco.MjData,
    bodies: tuple[int, ...],
    parent: int | None,
    joint: Joint,
) -> Link:
    """Merge welded bodies: masses add, inertias by the parallel-axis theorem."""
    name = body_name(model, bodies[0])
    masses = model.body_mass[list(bodies)]
    mass = float(masses.sum())
    if mass <= 1e-9 * float(model.body_mass.sum()):
        refuse(f"body {name} has no mass: give it an <inertial> or geoms with mass")
        return Link(name, bodies, parent, joint, np.nan, complex(np.nan, np.nan), np.nan)
    coms = [in_plane(data.xipos[i]) for i in bodies]
    com = sum(m * c for m, c in zip(masses, coms, strict=True)) / mass
    inertia = 0.0
    for body, body_mass, body_com in zip(bodies, masses, coms, strict=True):
        axes = data.ximat[body].reshape(3, 3)
        about_y = float(axes[1] ** 2 @ model.body_inertia[body])
        inertia += about_y + float(body_mass) * abs(body_com - com) ** 2
    return Link(name, bodies, parent, joint, mass, complex(com), inertia)


def _hinge(model: mujoco.MjModel, data: mujoco.MjData, body: int) -> Joint:
    """The one hinge of a link below the root."""
    indices = joints_on(model, body)
    if len(indices) != 1:
        refuse(
            f"body {body_name(model, body)} has {len(indices)} joints: below the root each link "
            "turns about one hinge; put a link with mass between them or remove the others"
        )
    return _planar_hinge(model, data, indices[-1])


def _planar_hinge(model: mujoco.MjModel, data: mujoco.MjData, index: int) -> Joint:
    name = joint_name(model, index)
    anchor = in_plane(data.xanchor[index])
    if model.jnt_type[index] == SLIDE:
        refuse(f'joint {name} is a slide: planar robots turn; use type="hinge"')
        return Joint(index, name, anchor, 1.0)
    axis = data.xaxis[index]
    if model.jnt_type[index] != HINGE:
        return Joint(index, name, anchor, 1.0)  # It turns in space, which was said.
    if abs(abs(axis[1]) - 1.0) > _AXIS_TOLERANCE:
        numbers = " ".join(f"{value:.3g}" for value in axis)
        refuse(
            f"joint {name} is not planar: its axis points along ({numbers}); for a hip, knee or "
            'ankle of the plane write axis="0 1 0", else delete the joint and its motor'
        )
    return Joint(index, name, anchor, -1.0 if axis[1] >= 0.0 else 1.0)


def _root_joints(
    model: mujoco.MjModel, data: mujoco.MjData, body: int
) -> tuple[tuple[str, str], Joint]:
    """Names of the slides along x and z, and the pitch hinge after them."""
    name = body_name(model, body)
    remedy = 'slide axis="1 0 0", slide axis="0 0 1", hinge axis="0 1 0", in this order'
    indices = joints_on(model, body)
    kinds = [int(model.jnt_type[i]) for i in indices]
    if kinds == [int(mujoco.mjtJoint.mjJNT_FREE)]:
        return ("", ""), _planar_hinge(model, data, indices[0])
    if kinds != [SLIDE, SLIDE, HINGE]:
        message = f"root body {name} has {len(indices)} joint(s), expected {remedy}"
        if (
            sum(int(model.body_weldid[model.body_parentid[one]]) == body for one in _tops(model))
            < 2
        ):
            # What hangs below is another link of the root, and no leg.
            raise RobotError(f"{message}; where several bodies share them, put them into one")
        refuse(message)
        return ("", ""), Joint(indices[-1], name, in_plane(data.xanchor[indices[-1]]), -1.0)
    slides = {}
    for index in indices[:2]:
        axis = data.xaxis[index]
        for label, component in (("x", 0), ("z", 2)):
            if abs(axis[component] - 1.0) < _AXIS_TOLERANCE:
                slides[label] = joint_name(model, index)
    if len(slides) != 2:
        refuse(f"the slides of root body {name} are not along +x and +z: use {remedy}")
        return ("", ""), _planar_hinge(model, data, indices[2])
    return (slides["x"], slides["z"]), _planar_hinge(model, data, indices[2])
