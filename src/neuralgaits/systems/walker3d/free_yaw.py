"""A biped whose yaw is free in MuJoCo: the torsional friction of its feet holds it, or does not."""

import mujoco
import numpy as np

from neuralgaits._types import Float


def free_yaw(spec: mujoco.MjSpec, torso: int) -> None:
    """Add a hinge about the vertical between the torso's slides and its roll and pitch."""
    body = list(spec.bodies)[torso]
    roll, pitch = list(body.joints)[3:]
    last = body.add_joint()
    copied = ("type", "pos", "axis", "armature", "damping", "stiffness", "frictionloss", "limited")
    for field in copied:
        setattr(last, field, getattr(pitch, field))
    # Hinges turn in the order of a file: the first of them becomes the yaw, and the others move on.
    names = roll.name, pitch.name
    roll.name, pitch.name, last.name = "free yaw of the torso", *names
    pitch.axis, roll.axis = roll.axis.copy(), (0.0, 0.0, 1.0)
    roll.limited = mujoco.mjtLimited.mjLIMITED_FALSE


def resist_twisting(model: mujoco.MjModel, contacts: list[int], friction: float) -> None:
    """Give contacts of these geoms torsional friction: their moment a newton of force [m]."""
    model.geom_condim[contacts] = np.maximum(model.geom_condim[contacts], 4)
    model.geom_friction[contacts, 1] = friction


def along_heading(
    velocity: Float[np.ndarray, "N 3"], yaw: Float[np.ndarray, " N"]
) -> Float[np.ndarray, "N 3"]:
    """Return velocities in the world as components forward, to the left and up of robots."""
    x, y, up = velocity.T
    cosine, sine = np.cos(yaw), np.sin(yaw)
    return np.stack([cosine * x + sine * y, cosine * y - sine * x, up], axis=1)
