"""Refusal of everything in a robot file that the closed form would silently leave out.

The model is rigid links, rotors, viscous joint friction, gravity and motors. A spring or a
tendon in the file would act in MuJoCo and not in the theory, so gaits would be wrong without
a word. Better to say so.
"""

import mujoco
import numpy as np

from neuralgaits.errors import RobotError
from neuralgaits.robots.mjcf.planar_tree import body_name
from neuralgaits.robots.mjcf.refuse_or_note import refuse


def refuse_unmodelled_physics(model: mujoco.MjModel) -> None:
    """Check that a compiled robot file holds only what the closed form describes.

    Raises: RobotError naming what would be ignored, and the remedy.
    """
    _refuse_world(model)
    _refuse_couplings(model)
    for joint in range(model.njnt):
        parent = int(model.body_parentid[model.jnt_bodyid[joint]])
        _refuse_joint(model, joint, is_root=int(model.body_weldid[parent]) == 0)


def _refuse_world(model: mujoco.MjModel) -> None:
    gravity = model.opt.gravity
    if gravity[0] != 0.0 or gravity[1] != 0.0 or not gravity[2] < 0.0:
        numbers = " ".join(f"{value:g}" for value in gravity)
        refuse(f'gravity is ({numbers}): use <option gravity="0 0 -9.81"/>')
    if model.opt.density != 0.0 or model.opt.viscosity != 0.0:
        refuse("the file has air or water: remove density and viscosity from <option>")
    off = mujoco.mjtDisableBit
    needed = off.mjDSBL_GRAVITY | off.mjDSBL_CONTACT | off.mjDSBL_ACTUATION
    if model.opt.disableflags & needed:
        refuse("the file switches gravity, contact or actuation off: remove that from <flag>")
    sleeps = getattr(mujoco.mjtEnableBit, "mjENBL_SLEEP", None)
    if sleeps is not None and model.opt.enableflags & sleeps:
        refuse("the file lets bodies sleep, which stops robots that stand: remove that from <flag>")
    if model.opt.disableactuator:
        refuse("the file switches motors off: remove actuatorgroupdisable from <option>")
    for body in np.flatnonzero(model.body_gravcomp):
        name = body_name(model, int(body))
        refuse(f"body {name} has gravity compensation: remove its gravcomp")


def _refuse_couplings(model: mujoco.MjModel) -> None:
    for count, what, element in (
        (model.neq, "equality constraints", "equality"),
        (model.ntendon, "tendons", "tendon"),
        (model.nflex, "flexible bodies", "deformable"),
        # The feet meet the floor by their own friction, and nothing else touches.
        (model.npair, "contact pairs", "contact"),
    ):
        if count:
            refuse(
                f"the file has {what}, which the closed form would ignore: "
                f"remove its <{element}> section"
            )


def refuse_loops(model: mujoco.MjModel) -> None:
    """Refuse constraints that close a loop of links: without them it would be another mechanism.

    Raises: RobotError naming the two bodies.
    """
    loops = (int(mujoco.mjtEq.mjEQ_CONNECT), int(mujoco.mjtEq.mjEQ_WELD))
    for number in range(model.neq):
        if int(model.eq_type[number]) not in loops:
            continue
        ends = _bodies_of(model, number)
        # One that holds the robot to the world is no loop.
        if all(model.body_weldid[end] for end in ends):
            names = " and ".join(body_name(model, end) for end in ends)
            raise RobotError(
                f"an equality constraint closes a loop of bodies {names}: expected legs that are "
                "chains; take the rods of the loop out of the file, and its constraint"
            )


def _bodies_of(model: mujoco.MjModel, number: int) -> tuple[int, int]:
    """Return the two bodies of a connect or weld constraint."""
    ends = (int(model.eq_obj1id[number]), int(model.eq_obj2id[number]))
    if int(model.eq_objtype[number]) == int(mujoco.mjtObj.mjOBJ_SITE):
        return int(model.site_bodyid[ends[0]]), int(model.site_bodyid[ends[1]])
    return ends


def refuse_excluded(model: mujoco.MjModel, foot: int, floor: int) -> None:
    """Refuse a foot whose body is excluded from contact with the floor's: it would fall through.

    Bodies of the robot may be excluded from each other: they meet nothing but the floor anyway.

    Raises: RobotError naming both bodies.
    """
    ends = sorted(int(model.geom_bodyid[geom]) for geom in (foot, floor))
    for signature in model.exclude_signature:
        # Both bodies' numbers in one, the smaller in the upper half.
        if ends == sorted((int(signature) >> 16, int(signature) & 0xFFFF)):
            names = " and ".join(model.body(end).name for end in ends)
            refuse(
                f"foot {model.geom(foot).name} cannot touch the floor: the file excludes contact "
                f"between {names}; remove that <exclude>"
            )


def _refuse_joint(model: mujoco.MjModel, joint: int, *, is_root: bool) -> None:
    name, dof = model.joint(joint).name, int(model.jnt_dofadr[joint])
    forces = {
        "stiffness": _any(model, "jnt_stiffness", joint) or _any(model, "jnt_stiffnesspoly", joint),
        "frictionloss": _any(model, "dof_frictionloss", dof),
        "a damping polynomial": _any(model, "dof_dampingpoly", dof),
        "a margin": _any(model, "jnt_margin", joint),
    }
    for what, present in forces.items():
        if present:
            refuse(f"joint {name} has {what}, which the closed form ignores: remove it")
    if is_root and (model.dof_damping[dof] or model.dof_armature[dof]):
        refuse(
            f"root joint {name} has damping or armature, but the robot is free in the plane: "
            "remove both"
        )
    if is_root and model.jnt_limited[joint]:
        refuse(f"root joint {name} has a range, but the robot is free in the plane: remove it")


def _any(model: mujoco.MjModel, field: str, index: int) -> bool:
    """Return whether a field is set; a field that this MuJoCo does not have yet counts as unset."""
    values = getattr(model, field, None)
    return values is not None and bool(np.any(values[index]))
