"""Layout of a robot file: where the generalised coordinates live in it."""

from dataclasses import dataclass
from types import ModuleType
from typing import Any


@dataclass(frozen=True)
class MjcfLayout:
    """Places of the generalised coordinates in the robot file.

    Leg 0 and leg 1 are the legs in file order; a stance leg is named by that number. Without a
    torso leg 0 is the one whose top link is the root. Joints of a leg are listed from the lowest
    up to the hip; the single hip joint of a biped without a torso belongs to both legs, with
    opposite signs.

    Attributes:
        xml: the robot file's text, compilable from any folder.
        root_joints: names of the slide-x, slide-z and pitch joints of the root.
        root_origin: the pitch axis when the file's coordinates are zero, (x, z) [m].
        pitch_sign: +1 if positive pitch in the file is counter-clockwise (tips to -x).
        root_angle: up-angle of the root link when the file's pitch is zero [rad]; a torso's
            up-angle is its pitch, so 0 there.
        root_to_hip: vector from the pitch axis to the hip where the pitch is zero, (x, z) [m].
        torso: whether the root is a torso; else it is the top link of leg 0.
        leg_lengths: lengths of a leg's links, lowest first [m]. [k]
        leg_joints: for each leg, its joint names.
        leg_joint_signs: d(joint coordinate here)/d(joint coordinate in the file).
        leg_joint_offsets: value of the joint coordinate here when the file's is zero [rad].
        feet: foot geom name of leg 0 and leg 1.
        actuators: for each leg, actuator names in the order of leg_joints.
        gears: for each leg, torque on the joint coordinate here per unit of control [N m].
        ankles: whether the lowest joint of a leg is the ankle of a flat foot, which leg_lengths
            leaves out.
    """

    xml: str
    root_joints: tuple[str, str, str]
    root_origin: tuple[float, float]
    pitch_sign: float
    root_angle: float
    root_to_hip: tuple[float, float]
    torso: bool
    leg_lengths: tuple[float, ...]
    leg_joints: tuple[tuple[str, ...], tuple[str, ...]]
    leg_joint_signs: tuple[tuple[float, ...], tuple[float, ...]]
    leg_joint_offsets: tuple[tuple[float, ...], tuple[float, ...]]
    feet: tuple[str, str]
    actuators: tuple[tuple[str, ...], tuple[str, ...]]
    gears: tuple[tuple[float, ...], tuple[float, ...]]
    ankles: bool = False

    @property
    def joints_of_leg(self) -> int:
        """Number of joints of a leg, its hip included."""
        return len(self.leg_joints[0])

    @property
    def leg_length(self) -> float:
        """Length of the straight leg, without a flat foot [m]."""
        return float(sum(self.leg_lengths))

    def hip_arm(self, turn: Any, xp: ModuleType) -> tuple[Any, Any]:
        """Vector from the pitch axis to the hip, and its derivative by pitch. [..., 2] (m).

        Args:
            turn: pitch since the file's is zero, counter-clockwise positive [rad]. [...]
            xp: `numpy`, or `jax.numpy` inside a compiled function.
        """
        x, z = self.root_to_hip
        sine, cosine = xp.sin(turn), xp.cos(turn)
        arm = xp.stack([x * cosine - z * sine, x * sine + z * cosine], axis=-1)
        return arm, xp.stack([-arm[..., 1], arm[..., 0]], axis=-1)
