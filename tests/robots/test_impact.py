"""The reset map: conservation laws, an independent solve, published gaits, MuJoCo's contact."""

import mujoco
import numpy as np
import pytest

from neuralgaits.robots import PlanarBiped, dynamics, load_robot
from neuralgaits.robots.mjcf.loader import robot_from_text
from neuralgaits.robots.mjcf_state import StateMap
from support.batched import batched
from support.floating_base import FloatingBase, plastic_impact, read_back
from support.published_gaits import GAITS

IMPACT = batched(PlanarBiped.impact)
FOOT = batched(PlanarBiped.swing_foot)
ENERGY = batched(PlanarBiped.kinetic_energy)
MOMENTUM = batched(dynamics.angular_momentum)
VELOCITY = batched(dynamics.centre_of_mass_velocity)


def gait_robot(gait: dict) -> PlanarBiped:
    """The identified model with the torso mass the gait was published with."""
    text = load_robot("amber3m").layout.xml
    assert text.count('mass="13"') == 1
    return robot_from_text(text.replace('mass="13"', f'mass="{gait["torso_mass_kg"]}"'), "gait")


def gait_state(values: list[float]) -> tuple[np.ndarray, np.ndarray]:
    """Joint coordinates and rates of a published state: base first in both halves."""
    return np.array(values[2:7]), np.array(values[9:14])


def random_states(robot: PlanarBiped, count: int) -> tuple[np.ndarray, np.ndarray]:
    rng = np.random.default_rng(5)
    return rng.uniform(-1.0, 1.0, (count, robot.n)), rng.normal(0.0, 2.0, (count, robot.n))


def test_equals_the_floating_base_solve(robot: PlanarBiped) -> None:
    """State and impulse against a KKT solve of MuJoCo's mass matrix, legs relabelled by name."""
    count = 50
    q, dq = random_states(robot, count)
    after = IMPACT(robot, q, dq)
    base = FloatingBase.of(robot)
    stance = np.arange(count) % 2
    qpos, qvel = base.states.to_mjcf(q, dq, stance)
    solved = [plastic_impact(base, qpos[i], qvel[i], 1 - stance[i]) for i in range(count)]
    qvel_after = np.stack([velocity for velocity, _ in solved])
    q_after, dq_after = read_back(robot, base.states, qpos, qvel_after, 1 - stance)
    np.testing.assert_allclose(after.q, q_after, atol=1e-13)
    for i, (_, impulse) in enumerate(solved):
        largest = np.max(np.abs(dq_after[i]))
        np.testing.assert_allclose(after.dq[i], dq_after[i], atol=1e-10 * largest)
        np.testing.assert_allclose(after.impulse[i], impulse, atol=1e-10 * np.max(np.abs(impulse)))


def test_momentum_balances_and_energy_is_lost(robot: PlanarBiped) -> None:
    q, dq = random_states(robot, 200)
    after = IMPACT(robot, q, dq)
    before_z2, after_z2 = MOMENTUM(robot, q, dq), MOMENTUM(robot, after.q, after.dq)
    foot, v_com = FOOT(robot, q), VELOCITY(robot, q, dq)
    moved = robot.mass * (foot[:, 0] * v_com[:, 1] - foot[:, 1] * v_com[:, 0])
    np.testing.assert_allclose(after_z2, before_z2 + moved, atol=1e-11 * np.max(np.abs(after_z2)))
    gained = robot.mass * (VELOCITY(robot, after.q, after.dq) - v_com)
    np.testing.assert_allclose(after.impulse, gained, atol=1e-12 * np.max(np.abs(gained)))
    energy = ENERGY(robot, q, dq)
    assert np.all(ENERGY(robot, after.q, after.dq) <= energy + 1e-12)


def test_relabelling_swaps_legs_and_undoes_itself(robot: PlanarBiped) -> None:
    swap = robot.relabel
    np.testing.assert_array_equal(swap @ swap, np.eye(robot.n))
    q, _ = random_states(robot, 20)
    there, back = FOOT(robot, q), FOOT(robot, q @ swap.T)
    np.testing.assert_allclose(back, -there, atol=1e-14)


@pytest.mark.parametrize("speed", GAITS)
def test_published_gait_has_the_published_impact(speed: str) -> None:
    gait = GAITS[speed]
    robot = gait_robot(gait)
    after = robot.impact(*gait_state(gait["x_minus"]))
    q_plus, dq_plus = gait_state(gait["x_plus"])
    np.testing.assert_allclose(after.dq, dq_plus, atol=1e-4)
    np.testing.assert_allclose(after.q, q_plus, atol=1e-7)


@pytest.mark.parametrize("speed", GAITS)
def test_momentum_agrees_with_contact_in_mujoco(speed: str) -> None:
    """z2 once MuJoCo's soft contact has settled, gravity's share taken out."""
    gait = GAITS[speed]
    robot = gait_robot(gait)
    q, dq = gait_state(gait["x_minus"])
    after = robot.impact(q, dq)
    predicted = float(dynamics.angular_momentum(robot, after.q, after.dq))
    simulated = contact_momentum(robot, q, dq)
    assert simulated == pytest.approx(predicted, rel=0.01)


def contact_momentum(robot: PlanarBiped, q: np.ndarray, dq: np.ndarray) -> float:
    """Drop the robot on its swing foot in MuJoCo; z2 about that foot, 10 ms later."""
    model = mujoco.MjModel.from_xml_string(robot.layout.xml)
    data, states = mujoco.MjData(model), StateMap.build(model, robot.layout)
    stance_height = -min(0.0, float(robot.swing_foot(q)[1])) + float(robot.foot_radius)
    data.qpos[:], data.qvel[:] = states.to_mjcf(q, dq, 0, foot_xz=(0.0, stance_height))
    pulled = 0.0
    while data.time < 0.01:
        mujoco.mj_step1(model, data)
        foot, _ = states.foot(1, states.sensors(data.qpos, data.qvel))
        arm = data.subtree_com[0][0] - foot[0]
        pulled += float(robot.mass * robot.gravity * arm) * model.opt.timestep
        mujoco.mj_step2(model, data)
    sensors = states.sensors(data.qpos, data.qvel)
    _, velocity = states.foot(1, sensors)
    q_now, dq_now = read_back(robot, states, data.qpos, data.qvel, 1)
    moving = float(dynamics.angular_momentum(robot, q_now, dq_now))
    arm = np.asarray(robot.centre_of_mass(q_now))
    carried = float(robot.mass) * (arm[1] * velocity[0] - arm[0] * velocity[1])
    return moving + carried - pulled
