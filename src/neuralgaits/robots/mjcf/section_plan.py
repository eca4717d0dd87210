"""Parts of a robot in space that move in the plane: its root, and the joints of its two legs.

The legs are the two chains whose ends reach lowest at the posture. Hinges about y on them are
kept; every other joint is welded. What both legs hang from is the torso.
"""

from dataclasses import dataclass

import mujoco
import numpy as np

from neuralgaits._types import Float
from neuralgaits.errors import RobotError
from neuralgaits.robots.mjcf.low_points import low_points
from neuralgaits.robots.mjcf.planar_tree import body_name

AXIS_TOLERANCE = 1e-3
"""Largest error of the axis of a hinge that is kept."""


@dataclass(frozen=True)
class SectionPlan:
    """Joints and bodies by role.

    Attributes:
        base: body that both legs hang from, or that is the upper link of one.
        root: joints that move the robot as a whole, from the world down.
        legs: kept hinges of each leg, from the hip down.
        across: joints on the legs that are welded, since they do not turn in the plane.
        others: joints that are no part of a leg, which are welded, too.
        feet: body of the last moving link of each leg.
        carriages: bodies with mass of a chain that carries the robot.
    """

    base: int
    root: tuple[int, ...]
    legs: tuple[tuple[int, ...], tuple[int, ...]]
    across: tuple[int, ...]
    others: tuple[int, ...]
    feet: tuple[int, int]
    carriages: tuple[int, ...]


def posture(
    model: mujoco.MjModel, weld: frozenset[str]
) -> tuple[Float[np.ndarray, " q"], dict[str, float]]:
    """Return the coordinates at which joints are welded, and those of the named ones.

    Free joints stay where the file has them; joints named in `weld` are at the file's first
    keyframe, if it has one; everything else is at zero.
    """
    qpos, named = np.zeros(model.nq), {}
    free, ball = int(mujoco.mjtJoint.mjJNT_FREE), int(mujoco.mjtJoint.mjJNT_BALL)
    for joint in range(model.njnt):
        start, kind = int(model.jnt_qposadr[joint]), int(model.jnt_type[joint])
        size = {free: 7, ball: 4}.get(kind, 1)
        place = slice(start, start + size)
        if kind in (free, ball):
            qpos[place] = model.qpos0[place]
        elif model.joint(joint).name in weld:
            qpos[start] = model.key_qpos[0, start] if model.nkey else 0.0
            named[model.joint(joint).name] = float(qpos[start])
    return qpos, named


def at_posture(model: mujoco.MjModel, qpos: Float[np.ndarray, " q"]) -> mujoco.MjData:
    """Return the model's data at these coordinates."""
    data = mujoco.MjData(model)
    data.qpos[:] = qpos
    mujoco.mj_kinematics(model, data)
    return data


def plan_section(model: mujoco.MjModel, data: mujoco.MjData, weld: frozenset[str]) -> SectionPlan:
    """Find the legs of a robot, and sort its joints.

    Args:
        model: the robot, which may move in space.
        data: data of the model at the posture.
        weld: names of joints that are welded before legs are looked for.

    Raises: RobotError if it is no biped that walks along x.
    """
    names = {model.joint(joint).name for joint in range(model.njnt)}
    if unknown := sorted(weld - names):
        raise RobotError(
            f"--weld: expected joints of the robot, found {', '.join(unknown)}: name some of "
            f"{', '.join(sorted(names - {''}))}"
        )
    moving = [joint for joint in range(model.njnt) if model.joint(joint).name not in weld]
    tops = _tops(model, moving)
    feet = _feet(model, data, tops)
    one, other = (_path(model, tops, foot) for foot in feet)
    base = next(top for top in one if top in other)
    chains = [path[: path.index(base)][::-1] for path in (one, other)]
    above = one[one.index(base) :][::-1]
    legs, across = [], []
    for chain in chains:
        joints = [joint for top in chain for joint in _joints_of(model, moving, top)]
        planar = [joint for joint in joints if _turns_in_plane(model, data, joint)]
        legs.append(tuple(planar))
        across += [joint for joint in joints if joint not in planar]
    if base == 0:
        base = _hanging_from(model, (one[-2], other[-2]))
    root, rails = _root_of(model, data, moving, above)
    _refuse_odd_legs(model, data, legs, across)
    used = {*root, *across, *legs[0], *legs[1]}
    carriages = [
        body
        for body in range(1, model.nbody)
        if tops[body] in rails and model.body_mass[body] > MASSLESS_KG
    ]
    return SectionPlan(
        base,
        tuple(root),
        (legs[0], legs[1]),
        tuple(across),
        tuple(joint for joint in moving if joint not in used),
        feet,
        tuple(carriages),
    )


def _root_of(
    model: mujoco.MjModel, data: mujoco.MjData, moving: list[int], above: list[int]
) -> tuple[list[int], set[int]]:
    """Return the joints that move the robot as a whole, and the bodies of a chain that carry it.

    Those are all joints down to the one that completes x, z and pitch: a free joint alone, or the
    last of slides and a hinge. Joints below it, as of a waist, are part of the robot.

    Args:
        model: the robot.
        data: data of the model at the posture.
        moving: joints that are not welded.
        above: moving bodies from the world down to the base.
    """
    joints: list[int] = []
    for place, top in enumerate(above):
        joints += _joints_of(model, moving, top)
        if _moves_in_plane(model, data, joints):
            return joints, set(above[:place]) - {0}
    return joints, set(above[:-1]) - {0}


def _moves_in_plane(model: mujoco.MjModel, data: mujoco.MjData, joints: list[int]) -> bool:
    """Return whether joints move a body along x and z and turn it about y."""
    kinds = {joint: int(model.jnt_type[joint]) for joint in joints}
    slides = [joint for joint in joints if kinds[joint] == int(mujoco.mjtJoint.mjJNT_SLIDE)]
    directions = np.array([data.xaxis[joint][[0, 2]] for joint in slides]).reshape(-1, 2)
    pitches = any(_turns_in_plane(model, data, joint) for joint in joints)
    free = int(mujoco.mjtJoint.mjJNT_FREE) in kinds.values()
    return free or (pitches and np.linalg.matrix_rank(directions, tol=AXIS_TOLERANCE) == 2)


MASSLESS_KG = 1e-8
"""Largest mass of a body that stands for a frame."""


def links_of_bodies(model: mujoco.MjModel, plan: SectionPlan) -> dict[int, int]:
    """Return the link of each body of the robot: the kept hinge that moves it, or -1 for the base.

    Bodies of the world are not among them; those between world and base are part of the base.
    """
    hinge = {int(model.jnt_bodyid[joint]): joint for leg in plan.legs for joint in leg}
    links: dict[int, int] = {}
    first = min((int(model.jnt_bodyid[joint]) for joint in plan.root), default=plan.base)
    for body in range(1, model.nbody):
        parent = int(model.body_parentid[body])
        if body in hinge:
            links[body] = hinge[body]
        elif parent in links:
            links[body] = links[parent]
        elif body in (first, plan.base):
            links[body] = -1
    return links


def _tops(model: mujoco.MjModel, moving: list[int]) -> list[int]:
    """Return for each body the body above it that moves against its parent; 0 for the world's."""
    moving_bodies = {int(model.jnt_bodyid[joint]) for joint in moving}
    tops = [0]
    for body in range(1, model.nbody):
        tops.append(body if body in moving_bodies else tops[int(model.body_parentid[body])])
    return tops


def _path(model: mujoco.MjModel, tops: list[int], top: int) -> list[int]:
    """Return a moving body and those above it, the world's 0 at last."""
    path = [top]
    while path[-1]:
        path.append(tops[int(model.body_parentid[path[-1]])])
    return path


def _hanging_from(model: mujoco.MjModel, tops: tuple[int, int]) -> int:
    """Return the body, fixed to the world, that two legs hang from. Raises: RobotError if none."""
    roots = [int(model.body_rootid[top]) for top in tops]
    if roots[0] != roots[1] or roots[0] in tops:
        names = " and ".join(body_name(model, top) for top in tops)
        raise RobotError(f"legs {names} hang from the world: expected both below one body")
    return roots[0]


def _joints_of(model: mujoco.MjModel, moving: list[int], body: int) -> list[int]:
    return [joint for joint in moving if int(model.jnt_bodyid[joint]) == body]


def _feet(model: mujoco.MjModel, data: mujoco.MjData, tops: list[int]) -> tuple[int, int]:
    """Return the moving bodies at the lower ends of the two legs."""
    groups = sorted(set(tops) - {0})
    reach = {top: _lowest(model, data, tops, top) for top in groups}
    if not reach:
        raise RobotError("expected joints of two legs, found none: check the file's joints")
    lowest = min(reach.values())
    height = max(float(data.xpos[1:, 2].max()) - lowest, 1e-6)
    uneven = 0.05 * height  # Largest height of a foot over the lowest one.
    low = [top for top in groups if reach[top] <= lowest + uneven]
    above = {one for top in low for one in _path(model, tops, top)[1:]}
    ends = [top for top in low if top not in above]
    if len(ends) == 1:
        ends = sorted({*ends, *(top for top in low if top == _path(model, tops, top)[-2])})
    if len(ends) != 2:
        names = ", ".join(body_name(model, top) for top in ends)
        raise RobotError(
            f"found {len(ends)} chain{'' if len(ends) == 1 else 's'} that reach"
            f"{'es' if len(ends) == 1 else ''} the floor at zero coordinates ({names}): expected "
            "the two legs of a biped; remove or weld what is no leg"
        )
    return ends[0], ends[1]


def _lowest(model: mujoco.MjModel, data: mujoco.MjData, tops: list[int], top: int) -> float:
    """Return the height of the lowest point of what moves with a body (m)."""
    bodies = [body for body in range(1, model.nbody) if tops[body] == top]
    geoms = [g for g in range(model.ngeom) if int(model.geom_bodyid[g]) in bodies]
    origins = float(data.xpos[bodies, 2].min())
    lowest = [float(low_points(model, data, geom)[:, 1].min()) for geom in geoms]
    return min([*lowest, origins])


def _turns_in_plane(model: mujoco.MjModel, data: mujoco.MjData, joint: int) -> bool:
    hinge = model.jnt_type[joint] == mujoco.mjtJoint.mjJNT_HINGE
    return bool(hinge and abs(abs(data.xaxis[joint][1]) - 1.0) <= AXIS_TOLERANCE)


def _refuse_odd_legs(
    model: mujoco.MjModel,
    data: mujoco.MjData,
    legs: list[tuple[int, ...]],
    across: list[int],
) -> None:
    """Refuse legs with different numbers of hinges in the plane, or with none.

    Raises: RobotError naming joints.
    """
    counts = [len(leg) for leg in legs]
    if counts[0] == counts[1] and counts[0]:
        return
    if across:
        axis = " ".join(f"{value:.3g}" for value in data.xaxis[across[0]])
        name = model.joint(across[0]).name
        raise RobotError(
            f"joint {name} is not planar: its axis points along ({axis}), and the legs have "
            f"{counts[0]} and {counts[1]} hinges about y: expected as many in both; forward is +x, "
            "so hips, knees and ankles turn about y"
        )
    if abs(counts[0] - counts[1]) > 1 or not max(counts):
        raise RobotError(
            f"legs of unequal data: they have {counts[0]} and {counts[1]} hinges about y; make the "
            "legs equal"
        )
