"""Names, joints and places of a compiled model, whatever the robot."""

import mujoco

SLIDE, HINGE = int(mujoco.mjtJoint.mjJNT_SLIDE), int(mujoco.mjtJoint.mjJNT_HINGE)
"""Kinds of joints with one coordinate."""
JOINT_TRANSMISSIONS = (int(mujoco.mjtTrn.mjTRN_JOINT), int(mujoco.mjtTrn.mjTRN_JOINTINPARENT))
"""Kinds of transmissions of motors that act on a joint."""


def model_name(model: mujoco.MjModel, name: str) -> str:
    """Return the name that a file gives its model, or that of the file if it gives none."""
    own = model.names.split(b"\0")[0].decode(errors="replace")
    return name if own in ("", "MuJoCo Model") else own


def joint_label(model: mujoco.MjModel, joint: int) -> str:
    """Return the name of a joint for a message, or its number."""
    return model.joint(joint).name or f"number {joint}"


def joints_on(model: mujoco.MjModel, body: int) -> list[int]:
    """Return a body's joints, the outermost first."""
    first = int(model.body_jntadr[body])
    return list(range(first, first + int(model.body_jntnum[body])))


def at_zero(model: mujoco.MjModel) -> mujoco.MjData:
    """Return the places of bodies and joints where all coordinates are 0."""
    data = mujoco.MjData(model)
    data.qpos[:] = 0.0
    mujoco.mj_kinematics(model, data)
    mujoco.mj_comPos(model, data)
    return data
