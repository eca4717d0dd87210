"""Rods of robots without shapes: they reach from foot to hip, wherever the robot stands."""

import itertools

import mujoco
import numpy as np
import pytest

from neuralgaits.robots import load_robot
from neuralgaits.robots.link_rods import bones
from neuralgaits.robots.mjcf.loader import robot_from_text
from neuralgaits.viewer import stage
from support.pages import ROOT
from support.random_biped import random_biped

EXAMPLES = sorted((ROOT / "examples" / "robots").glob("*.xml"))


def placed(robot):
    """A compiled model, in a pose that is not straight."""
    model = mujoco.MjModel.from_xml_string(robot.layout.xml)
    data = mujoco.MjData(model)
    data.qpos[:] = np.linspace(0.1, 0.5, model.nq)
    mujoco.mj_kinematics(model, data)
    return model, data


def ends(data, bone):
    body = data.body(bone.body)
    return body.xpos + bone.ends @ body.xmat.reshape(3, 3).T


@pytest.mark.parametrize(
    ("links", "torso"), [(1, True), (2, True), (2, False), (3, True), (3, False)]
)
def test_rods_of_a_leg_hang_together_in_any_pose(links, torso):
    robot = robot_from_text(random_biped(3, links, torso=torso), "random")
    model, data = placed(robot)
    found = bones(model, robot.layout)
    assert len(found) == 2 * links + torso
    for leg in (0, 1):
        chain = [ends(data, bone) for bone in found[links * leg : links * (leg + 1)]]
        foot = data.geom(robot.layout.feet[leg]).xpos
        np.testing.assert_allclose(chain[0][0], foot, atol=1e-12)
        for one, following in itertools.pairwise(chain):
            np.testing.assert_allclose(one[1], following[0], atol=1e-12)
        # Joints may lie side by side.
        lengths = [np.linalg.norm((end - start)[[0, 2]]) for start, end in chain]
        np.testing.assert_allclose(lengths, robot.layout.leg_lengths, atol=1e-9)


def test_a_robot_with_shapes_of_its_own_gets_none():
    robot = load_robot("amber3m")
    assert bones(placed(robot)[0], robot.layout) == []


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_the_live_page_draws_every_link(path):
    robot = load_robot(path)
    model = stage._alone(robot.layout)
    feet = len(robot.layout.feet)
    assert model.ngeom >= feet + 2 * len(robot.layout.leg_lengths)
    assert not np.any(model.geom_type == mujoco.mjtGeom.mjGEOM_PLANE)
