"""Masses of a sagittal section: bodies welded together, seen from the side, both legs alike."""

from dataclasses import dataclass, replace

import mujoco
import numpy as np

from neuralgaits.robots.mjcf.planar_tree import body_name, in_plane
from neuralgaits.robots.mjcf.section_plan import MASSLESS_KG, SectionPlan, links_of_bodies


@dataclass(frozen=True)
class SectionLink:
    """A link of the section, at the posture, in the world.

    Attributes:
        name: name of its first body in the file.
        joint: kept hinge that moves it; -1 for the base.
        bodies: bodies that are welded into it.
        anchor: place of that hinge, x + i z [m]; of the base, of its body.
        across: y of that place [m].
        mass: [kg].
        com: centre of mass, x + i z [m].
        inertia: about y through the centre of mass [kg m^2].
    """

    name: str
    joint: int
    bodies: tuple[int, ...]
    anchor: complex
    across: float
    mass: float
    com: complex
    inertia: float


def section_links(
    model: mujoco.MjModel, data: mujoco.MjData, plan: SectionPlan
) -> dict[int, SectionLink]:
    """Return the links of a section by the joint that moves each; -1 for the base."""
    links = links_of_bodies(model, plan)
    return {
        joint: _link(model, data, plan, joint, tuple(b for b, j in links.items() if j == joint))
        for joint in (-1, *plan.legs[0], *plan.legs[1])
    }


def _link(
    model: mujoco.MjModel,
    data: mujoco.MjData,
    plan: SectionPlan,
    joint: int,
    bodies: tuple[int, ...],
) -> SectionLink:
    body_index = plan.base if joint < 0 else int(model.jnt_bodyid[joint])
    place = data.xpos[body_index] if joint < 0 else data.xanchor[joint]
    heavy = [body for body in bodies if model.body_mass[body] > MASSLESS_KG]
    mass = float(model.body_mass[heavy].sum())
    moment = sum((model.body_mass[body] * in_plane(data.xipos[body]) for body in heavy), 0j)
    com = moment / mass if mass > 0.0 else in_plane(place)
    inertia = 0.0
    for body in heavy:
        axes = data.ximat[body].reshape(3, 3)
        inertia += float(axes[1] ** 2 @ model.body_inertia[body])
        inertia += float(model.body_mass[body]) * abs(in_plane(data.xipos[body]) - com) ** 2
    return SectionLink(
        body_name(model, body_index),
        joint,
        bodies,
        in_plane(place),
        float(place[1]),
        mass,
        complex(com),
        float(inertia),
    )


def equal_legs(
    links: dict[int, SectionLink], plan: SectionPlan
) -> tuple[dict[int, SectionLink], tuple[str, ...]]:
    """Give both legs the mean of their numbers where these differ by a rounding.

    Returns: the links, and a line with the largest difference; () if the legs are equal. Links that
    differ by more stay as they are: whoever loads the file names them.
    """
    if len(plan.legs[0]) != len(plan.legs[1]):
        return links, ()
    scale = max(_extent([links[joint] for joint in leg]) for leg in plan.legs)
    equal, largest = dict(links), 0.0
    # Largest rounding of a file or its drawing: of masses and inertias as a share, of places in
    # lengths of the leg.
    largest_rounding = 0.01
    for one, other in zip(*plan.legs, strict=True):
        a, b = links[one], links[other]
        differences = (
            abs(a.mass - b.mass) / max(a.mass, b.mass, 1e-12),
            abs(a.inertia - b.inertia) / max(a.inertia, b.inertia, 1e-12),
            abs(a.com - b.com) / scale,
            abs(a.anchor - b.anchor) / scale,
        )
        if max(differences) > largest_rounding:
            return links, ()
        largest = max(largest, *differences)
        mean = {
            "mass": (a.mass + b.mass) / 2.0,
            "inertia": (a.inertia + b.inertia) / 2.0,
            "com": (a.com + b.com) / 2.0,
            "anchor": (a.anchor + b.anchor) / 2.0,
        }
        equal[one], equal[other] = replace(a, **mean), replace(b, **mean)
    if largest <= 1e-9:
        # Rounding of kinematics: one leg's numbers for both, and nothing to say.
        return equal, ()
    change = f"legs: mean of left and right, which differ by {100.0 * largest:.2g} % at most"
    return equal, (change,)


def _extent(links: list[SectionLink]) -> float:
    """Return the length of a chain of links (m)."""
    places = [link.anchor for link in links] + [links[-1].com]
    return max(float(np.sum(np.abs(np.diff(places)))), 1e-6)
