"""Build bodies and joints of a compiled robot file in Drake.

In MuJoCo a body has any number of joints, one after the other; in Drake a joint connects two
bodies. Between the joints of one body there are bodies without mass.
"""

# pyright: reportMissingImports=false, reportAttributeAccessIssue=false
# Drake is an extra, and MuJoCo ships no type stubs.

from typing import Any

import mujoco
import numpy as np
from pydrake.math import RigidTransform, RotationMatrix
from pydrake.multibody.tree import (
    FixedOffsetFrame,
    PdControllerGains,
    PrismaticJoint,
    RevoluteJoint,
    RotationalInertia,
    SpatialInertia,
    WeldJoint,
)


class Tree:
    """Bodies and joints, by their numbers in the compiled file.

    Attributes:
        bodies: Drake's bodies; floors are left out.
        joints: joints of one degree of freedom each.
    """

    def __init__(self, plant: Any, model: mujoco.MjModel):
        """Add bodies and joints to a plant that is not finalized yet."""
        self._plant, self._model = plant, model
        self.bodies: dict[int, Any] = {0: plant.world_body()}
        self.joints: list[Any] = [None] * model.njnt
        for number in range(1, model.nbody):
            if model.body_mocapid[number] < 0:
                self._add(number)

    def _add(self, number: int) -> None:
        plant, model = self._plant, self._model
        parent = self.bodies[int(model.body_parentid[number])]
        place = pose(model.body_pos[number], model.body_quat[number])
        name, first = f"body {number}", int(model.body_jntadr[number])
        body = plant.AddRigidBody(name, inertia(model, number))
        self.bodies[number] = body
        joints = range(first, first + int(model.body_jntnum[number]))
        if not joints:
            plant.AddJoint(WeldJoint(name, parent.body_frame(), body.body_frame(), place))
        for joint in joints:
            last = joint == joints[-1]
            child = body if last else plant.AddRigidBody(f"joint {joint}", SpatialInertia.Zero())
            self._join(joint, parent, place, child)
            parent, place = child, RigidTransform()

    def _join(self, number: int, parent: Any, place: RigidTransform, child: Any) -> None:
        """Add a joint.

        Args:
            number: number in the compiled file.
            parent: body that carries the joint.
            place: pose of the child in the parent with the joint at its zero.
            child: body that the joint moves.
        """
        plant, model = self._plant, self._model
        anchor = RigidTransform(np.array(model.jnt_pos[number]))
        on_parent = plant.AddFrame(_frame(f"joint {number} on parent", parent, place @ anchor))
        on_child = plant.AddFrame(_frame(f"joint {number} on child", child, anchor))
        slides = model.jnt_type[number] == mujoco.mjtJoint.mjJNT_SLIDE
        kind = PrismaticJoint if slides else RevoluteJoint
        dof, zero = int(model.jnt_dofadr[number]), model.qpos0[int(model.jnt_qposadr[number])]
        joint = plant.AddJoint(
            kind(
                name=f"joint {number}",
                frame_on_parent=on_parent,
                frame_on_child=on_child,
                axis=np.array(model.jnt_axis[number]),
                damping=float(model.dof_damping[dof]),
            )
        )
        if model.jnt_limited[number]:
            low, high = model.jnt_range[number] - zero
            joint.set_position_limits([low], [high])
        self.joints[number] = joint


def add_rotors(plant: Any, model: mujoco.MjModel, tree: Tree) -> None:
    """Add the reflected inertia of rotors, and dry friction as a damper that slips.

    Drake has one rotor a joint, so that one of its actuators is both; motor torques are applied
    to the joints themselves.
    """
    for number, joint in enumerate(tree.joints):
        dof = int(model.jnt_dofadr[number])
        rotor, friction = float(model.dof_armature[dof]), float(model.dof_frictionloss[dof])
        if not (rotor or friction):
            continue
        actuator = plant.AddJointActuator(f"rotor {number}", joint, friction or np.inf)
        actuator.set_default_rotor_inertia(rotor)
        actuator.set_default_gear_ratio(1.0)
        if friction:
            # Damping that the joint's dry friction limits: 2 N m are reached at 2 mrad/s.
            damping = 1e3  # [N m s/rad]
            actuator.set_controller_gains(PdControllerGains(p=0.0, d=damping))


def inertia(model: mujoco.MjModel, number: int) -> SpatialInertia:
    """Return mass, centre of mass and inertia of a body, in its frame."""
    mass = float(model.body_mass[number])
    if mass == 0.0:
        return SpatialInertia.Zero()
    principal = pose(model.body_ipos[number], model.body_iquat[number])
    central = RotationalInertia(*map(float, model.body_inertia[number]))
    return SpatialInertia.MakeFromCentralInertia(
        mass, principal.translation(), central.ReExpress(principal.rotation())
    )


def pose(place: np.ndarray, quaternion: np.ndarray) -> RigidTransform:
    """Return the transform of a place [m] and a unit quaternion, w first."""
    turn = np.zeros(9)
    mujoco.mju_quat2Mat(turn, np.array(quaternion))
    return RigidTransform(RotationMatrix(turn.reshape(3, 3)), np.array(place))


def _frame(name: str, body: Any, place: RigidTransform) -> Any:
    return FixedOffsetFrame(name, body.body_frame(), place)
