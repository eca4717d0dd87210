"""Motors of a sagittal section: one on each kept hinge, with the limit that the file gives."""

from xml.etree import ElementTree

import mujoco

from neuralgaits.errors import RobotError
from neuralgaits.robots.mjcf.joint_motors import choose_motor, said_of
from neuralgaits.robots.mjcf.model_contents import JOINT_TRANSMISSIONS
from neuralgaits.robots.mjcf.motors_and_ranges import plain_motor
from neuralgaits.robots.mjcf.planar_tree import body_name
from neuralgaits.robots.mjcf.refuse_or_note import attempt
from neuralgaits.robots.mjcf.section_plan import SectionPlan


def write_motors(
    section: ElementTree.Element, model: mujoco.MjModel, plan: SectionPlan
) -> list[str]:
    """Write a motor for each kept hinge.

    Args:
        section: <actuator> of the new file.
        model: the robot of the file.
        plan: which joints are kept.

    Returns: what changed, one line each. Raises: RobotError naming a joint with several motors, or
    a motor that is none.
    """
    lines: list[str] = []
    joints_kept = {*plan.legs[0], *plan.legs[1]}
    for joint in (*plan.legs[0], *plan.legs[1]):
        attempt(None, _write_motor, section, model, joint, lines)
    gone = [one for one in range(model.nu) if _joint_of(model, one) not in joints_kept]
    if gone:
        names = ", ".join(model.actuator(one).name or f"number {one}" for one in gone)
        lines.append(f"actuators removed, since what they act on does not move: {names}")
    return lines


def _joint_of(model: mujoco.MjModel, actuator: int) -> int | None:
    """Return the joint that an actuator acts on; None of one on something else."""
    on_joint = int(model.actuator_trntype[actuator]) in JOINT_TRANSMISSIONS
    return int(model.actuator_trnid[actuator, 0]) if on_joint else None


def _write_motor(
    section: ElementTree.Element, model: mujoco.MjModel, joint: int, lines: list[str]
) -> None:
    motors = [one for one in range(model.nu) if _joint_of(model, one) == joint]
    name = model.joint(joint).name or f"{body_name(model, int(model.jnt_bodyid[joint]))}_joint"
    if not motors:
        return  # The loader names the joint.
    choice = choose_motor(model, joint, motors)
    if choice.kept is None:
        labels = ", ".join(model.actuator(one).name or f"number {one}" for one in motors)
        raise RobotError(
            f"joint {name} has {len(motors)} motors ({labels}): expected one; keep one"
        )
    lines += said_of(model, name, choice)
    label = model.actuator(choice.kept).name or name
    gear, limit = 1.0, choice.limit
    if limit is None:
        motor = plain_motor(model, choice.kept, joint)
        gear, limit = motor.gear, motor.limit
    end = limit / abs(gear)
    attributes = {
        "name": label,
        "joint": name,
        "gear": repr(gear),
        "ctrlrange": f"{-end!r} {end!r}",
    }
    ElementTree.SubElement(section, "motor", attributes)
