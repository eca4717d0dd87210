"""Describe an exported controller in lines, for the header in C and the metadata of ONNX."""

import numpy as np

from neuralgaits._control_laws import CONTROL_LAWS
from neuralgaits.control import AbstractLaw
from neuralgaits.control.law import CompiledLaw, compiled_law
from neuralgaits.control.safeguard import joint_ranges
from neuralgaits.errors import InputError
from neuralgaits.export.design import Design
from neuralgaits.gait.commands import Command


def prose(design: Design) -> list[str]:
    """Describe the controller in lines: joint order, limits, gains, hashes."""
    robot, origin = design.controller.robot, design.origin
    lines = [
        f"A walking gait of {robot.name}, spec {origin.spec}, by neuralgaits {origin.version}.",
        "Written by a program: change the gait, not this file.",
        "",
        f"robot file  sha256 {origin.robot_sha256}",
        f"policy      sha256 {origin.policy_sha256}",
        f"proof       {_proof(design)}",
        f"monitor     {_monitor(design)}",
        *_identified(design),
        "",
        "Coordinates q, stance leg first [rad]: " + ", ".join(robot.joint_names),
        "Actuated are all but the first."
        if robot.feet is None
        else "Actuated are all but the first, the stance ankle, whose torque is the policy's own.",
        "",
        "Joints of each leg as in the robot file, lowest first; leg 0, then leg 1:",
        *_joints(design),
        "",
        f"Ticks of {design.controller.period_s:g} s. Laws:",
    ]
    for name, controller in design.controllers.items():
        lines.append(f"  {name}: {gains(controller.law)}")
    lines += _laws_proved(design)
    if design.commands:
        lines += ["", "Commands, latched at each touchdown:"]
        lines += [f"  [{i}] {_command(c)}" for i, c in enumerate(design.commands)]
    return [
        *lines,
        "",
        "z = (hip ahead of the stance foot [m], angular momentum about it [kg m^2/s]), both",
        "positive forward. Angles are positive counter-clockwise, with forward to the right.",
    ]


def _command(command: Command) -> str:
    """Describe a command: its range, and its largest change."""
    change = command.largest_change
    rate = "" if change is None else f", at most {change:g} more or less from step to step"
    return f"{command.name}: {command.low:g} to {command.high:g} {command.unit}{rate}"


def exported_form(law: AbstractLaw) -> CompiledLaw:
    """Return a law as exports have it. Raises: InputError if they do not have it."""
    form = compiled_law(law)
    if form is None or not form.exported:
        names = ", ".join(name for name, entry in CONTROL_LAWS.items() if entry.exported)
        raise InputError(
            f"expected a law that C is written for ({names}), found {type(law).__name__}"
        )
    return form


def gains(law: AbstractLaw) -> str:
    """Describe a law in words. Raises: InputError if exports do not have it."""
    form = exported_form(law)
    note = "" if form.measure_z2 else ", told z2 = 0"
    return f"{form.words}, policy asked every {law.hold_ticks} ticks{note}"


def _proof(design: Design) -> str:
    origin = design.origin
    if origin.proof_sha256 is None:
        return "none"
    about = "of gait and model, not of this code"
    verdict = f"stated {origin.proof_verdict}; check-proof bounds its boxes again"
    return f"sha256 {origin.proof_sha256}, {verdict}: {about}"


def _laws_proved(design: Design) -> list[str]:
    """Say of which law, bandwidth and clock level 5 of the proof file is."""
    if not design.law_proofs:
        return []
    return [
        "",
        "Level 5 of the proof file, of these laws in exact arithmetic, at the true state of the",
        "robot file's robot, while no fault, no blending and no limit of torque rates acts:",
        *(f"  {one.words}" for one in design.law_proofs),
    ]


def _monitor(design: Design) -> str:
    if design.monitor is None:
        return "none"
    levels = ", ".join(map(str, design.monitor.levels))
    return f"monitor.h, of the sets of level{'s' * (len(levels) > 1)} {levels}"


def _identified(design: Design) -> list[str]:
    """Describe the identified joints that torques are for."""
    joints, leg = design.controller.joints, design.leg_joints
    if joints is None:
        return []
    numbers = (
        ("rotors", joints.armature, "kg m^2"),
        ("damping", joints.damping, "N m s/rad"),
        ("dry friction", joints.friction, "N m"),
    )
    words = "; ".join(
        f"{what} {', '.join(f'{value:.4g}' for value in np.asarray(values)[:leg])} {unit}"
        for what, values, unit in numbers
    )
    digest = design.origin.joints_sha256
    return [
        f"joints      {'' if digest is None else f'sha256 {digest}, '}identified from logs,",
        f"            lowest first: {words}",
    ]


def _joints(design: Design) -> list[str]:
    layout = design.controller.robot.layout
    low, high = joint_ranges(design.controller.robot)
    limit = np.abs(design.by_leg(design.controller.torque_limit))
    return [
        f"  [{leg}][{i}] {name}, motor {layout.actuators[leg][i]}: "
        f"{low[leg][i]:.4g} to {high[leg][i]:.4g} rad, torque at most {limit[leg][i]:.4g} N m"
        for leg, joints in enumerate(layout.leg_joints)
        for i, name in enumerate(joints)
    ]
