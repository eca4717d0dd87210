"""A walk of the shipped run with dry friction and heavier rotors that its model does not have."""

import shutil
from pathlib import Path

from neuralgaits.robots import load_robot
from neuralgaits.robots.mjcf.joint_numbers import JointConstants, text_with_joints
from neuralgaits.robots.mjcf.loader import robot_from_text
from neuralgaits.workflows.simulate import simulate
from support.shipped_run import SHIPPED

FRICTION_NM = 1.0
ROTOR_SHARE = 1.2
"""Rotor inertia of the plant over the model's."""


def heavier():
    """Return AMBER-3M with heavier rotors."""
    robot = load_robot("amber3m")
    rotor = JointConstants(ROTOR_SHARE * float(robot.armature[1]), 0.0, 0.0)
    joints = {name: rotor for leg in robot.layout.leg_joints for name in leg}
    return robot_from_text(text_with_joints(robot.layout.xml, robot.name, joints), robot.name)


def walked(folder: Path, steps: int = 14) -> tuple[Path, Path]:
    """Walk a copy of the shipped run. Returns: the run, and the log."""
    run, log = shutil.copytree(SHIPPED, folder / "run"), folder / "walk.csv"
    simulate(run, plant=heavier(), disturb={"joint_friction": FRICTION_NM}, steps=steps, log=log)
    return run, log
