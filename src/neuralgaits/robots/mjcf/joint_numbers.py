"""A robot file with other rotor inertias and damping at its joints."""

from collections.abc import Mapping
from typing import NamedTuple

from neuralgaits.robots.mjcf.edit import MjcfEdit
from neuralgaits.robots.mjcf.loader import robot_from_text


class JointConstants(NamedTuple):
    """Constants of a joint that its robot file has, and one that it has not.

    Attributes:
        armature: rotor inertia [kg m^2].
        damping: viscous friction [N m s/rad].
        friction: dry friction [N m], which only a comment of the file names: its model has none.
    """

    armature: float
    damping: float
    friction: float


def text_with_joints(text: str, name: str, joints: Mapping[str, JointConstants]) -> str:
    """Return a robot file's text with other constants of some joints.

    Args:
        text: MJCF of a robot that can be loaded.
        name: name of the robot, unless the file names its model.
        joints: constants by name of the joint.

    Raises: RobotError if the result cannot be loaded.
    """
    edit = MjcfEdit(text, name)
    for number, element in enumerate(edit.elements.joints):
        joint = edit.model.joint(number).name
        if joint not in joints:
            continue
        constants = joints[joint]
        element.set("armature", repr(constants.armature))
        element.set("damping", repr(constants.damping))
        edit.say(
            f"joint {joint}: armature {constants.armature:.6g} kg m^2, damping "
            f"{constants.damping:.6g} N m s/rad; dry friction of {constants.friction:.6g} N m is "
            "not part of the model"
        )
    title = "Numbers of joints identified from logs by neuralgaits fit:"
    changed = edit.text(title)
    robot_from_text(changed, name)
    return changed
