"""Obstacles of a robot file: fixed geoms other than the floor, which no gait and no plant has.

The model walks on one plane, and a plant has floors of its own in place of the file's.
"""

import mujoco
import numpy as np

from neuralgaits.robots.mjcf.compiled import compile_text
from neuralgaits.robots.mjcf.planar_tree import body_name
from neuralgaits.robots.mjcf.skeleton import find_floor


def obstacles_left_out(text: str, name: str) -> tuple[str, ...]:
    """Return one line about the obstacles of a robot file, which are left out; () without any.

    Args:
        text: MJCF of a robot that `robot_from_text` takes.
        name: name of the robot.
    """
    model = compile_text(text, name)
    names = [_name(model, geom) for geom in _obstacles(model)]
    if not names:
        return ()
    most_names = 5
    more = len(names) - most_names
    listed = ", ".join(names[:most_names]) + (f" and {more} more" if more > 0 else "")
    one = len(names) == 1
    return (
        f"{'geom' if one else 'geoms'} {listed} of the world: the robot passes through "
        f"{'it' if one else 'them'}, in the model and in simulations; for stones, stairs or slopes "
        "write simulate --terrain",
    )


def _obstacles(model: mujoco.MjModel) -> list[int]:
    """Return fixed geoms that would touch a geom of the robot in MuJoCo, but for the floor."""
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    floor = find_floor(model, data)
    kind, affinity = model.geom_contype, model.geom_conaffinity
    fixed = model.body_weldid[model.geom_bodyid] == 0
    touches = (kind[:, None] & affinity) | (kind & affinity[:, None])
    meets = np.any(touches[:, ~fixed] != 0, axis=1)
    return [int(geom) for geom in np.flatnonzero(fixed & meets) if geom != floor]


def _name(model: mujoco.MjModel, geom: int) -> str:
    """Return a geom's name, or its number and body where the file gives none."""
    if name := model.geom(geom).name:
        return name
    body = int(model.geom_bodyid[geom])
    return f"number {geom}" + (f" of body {body_name(model, body)}" if body else "")
