"""Reasons why a family's formulas do not describe a robot file, each with its remedy.

They are about joints, motors and the world, whatever the mechanism. A family asks for those that
its formulas need, and lists all that it finds at once.
"""

from collections.abc import Iterator

import mujoco
import numpy as np

from neuralgaits.robots.mjcf.model_contents import JOINT_TRANSMISSIONS, at_zero, joint_label

SHORTEST_S, LONGEST_S = 1e-5, 0.05
"""Least and largest timestep: fewer steps a second do not balance, more take for ever."""


def joint_axis(model: mujoco.MjModel, joint: int) -> np.ndarray:
    """Return the axis of a joint in the world where all coordinates are 0. [3]."""
    return at_zero(model).xaxis[joint].copy()


def joint_problems(model: mujoco.MjModel, joint: int) -> Iterator[str]:
    """Say what a joint has that no formula has, or a number that no joint has."""
    name, dof = joint_label(model, joint), model.jnt_dofadr[joint]
    for what, value in (
        ("frictionloss", model.dof_frictionloss[dof]),
        ("stiffness", model.jnt_stiffness[joint]),
        ("a margin", model.jnt_margin[joint]),
    ):
        if value:
            yield f"joint {name} has {what}, which is not modelled: remove it"
    for what, value in (
        ("damping", model.dof_damping[dof]),
        ("armature", model.dof_armature[dof]),
    ):
        if not value >= 0.0:
            yield f"joint {name} has {what} {value:g}, expected 0 or more: mend that number"


def timestep_problems(model: mujoco.MjModel) -> Iterator[str]:
    """Say whether the timestep is one to control with."""
    if not SHORTEST_S <= model.opt.timestep <= LONGEST_S:
        yield (
            f"the timestep is {model.opt.timestep:g} s, expected {SHORTEST_S:g} to {LONGEST_S:g}: "
            'use <option timestep="0.002"/>'
        )


def contact_problems(model: mujoco.MjModel) -> Iterator[str]:
    """Say which geoms can collide, for a family without contacts."""
    if (pair := colliding(model)) is not None:
        yield (
            f"geoms {pair[0]} and {pair[1]} can collide, which no formula here has: add "
            '<flag contact="disable"/> to <option>, or contype="0" conaffinity="0" to one'
        )


def world_problems(model: mujoco.MjModel) -> Iterator[str]:
    """Say what couples joints or bodies in ways that no formula has."""
    # MuJoCo before 3.4 lets nothing sleep.
    sleeps = getattr(mujoco.mjtEnableBit, "mjENBL_SLEEP", None)
    for count, what in (
        (model.npair, "contact pairs"),
        (model.nflex, "flexible bodies"),
        (sleeps is not None and model.opt.enableflags & sleeps, "bodies that may sleep"),
        (model.neq, "equality constraints"),
        (model.ntendon, "tendons"),
        (model.opt.density != 0.0 or model.opt.viscosity != 0.0, "air or water"),
    ):
        if count:
            yield f"the file has {what}, which no formula here has: remove it"


def motor_problems(
    model: mujoco.MjModel, driven: int, driven_words: str, other_words: str
) -> Iterator[str]:
    """Say what is not one plain motor with limits on one joint.

    Args:
        model: model of the file.
        driven: number of that joint.
        driven_words: what moves there, as in "the cart".
        other_words: what moves elsewhere, as in "the pole".
    """
    on_driven = 0
    for motor in range(model.nu):
        name = model.actuator(motor).name or f"actuator {motor}"
        joint = int(model.actuator_trnid[motor, 0])
        on_joint = int(model.actuator_trntype[motor]) in JOINT_TRANSMISSIONS
        if not on_joint or joint != driven:
            where = "acts on no joint"
            if on_joint:
                where = f"acts on {other_words} ({joint_label(model, joint)})"
            yield f"motor {name} {where}, expected one on {driven_words} alone: delete it"
            continue
        on_driven += 1
        yield from plain_motor_problems(model, motor, name)
    if on_driven != 1:
        yield f"expected one motor on {driven_words}, found {on_driven}: keep one"


def plain_motor_problems(model: mujoco.MjModel, motor: int, name: str) -> Iterator[str]:
    """Say why an actuator is no plain motor with a limit in both directions."""
    plain = (
        model.actuator_gaintype[motor] == int(mujoco.mjtGain.mjGAIN_FIXED)
        and model.actuator_biastype[motor] == int(mujoco.mjtBias.mjBIAS_NONE)
        and model.actuator_dyntype[motor] == int(mujoco.mjtDyn.mjDYN_NONE)
    )
    # MuJoCo before 3.4 has no delays.
    delay = getattr(model, "actuator_delay", None)
    if not plain:
        yield f"actuator {name} is no plain motor: make it <motor>"
    elif delay is not None and bool(delay[motor] != 0.0):
        yield f"motor {name} has a delay, which no formula here has: remove it"
    elif not 0.0 < force_limit(model, motor) < np.inf:
        yield (
            f"motor {name} has no limit in both directions, or no gear: add "
            'ctrlrange="-1 1" or its own, and a gear that is not 0'
        )


def force_limit(model: mujoco.MjModel, motor: int) -> float:
    """Return the largest force on its joint that a motor has in both directions [N or N m]."""
    gear, gain = model.actuator_gear[motor, 0], model.actuator_gainprm[motor, 0]
    joint, limits = model.actuator_trnid[motor, 0], [np.inf]
    if model.actuator_ctrllimited[motor]:
        low, high = model.actuator_ctrlrange[motor]
        limits.append(abs(gear * gain) * min(-low, high))
    if model.actuator_forcelimited[motor]:
        low, high = model.actuator_forcerange[motor]
        limits.append(abs(gear) * min(-low, high))
    if model.jnt_actfrclimited[joint]:
        low, high = model.jnt_actfrcrange[joint]
        limits.append(min(-low, high))
    return float(min(limits))


def colliding(model: mujoco.MjModel) -> tuple[str, str] | None:
    """Return the names of two geoms that can collide; None if no two can.

    A thin wall may lie between the places where accelerations are compared. MuJoCo's own rules:
    https://mujoco.readthedocs.io/en/stable/computation/index.html#collision-detection
    """
    if model.opt.disableflags & mujoco.mjtDisableBit.mjDSBL_CONTACT:
        return None
    weld = model.body_weldid[model.geom_bodyid]
    above = model.body_weldid[model.body_parentid[weld]]
    kinds, meets = model.geom_contype, model.geom_conaffinity
    excluded = set(model.exclude_signature.tolist())
    for first in range(model.ngeom):
        rest = np.arange(first + 1, model.ngeom)
        alike = (kinds[first] & meets[rest]) | (kinds[rest] & meets[first])
        family = (weld[first] == above[rest]) | (weld[rest] == above[first])
        # A child may meet its parent if that is the world.
        family &= (weld[first] != 0) & (weld[rest] != 0)
        if model.opt.disableflags & mujoco.mjtDisableBit.mjDSBL_FILTERPARENT:
            family[:] = False
        for second in rest[(alike != 0) & (weld[first] != weld[rest]) & ~family]:
            low, high = sorted((int(model.geom_bodyid[first]), int(model.geom_bodyid[second])))
            if (low << 16) + high not in excluded:
                names = [model.geom(one).name or f"number {one}" for one in (first, second)]
                return names[0], names[1]
    return None
