"""A gait, and all that its controllers share: the model that they believe in, bounds, joints."""

from dataclasses import dataclass

from neuralgaits.control.controller import Controller
from neuralgaits.control.joint_model import JointModel
from neuralgaits.control.law import AbstractLaw
from neuralgaits.control.law_by_name import law_named
from neuralgaits.gait.joint_inertia import JointResponse
from neuralgaits.gait.policies.commanded_gait import AnyGait
from neuralgaits.gait.reset_residual import ResetCorrection
from neuralgaits.robots import PlanarBiped


@dataclass(frozen=True, eq=False)
class ControlledGait:
    """A gait, and all that its controllers share whatever their law is.

    Attributes:
        robot: the model that the controllers believe in.
        gait: policy and region, or a family of them that takes commands.
        z2_range: momenta of the region (kg m^2/s).
        reset_residual: corrects the impact that the steps of a family begin with.
        joints: rotors and friction that torques are for; None for those of the robot.
    """

    robot: PlanarBiped
    gait: AnyGait
    z2_range: tuple[float, float]
    reset_residual: ResetCorrection = None
    joints: JointModel | None = None

    def under(self, law: str | AbstractLaw) -> Controller:
        """Return the controller under a law, by name or as it is.

        Raises: InputError for another name, SpecError for a gait that the law cannot have.
        """
        return Controller.init(
            self.robot,
            self.gait.policy,
            law_for(law, self.robot, self.gait, self.joints),
            z2_range=self.z2_range,
            reset_residual=self.reset_residual,
            joints=self.joints,
        )


def law_for(
    controller: str | AbstractLaw,
    robot: PlanarBiped,
    gait: AnyGait,
    joints: JointModel | None = None,
) -> AbstractLaw:
    """Return a control law, by name or as it is, with what it keeps of a gait.

    Args:
        controller: law, by name or as an object.
        robot: the model of the gait.
        gait: policy and region, or a family of them.
        joints: rotors and friction that torques are for; None for those of `robot`.

    Raises: InputError for another name, SpecError for a gait that the law cannot have.
    """
    model = robot if joints is None else robot.with_joints(joints.armature, joints.damping)
    return law_named(controller).for_gait(JointResponse(model), gait)
