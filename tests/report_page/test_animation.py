"""What the page is given to draw is where MuJoCo has it, and the force is Newton's."""

# pyright: reportAttributeAccessIssue=false

import json
import shutil
import subprocess
from pathlib import Path
from xml.etree import ElementTree

import mujoco
import numpy as np
import pytest

from neuralgaits.report import animation, page
from neuralgaits.robots import load_robot
from neuralgaits.robots.mjcf.loader import robot_from_text
from neuralgaits.simulation.setup.plant import build

ASSETS = Path(page.__file__).parent / "assets"


def _states(model, rng, count):
    """MuJoCo states with bodies in motion, far from any contact."""
    qpos = rng.uniform(-0.6, 0.6, (count, model.nq))
    qvel = rng.uniform(-1.0, 1.0, (count, model.nv))
    return np.concatenate([np.zeros((count, 1)), qpos, qvel], axis=1)


def _turned(quat, vector):
    turned = np.zeros(3)
    mujoco.mju_rotVecQuat(turned, np.asarray(vector, float), np.asarray(quat, float))
    return turned


def _world(shape, pose):
    """Place and turning of a shape as the page computes them: turn about +y, then move."""
    x, z, angle = pose
    about_y = np.array([np.cos(angle / 2), 0.0, np.sin(angle / 2), 0.0])
    place = _turned(about_y, shape["pos"]) + np.array([x, 0.0, z])
    quat = np.zeros(4)
    mujoco.mju_mulQuat(quat, about_y, np.asarray(shape["quat"], float))
    return place, quat


@pytest.mark.parametrize("name", ["amber3m", "rabbit"])
def test_every_shape_is_where_mujoco_draws_it(name):
    plant = build(load_robot(name))
    model, rng = plant.model, np.random.default_rng(1)
    states = _states(model, rng, 5)
    moved = animation.motion(model, states)
    shapes = animation.shapes(model, moved, plant.robot.layout)
    drawn = [
        g
        for g in range(model.ngeom)
        if model.geom_group[g] < 3 and model.geom_type[g] != mujoco.mjtGeom.mjGEOM_PLANE
    ]
    assert len(shapes) == len(drawn) > 10
    data = mujoco.MjData(model)
    for frame, state in enumerate(states):
        data.qpos[:] = state[1 : 1 + model.nq]
        mujoco.mj_kinematics(model, data)
        for shape, geom in zip(shapes, drawn, strict=True):
            place, quat = _world(shape, moved.poses[frame][shape["body"]])
            np.testing.assert_allclose(place, data.geom_xpos[geom], atol=1e-4)
            matrix = np.zeros(9)
            mujoco.mju_quat2Mat(matrix, quat)
            np.testing.assert_allclose(matrix, data.geom_xmat[geom], atol=1e-4)


def test_contact_points_are_the_feet():
    plant = build(load_robot("amber3m"))
    model = plant.model
    states = _states(model, np.random.default_rng(2), 3)
    moved = animation.motion(model, states)
    data = mujoco.MjData(model)
    data.qpos[:] = states[2][1 : 1 + model.nq]
    mujoco.mj_kinematics(model, data)
    for name, foot in zip(
        plant.robot.layout.feet,
        animation.contacts(model, moved, plant.robot.layout.feet),
        strict=True,
    ):
        place, _ = _world(foot | {"quat": [1, 0, 0, 0]}, moved.poses[2][foot["body"]])
        np.testing.assert_allclose(place, data.geom(name).xpos, atol=1e-4)
        assert foot["radius"] == pytest.approx(plant.robot.foot_radius)


def test_a_falling_robot_feels_no_ground():
    plant = build(load_robot("amber3m"))
    model = plant.model
    data = mujoco.MjData(model)
    data.qpos[:] = 0.1
    data.qpos[1] = 5.0
    states = []
    for _ in range(60):
        states.append(np.concatenate([[data.time], data.qpos, data.qvel]))
        mujoco.mj_step(model, data)
    moved = animation.motion(model, np.array(states))
    weight = float(np.sum(model.body_mass)) * 9.81
    force = animation.ground_force(moved.momenta, weight, model.opt.timestep)
    np.testing.assert_allclose(force, 0.0, atol=1e-2 * weight)


def test_a_robot_at_rest_weighs_what_it_weighs():
    force = animation.ground_force(np.zeros((4, 2)), 211.0, 0.02)
    np.testing.assert_allclose(force, [[0.0, 211.0]] * 4)


def test_a_robot_without_pictures_is_drawn_as_sticks_between_its_joints():
    tree = ElementTree.fromstring(load_robot("amber3m").layout.xml)
    for body in tree.iter("body"):
        for geom in body.findall("geom"):
            if not geom.get("name", "").startswith("foot"):
                body.remove(geom)
    robot = robot_from_text(ElementTree.tostring(tree, encoding="unicode"), "bare")
    plant = build(robot)
    model = plant.model
    states = _states(model, np.random.default_rng(3), 2)
    moved = animation.motion(model, states)
    shapes = animation.shapes(model, moved, robot.layout)
    sticks = [shape for shape in shapes if shape["kind"] == "capsule"]
    data = mujoco.MjData(model)
    data.qpos[:] = states[1][1 : 1 + model.nq]
    mujoco.mj_kinematics(model, data)
    ends = []
    for side in ("left", "right"):
        hip, knee = data.body(f"thigh_{side}").xpos, data.body(f"shin_{side}").xpos
        ends += [(hip, knee), (knee, data.geom(f"foot_{side}").xpos)]
    middles = [_world(stick, moved.poses[1][stick["body"]])[0] for stick in sticks]
    for one, other in ends:
        distances = [np.linalg.norm(middle - 0.5 * (one + other)) for middle in middles]
        stick = sticks[int(np.argmin(distances))]
        assert min(distances) < 1e-4
        assert 2 * stick["size"][1] == pytest.approx(np.linalg.norm(one - other), abs=1e-4)
    # Hip bars and the torso come on top.
    assert len(sticks) >= len(ends) + 1


@pytest.mark.parametrize("high", [1.0, 1.9, 2.1, 4.9, 5.1, 9.9, 17.3])
def test_an_upright_axis_has_at_least_four_labels(high):
    """One above the other there is room; two labels show no scale."""
    if (node := shutil.which("node")) is None:
        pytest.skip("no JavaScript engine here")
    script = (ASSETS / "player.js").read_text(encoding="utf-8")
    code = (
        "globalThis.document = {getElementById: () => null};"
        f"const tickFor = new Function({json.dumps(script)} + '; return tickFor')();"
        f"console.log(JSON.stringify([true, false].map((up) => tickFor(0, {high}, up))))"
    )
    said = subprocess.run([node, "-e", code], capture_output=True, text=True, check=True).stdout
    upright, across = json.loads(said)
    assert 4 <= high / upright <= 10
    assert 2 <= high / across <= 5.1
