"""Find the torso, the two legs and the feet among the links.

A biped with a torso has the torso as root and two chains of equal length hanging from one point,
the hip. Without a torso the root is the top link of one leg: its own chain is then one link
shorter than the chain that hangs from the hip. What a foot is, `foot_geoms` decides.
"""

from dataclasses import dataclass

import mujoco
import numpy as np

from neuralgaits.errors import RobotError
from neuralgaits.robots.mjcf.foot_geoms import Foot, flat_foot, is_flat_foot, point_foot, touching
from neuralgaits.robots.mjcf.model_contents import at_zero
from neuralgaits.robots.mjcf.planar_tree import PlanarTree
from neuralgaits.robots.mjcf.refuse_or_note import attempt, refuse

_HIP_TOLERANCE_M = 1e-6


@dataclass(frozen=True)
class Skeleton:
    """The tree's links by role.

    Attributes:
        torso: index of the torso link, or None.
        legs: for each leg in file order (the root's own leg first), links from the lowest up.
        hip: place of the hip at zero coordinates, x + i z [m].
        feet: feet of the two legs.
    """

    torso: int | None
    legs: tuple[tuple[int, ...], tuple[int, ...]]
    hip: complex
    feet: tuple[Foot, Foot]


def read_skeleton(model: mujoco.MjModel, tree: PlanarTree) -> Skeleton:
    """Sort the links of a planar tree into torso and legs.

    Raises: RobotError naming the body that does not fit, and the remedy.
    """
    data = at_zero(model)
    floor = find_floor(model, data)
    if floor is None:
        raise RobotError(
            'no level floor in the file: add <geom type="plane" size="0 0 0.1"/> to <worldbody>'
        )
    _count_feet(model, tree, floor)
    torso, legs, hip = find_legs(tree)
    flat = [is_flat_foot(model, data, tree, leg, floor) for leg in legs]
    if any(flat):
        _refuse_odd_pair(tree, legs, flat, torso)
    read, ends = (flat_foot, 2) if any(flat) else (point_foot, 0)
    feet = [attempt(_missing_foot(ends), read, model, data, tree, leg[0], floor) for leg in legs]
    return Skeleton(torso, legs, hip, (feet[0], feet[1]))


def _missing_foot(ends: int) -> Foot:
    """Return a foot without numbers, with so many ends of a sole, for one that was refused."""
    return Foot("", complex(np.nan, np.nan), np.nan, np.nan, (np.nan,) * ends)


def _chain(tree: PlanarTree, top: int) -> tuple[int, ...]:
    """Return the chain that starts at a link and goes down, lowest link first."""
    links = [top]
    while below := tree.children(links[-1]):
        if len(below) > 1:
            names = " and ".join(tree.links[i].name for i in below)
            refuse(
                f"body {tree.links[links[-1]].name} carries {names} on joints: a leg is a chain; "
                "weld all but one of them"
            )
        links.append(min(below, key=lambda link: _lowest(tree, link)))
    return tuple(reversed(links))


def _lowest(tree: PlanarTree, top: int) -> float:
    """Return the height of the lowest centre of mass of a link and of those below it (m)."""
    return min(tree.links[top].com.imag, *(_lowest(tree, one) for one in tree.children(top)), 1e9)


def find_legs(
    tree: PlanarTree, max_links: int = 3
) -> tuple[int | None, tuple[tuple[int, ...], tuple[int, ...]], complex]:
    """Sort the links into a torso and two chains, as `Skeleton` has them.

    Args:
        tree: tree of the robot.
        max_links: most links of a leg.

    Returns: torso or None, links of each leg from the lowest up, hip at zero coordinates.
    Raises: RobotError naming the body that does not fit.
    """
    tops = tree.children(0)
    root = tree.links[0].name
    if len(tops) not in (1, 2):
        message = (
            f"root body {root} carries {len(tops)} jointed bodies: expected two legs; "
            "weld other bodies to the torso"
        )
        if not tops:
            raise RobotError(message)
        refuse(message)
        tops = tuple(sorted(sorted(tops, key=lambda top: _lowest(tree, top))[:2]))
    # A root with one child is itself a whole leg: no chain of its own hangs below it.
    own_chain = _chain(tree, tops[0]) if len(tops) == 2 else tuple[int, ...]()
    first, second = own_chain, _chain(tree, tops[-1])
    if max(len(first), len(second)) > max_links:
        longest = max(first, second, key=len)
        refuse(
            f"the leg of body {tree.links[longest[-1]].name} has {len(longest)} links: at most "
            f"{max_links} are treated; weld some"
        )
    if len(first) == len(second):
        return 0, (first, second), _common_hip(tree, first[-1], second[-1])
    own, other = sorted((first, second), key=len)
    hip = tree.links[other[-1]].joint.anchor
    one_point = bool(own) and abs(tree.links[own[-1]].joint.anchor - hip) <= _HIP_TOLERANCE_M
    if len(other) - len(own) == 1 and not one_point:
        return None, ((*own, 0), other), hip
    raise RobotError(
        f"legs of unequal data: below root body {root} hang chains of {len(first)} and "
        f"{len(second)} links; make the legs equal"
    )


def _common_hip(tree: PlanarTree, first: int, second: int) -> complex:
    joints = tree.links[first].joint, tree.links[second].joint
    gap = abs(joints[0].anchor - joints[1].anchor)
    if gap > _HIP_TOLERANCE_M:
        refuse(
            f"joints {joints[0].name} and {joints[1].name} are {gap:.3g} m apart in the plane: "
            "both hips must be at one point (offsets along y are fine)"
        )
    return joints[0].anchor


def find_floor(model: mujoco.MjModel, data: mujoco.MjData) -> int | None:
    """Return the geom number of the horizontal plane the robot walks on; None without one."""
    for geom in range(model.ngeom):
        if model.geom_type[geom] != mujoco.mjtGeom.mjGEOM_PLANE:
            continue
        if model.geom_contype[geom] == 0 and model.geom_conaffinity[geom] == 0:
            continue
        if abs(data.geom_xmat[geom].reshape(3, 3)[2, 2] - 1.0) < 1e-9:
            return geom
    return None


def _count_feet(model: mujoco.MjModel, tree: PlanarTree, floor: int) -> None:
    ends = [
        link.name
        for i, link in enumerate(tree.links)
        if (not tree.children(i) or (i == 0 and len(tree.children(0)) == 1))
        and any(
            model.geom_type[g] == mujoco.mjtGeom.mjGEOM_SPHERE
            for g in touching(model, link.bodies, floor)
        )
    ]
    if len(ends) > 2:
        refuse(
            f"found {len(ends)} feet, on bodies {', '.join(ends)}: expected two; "
            'set contype="0" conaffinity="0" on other spheres'
        )


def _refuse_odd_pair(
    tree: PlanarTree,
    legs: tuple[tuple[int, ...], tuple[int, ...]],
    flat: list[bool],
    torso: int | None,
) -> None:
    """Refuse one flat foot beside a point foot, and flat feet without a torso.

    Raises: RobotError naming the body.
    """
    remedy = "`neuralgaits inspect FILE --planarise OUT.xml` gives both legs point feet"
    if not all(flat):
        names = [tree.links[leg[0]].name for leg in legs]
        name, other = names if flat[0] else reversed(names)
        raise RobotError(
            f"body {name} is a flat foot on an ankle, and body {other} is not: expected two equal "
            f"feet; {remedy}"
        )
    if torso is None:
        refuse(
            f"body {tree.links[legs[0][0]].name} is a flat foot of a robot without a torso, which "
            f"is not treated: {remedy}"
        )
