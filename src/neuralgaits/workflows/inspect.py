"""Contents of a robot file in the terms of the theory."""

import math
from collections.abc import Sequence

import jax.numpy as jnp
import numpy as np

from neuralgaits.analysis.walking_speeds import size_doubt
from neuralgaits.control.measurement import of_all_motors
from neuralgaits.gait.stepping_robot import SteppingRobot
from neuralgaits.records.inspected import FlatFeetFacts, LinkFacts, MotorFacts, RobotFacts
from neuralgaits.robots.mjcf.loader import bodies_from_text, links_from_text
from neuralgaits.robots.mjcf.world_geoms import obstacles_left_out
from neuralgaits.robots.robot_file import RobotFile
from neuralgaits.robots.robot_source import planar_biped

_HELD_DEG = 15.0
"""Angle at which a torso, or a leg, is held [deg]: as far as a torso leans in the default spec."""


def inspect(robot: SteppingRobot) -> RobotFacts:
    """Describe a loaded robot.

    Leg lengths and hip height are measured to the centre of the foot sphere, or to the ankle of a
    flat foot.

    Returns: a mapping of what `inspect --json` prints; SI units are in the names.
    Raises: InputError for anything but a robot that `load_robot` returned.
    """
    robot = planar_biped(robot)
    layout = robot.layout
    return RobotFacts(
        robot=robot.name,
        links=_links(robot),
        actuators=_actuators(robot),
        coordinates=tuple(robot.joint_names),
        mass_kg=float(robot.mass if robot.feet is None else robot.mass + robot.feet.mass),
        underactuation=robot.n - len(_actuators(robot)),
        torso=None if robot.torso is None else robot.link_names[robot.torso],
        stance_foot=layout.feet[0],
        swing_foot=layout.feet[1],
        hip_height_m=layout.leg_length,
        flat_feet=_flat_feet(robot),
        foot_radius_m=float(robot.foot_radius),
        friction=float(robot.friction),
        gravity_m_s2=float(robot.gravity),
        left_out=obstacles_left_out(layout.xml, robot.name),
        warnings=(
            *_about_lengths(robot),
            *_about_rotors(robot),
            *_about_heels(robot),
            *_about_hip_motors(robot),
        ),
    )


def _about_lengths(robot: RobotFile) -> tuple[str, ...]:
    """Return a line if lengths look as if they were not in metres; () otherwise."""
    doubt = size_doubt(robot)
    return () if doubt is None else (doubt,)


def _about_rotors(robot: SteppingRobot) -> tuple[str, ...]:
    """Return a line if no joint has a rotor's inertia; () otherwise."""
    if np.any(np.asarray(robot.armature) > 0.0):
        return ()
    return (
        "armature is 0 on every joint: the model has no rotors, so each touchdown changes its "
        "joint rates more, and its torques are smaller, than on a robot with geared motors, where "
        'the gait may fall; write armature="J" into each <joint>, with J the rotor\'s inertia '
        "times the gear ratio squared (kg m^2)",
    )


def _about_hip_motors(robot: SteppingRobot) -> tuple[str, ...]:
    """Return a line if the hips' motors hold neither torso nor leg a little off upright; ()."""
    hips = [motor for motor in _actuators(robot) if motor.joint.endswith("hip")]
    links = _links(robot)
    if not hips:
        return ()
    limit = min(motor.torque_limit_nm for motor in hips)
    gravity = float(robot.gravity) * math.sin(math.radians(_HELD_DEG))
    parts = {
        "the torso": sum(
            link.mass_kg * math.hypot(*link.centre_of_mass_m)
            for link in links
            if link.length_m is None
        )
        * gravity,
        "a straight leg": _first_moment(links[-(len(links) // 2) :]) * gravity,
    }
    heavy = [
        f"{name} ({torque:.2g} N m by its weight alone)"
        for name, torque in parts.items()
        if torque > limit
    ]
    if not heavy:
        return ()
    return (
        f"motors of {limit:g} N m at the hips cannot hold {' or '.join(heavy)} {_HELD_DEG:g} "
        "degrees off upright: a gait is unlikely; check ctrlrange times gear, or forcerange, of "
        "the motors, and masses in kg",
    )


def _first_moment(links: Sequence[LinkFacts]) -> float:
    """Return mass times distance from the hip of a straight leg, hip first [kg m]."""
    moment = reached = 0.0
    for link in links:
        length = 0.0 if link.length_m is None else link.length_m
        moment += link.mass_kg * (reached + length - link.centre_of_mass_m[0])
        reached += length
    return moment


def _about_heels(robot: RobotFile) -> tuple[str, ...]:
    """Return a line if soles are longer behind the ankle, as of a robot that faces -x."""
    if robot.feet is None or robot.feet.heel <= robot.feet.toe:
        return ()
    return (
        f"soles reach {1e3 * float(robot.feet.heel):.3g} mm behind the ankle and "
        f"{1e3 * float(robot.feet.toe):.3g} mm ahead: forward is +x; if the robot faces -x, turn "
        "it around",
    )


def _flat_feet(robot: RobotFile) -> FlatFeetFacts | None:
    if robot.feet is None:
        return None
    feet = robot.feet
    return FlatFeetFacts(
        heel_m=float(feet.heel),
        toe_m=float(feet.toe),
        ankle_height_m=float(feet.height),
        mass_kg=float(feet.mass),
    )


def _links(robot: RobotFile) -> tuple[LinkFacts, ...]:
    """Return the links of leg 0 upwards, the torso, then those of leg 1 downwards.

    A flat foot that stands is no link of the model, so only that of leg 1 is among them.
    """
    xml = robot.layout.xml
    leg, torso = links_from_text(xml, robot.name)
    first, second, trunk = bodies_from_text(xml, robot.name)
    bodies = (*first, *(() if trunk is None else (trunk,)), *reversed(second))
    up = [
        (float(mass), float(inertia), complex(com), float(length))
        for mass, inertia, com, length in zip(
            leg.mass, leg.inertia, leg.com, leg.length, strict=True
        )
    ]
    middle = [] if torso is None else [(torso.mass, torso.inertia, complex(torso.com), None)]
    moving = slice(leg.fixed_links, None)
    return tuple(
        LinkFacts(
            name=name,
            length_m=length,
            inertia_kg_m2=float(inertia),
            body=body,
            mass_kg=mass,
            # An upright link points along +z; what is counter-clockwise of it is behind.
            centre_of_mass_m=(com.real, -com.imag + 0.0),
        )
        for name, body, (mass, inertia, com, length) in zip(
            robot.link_names,
            bodies[moving],
            (*up, *middle, *reversed(up))[moving],
            strict=True,
        )
    )


def _actuators(robot: SteppingRobot) -> tuple[MotorFacts, ...]:
    """Return the joints in the order of q, with leg 0 in stance."""
    layout, first = robot.layout, 1 if robot.feet is None else 0
    torques, lower, upper = (
        np.asarray(of_all_motors(robot.layout, jnp.asarray(values)))
        for values in (robot.torque_limit, robot.joint_lower, robot.joint_upper)
    )
    joints = list(zip(layout.leg_joints[0], layout.actuators[0], strict=True))
    other = list(zip(layout.leg_joints[1], layout.actuators[1], strict=True))
    # Without a torso both legs share the one hip joint.
    joints += reversed(other if layout.torso else other[:-1])
    return tuple(
        MotorFacts(
            joint=robot.joint_names[i + first],
            torque_limit_nm=float(torques[i]),
            lower_rad=float(lower[i]),
            upper_rad=float(upper[i]),
            armature_kg_m2=float(robot.armature[i + first]),
            damping_nms_rad=float(robot.damping[i + first]),
            file_joint=joint,
            file_motor=motor,
        )
        for i, (joint, motor) in enumerate(joints)
    )
