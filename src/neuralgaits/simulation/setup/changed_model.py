"""A model of MuJoCo with what `PlantChanges` says of masses, motors, joints and friction."""

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import mujoco
import numpy as np

from neuralgaits._types import Float
from neuralgaits.robots.mjcf.model_contents import at_zero
from neuralgaits.simulation.setup.disturbance import PlantChanges


class ModelParts(NamedTuple):
    """Numbers of the parts of a model that disturbances change.

    Attributes:
        contacts: geoms whose friction counts at a foot.
        joints: joints with a motor.
        gears: torque on its joint per unit of control, of each motor [N m].
    """

    contacts: Sequence[int]
    joints: Sequence[int]
    gears: Mapping[int, float]


def change_model(
    model: mujoco.MjModel, parts: ModelParts, changes: PlantChanges, friction: float | None
) -> None:
    """Change a model in place; where the torso's weight is, is left to `shift_weight`.

    Args:
        model: model that is changed.
        parts: its bodies, joints and motors.
        changes: changes of masses, motors and joints.
        friction: coefficient of the feet; None keeps that of the model.
    """
    if friction is not None:
        model.geom_friction[list(parts.contacts), 0] = friction
    if changes.torque_limit is not None:
        for motor, gear in parts.gears.items():
            reach = changes.torque_limit / abs(gear)
            limited = model.actuator_ctrllimited[motor]
            low, high = model.actuator_ctrlrange[motor] if limited else (-reach, reach)
            model.actuator_ctrlrange[motor] = (max(low, -reach), min(high, reach))
            model.actuator_ctrllimited[motor] = True
    model.dof_frictionloss[model.jnt_dofadr[list(parts.joints)]] += changes.joint_friction
    model.body_mass[:] *= changes.mass_scale
    model.body_inertia[:] *= changes.mass_scale
    # Derived inertial constants follow the edited ones.
    mujoco.mj_setConst(model, mujoco.MjData(model))


def shift_weight(model: mujoco.MjModel, root: int, shift: Float[np.ndarray, "3"]) -> None:
    """Move the centre of mass of a body with all that is welded to it.

    Args:
        model: model that is changed.
        root: the body.
        shift: displacement in the world where all joints are at 0 [m].
    """
    data = at_zero(model)
    bodies = [
        i for i in range(model.nbody) if i and model.body_weldid[i] == model.body_weldid[root]
    ]
    total = sum(float(model.body_mass[i]) for i in bodies)
    # Moving one body of the welded torso moves the whole torso's centre of mass.
    heaviest = max(bodies, key=lambda i: float(model.body_mass[i]))
    moved = shift * total / float(model.body_mass[heaviest])
    model.body_ipos[heaviest] += data.xmat[heaviest].reshape(3, 3).T @ moved
    mujoco.mj_setConst(model, mujoco.MjData(model))
