"""All problems of a robot file at once, beside the first one at which the loader stops.

The rules in words, in the order of `note_problems`; each is checked by the function named:

- `compile_what_can_be`: MuJoCo compiles the file, and no mass, inertia or density is negative.
- `refuse_unphysical`: every number has a size that a robot can have, and gravity is not zero.
- `refuse_odd_keyframes`: a keyframe has a number for every coordinate, rate and motor.
- `read_tree`: one moving robot; its root slides along x and z and turns about y, every other link
  turns about one named hinge along y and has mass.
- `refuse_unmodelled_physics`: gravity points down and acts; no air, springs, dry friction of
  joints, tendons, equality constraints, flexible bodies or contact pairs; the root is free.
- `read_skeleton`: a level floor; two legs, each a chain of at most three links from one hip, with
  or without a torso; two feet of one kind, points or flat ones.
- `leg_data`: both legs have equal lengths, masses, inertias, rotors, damping, torque limits, ranges
  and feet, each of a size that a robot can have.
- `read_motor`, `read_range`: every joint but the root's has one plain, named motor with a torque
  limit, and a range of 0.1 rad to two turns.
- `refuse_other_actuators`: no actuator acts on anything else.
"""

from pathlib import Path

import mujoco

from neuralgaits.robots.mjcf.legs import leg_data, leg_joints, link_directions
from neuralgaits.robots.mjcf.lenient_compilation import compile_what_can_be
from neuralgaits.robots.mjcf.loader import robot_text
from neuralgaits.robots.mjcf.motors_and_ranges import read_motor, read_range, refuse_other_actuators
from neuralgaits.robots.mjcf.physical_numbers import refuse_odd_keyframes, refuse_unphysical
from neuralgaits.robots.mjcf.planar_tree import PlanarTree, read_tree
from neuralgaits.robots.mjcf.refuse_or_note import all_noted, attempt
from neuralgaits.robots.mjcf.refused_physics import refuse_unmodelled_physics
from neuralgaits.robots.mjcf.skeleton import read_skeleton


def problems_of_file(source: str | Path) -> tuple[str, ...]:
    """Return every problem of a robot file, one line each; () for one that can be loaded.

    Args:
        source: name of a built-in robot, or path of an MJCF file.
    """
    with all_noted() as noted:
        text = attempt(None, robot_text, source)
        if text is not None:
            note_problems(*text)
    return tuple(noted)


def note_problems(text: str, name: str) -> None:
    """Note every problem of MJCF text; the caller notes and does not raise."""
    model, text = compile_what_can_be(text, name)
    if model is None:
        return
    attempt(None, refuse_unphysical, model)
    attempt(None, refuse_odd_keyframes, text, model)
    tree = attempt(None, read_tree, model)
    attempt(None, refuse_unmodelled_physics, model)
    if tree is not None:
        attempt(None, _note_problems_of_legs, model, tree)
    joints = _joints_below_the_root(model)
    for joint in joints:
        attempt(None, read_motor, model, joint)
        attempt(None, read_range, model, joint)
    if joints:
        attempt(None, refuse_other_actuators, model, joints)


def _note_problems_of_legs(model: mujoco.MjModel, tree: PlanarTree) -> None:
    skeleton = read_skeleton(model, tree)
    lines = link_directions(tree, skeleton)
    leg_data(model, tree, skeleton, lines, leg_joints(model, tree, skeleton, lines))


def _joints_below_the_root(model: mujoco.MjModel) -> list[int]:
    """Return the hinges below the root, whose joints may belong to a chain of bodies."""
    welded = [int(one) for one in model.body_weldid]
    moving_bodies = sorted(set(welded) - {0})
    parent = {body: welded[model.body_parentid[body]] for body in moving_bodies}
    last = 0
    joints = 0
    roots = set[int]()
    root_joints = 3
    while joints < root_joints:
        below = [body for body in moving_bodies if parent[body] == last]
        if len(below) != 1:
            break
        last = below[0]
        roots.add(last)
        joint_types = model.jnt_type[model.jnt_bodyid == last]
        free = mujoco.mjtJoint.mjJNT_FREE in joint_types
        joints += root_joints if free else len(joint_types)
    hinges = model.jnt_type == mujoco.mjtJoint.mjJNT_HINGE
    owners = [welded[body] for body in model.jnt_bodyid]
    return [joint for joint in range(model.njnt) if hinges[joint] and owners[joint] not in roots]
