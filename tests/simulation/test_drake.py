"""The plant in Drake against the closed form, against MuJoCo's walk, and against a scale."""

# pyright: reportMissingImports=false
# Drake is an extra that is not installed for every test.

import jax.numpy as jnp
import numpy as np
import pytest

pytest.importorskip("pydrake", reason="needs the drake extra: drake")

from pydrake.multibody.tree import JacobianWrtVariable

from neuralgaits.robots import load_robot
from neuralgaits.robots.mjcf.loader import robot_from_text
from neuralgaits.simulation.drake.drake_plant import drake_plant
from neuralgaits.simulation.drake.drake_world import DrakeWorld
from neuralgaits.simulation.metrics import summary
from neuralgaits.simulation.setup.course import stones_at
from neuralgaits.simulation.setup.disturbance import PlantChanges
from neuralgaits.simulation.setup.plant import build
from neuralgaits.simulation.walk import walk
from support.random_biped import random_biped


def states(plant, q, dq, foot):
    """MuJoCo states of a posture, the foot of leg 0 at a place."""
    return np.concatenate([[0.0], *plant.state_map.to_mjcf(q, dq, 0, foot)])[None]


@pytest.mark.parametrize("name", ["amber3m", "rabbit", (3, 2, True), (8, 2, False), (2, 3, True)])
def test_mass_matrix_bias_and_energy_are_those_of_the_closed_form(name):
    if isinstance(name, str):
        robot = load_robot(name)
    else:
        robot = robot_from_text(random_biped(name[0], name[1], torso=name[2]), "random")
    source = build(robot)
    made, random, n = drake_plant(source), np.random.default_rng(1), robot.n
    plant, body = made.plant, made.plant.get_body(made.feet[0])
    context = plant.CreateDefaultContext()
    sphere = source.model.geom(robot.layout.feet[0]).pos
    for _ in range(10):
        q, dq = random.uniform(-1.0, 1.0, n), random.normal(size=n)
        rates = np.concatenate([np.eye(n), dq[None]])
        qpos, qvel = source.state_map.to_mjcf(np.tile(q, (n + 1, 1)), rates, 0)
        positions, velocities = plant.GetPositions(context), plant.GetVelocities(context)
        positions[made.positions] = qpos[-1] - made.zeros
        velocities[made.velocities] = qvel[-1]
        plant.SetPositionsAndVelocities(context, np.concatenate([positions, velocities]))
        # Columns: motions with the foot of leg 0 at rest.
        free = np.zeros((len(velocities), n))
        free[made.velocities] = qvel[:n].T
        drift, world = np.zeros(len(velocities)), plant.world_frame()
        swept = plant.CalcBiasTranslationalAcceleration(
            context, JacobianWrtVariable.kV, body.body_frame(), sphere, world, world
        )
        drift[made.velocities[source.state_map.root[:2]]] = -swept[[0, 2], 0]
        damping = np.zeros(len(velocities))
        for joint in map(plant.get_joint, plant.GetJointIndices()):
            if joint.num_velocities():
                damping[joint.velocity_start()] = joint.default_damping()
        mass = plant.CalcMassMatrix(context)
        bias = plant.CalcBiasTerm(context) - plant.CalcGravityGeneralizedForces(context)
        bias = free.T @ (bias + damping * velocities + mass @ drift)
        at, moving = jnp.asarray(q), jnp.asarray(dq)
        own = robot.mass_matrix(at)
        np.testing.assert_allclose(free.T @ mass @ free, own, rtol=1e-9, atol=1e-9)
        np.testing.assert_allclose(bias, robot.bias(at, moving), rtol=1e-9, atol=1e-9)
        kinetic = 0.5 * velocities @ mass @ velocities
        assert kinetic == pytest.approx(float(robot.kinetic_energy(at, moving)), rel=1e-9)
        potential = robot.potential_energy(at)
        foot = plant.CalcPointsPositions(context, body.body_frame(), sphere, world)[2, 0]
        floors = sum(
            made.plant.get_body(f.child_body().index()).default_mass() for f in made.floors
        )
        assert floors > 0.0 and foot == pytest.approx(0.0, abs=1e-9)
        assert plant.CalcPotentialEnergy(context) == pytest.approx(float(potential), abs=1e-9)


def test_both_feet_carry_the_weight_each_on_its_own_floor():
    robot = load_robot("amber3m")
    plant = build(robot)
    straddle = np.array([-0.2, 0.0, 0.2, -0.2, 0.0])
    start = states(plant, straddle, np.zeros(5), (0.0, float(robot.foot_radius)))
    world, only = DrakeWorld([plant], start), np.array([0])
    # Held still by its motors: a torso that does not move weighs what it weighs.
    for _ in range(60):
        joints = plant.state_map.sensors(*np.split(world.states[0, 1:], 2))
        away = joints.joints - plant.state_map.sensors(*np.split(start[0, 1:], 2)).joints
        torque = -2000.0 * away - 100.0 * joints.djoints
        controls = np.zeros((1, plant.state_map.nu))
        controls[0, plant.state_map.actuators] = torque / np.array(plant.state_map.layout.gears)
        world.advance(only, controls, np.zeros(1))
    weight = float(robot.mass * robot.gravity)
    assert world.touch.sum() == pytest.approx(weight, rel=0.05)
    world.lay_floors(np.array([[0.0, -0.05]]))
    world.advance(only, np.zeros((1, plant.state_map.nu)), np.zeros(1))
    assert world.touch[0, 0] > 0.0 and world.touch[0, 1] == 0.0


def test_a_foot_stands_on_a_stone_and_not_beside_it():
    robot = load_robot("amber3m")
    straddle = np.array([-0.2, 0.0, 0.2, -0.2, 0.0])
    step = float(robot.swing_foot(straddle)[0])
    for rise in (0.0, -0.05):
        course = stones_at(np.array([[0.0, 0.0], [step, rise]]), np.array([0.1, 0.1]))
        plant = build(robot, None, course)
        start = states(plant, straddle, np.zeros(5), (0.0, float(robot.foot_radius)))
        world = DrakeWorld([plant], start)
        for _ in range(10):
            world.advance(np.array([0]), np.zeros((1, plant.state_map.nu)), np.zeros(1))
        assert list(world.touch[0] > 10.0) == [True, rise == 0.0]


def test_dry_friction_holds_and_slips():
    robot = load_robot("amber3m")
    plant = build(robot, PlantChanges(joint_friction=2.0))
    start = states(plant, np.array([-0.2, 0.3, 0.2, -0.2, 0.3]), np.zeros(5), (0.0, 2.0))
    turned = []
    for torque in (1.5, 3.0):
        world = DrakeWorld([plant], start)
        controls = np.zeros((1, plant.state_map.nu))
        controls[0, plant.state_map.actuators[0, 0]] = torque
        for _ in range(50):
            world.advance(np.array([0]), controls, np.zeros(1))
        turned.append(abs(np.split(world.states[0, 1:], 2)[1][plant.state_map.joints[0, 0]]))
    # In free fall, 50 ms under 1 N m more than friction: rotor and shin, 0.46 kg m^2.
    assert turned[0] < 2e-3
    assert turned[1] == pytest.approx(0.05 * 1.0 / 0.46, rel=0.1)


@pytest.mark.slow
def test_a_robot_that_flies_apart_has_fallen(amber, slow):
    policy, x = slow
    wild = x.copy()
    wild[5:] = 1e6
    walked = walk(amber, policy, wild[None], controller="fblin", steps=1, simulator="drake")
    plant = build(amber)
    q, dq = np.split(wild, 2)
    world = DrakeWorld([plant], states(plant, q, dq, (0.0, 0.0)))
    for _ in range(50):
        world.advance(np.array([0]), np.zeros((1, plant.state_map.nu)), np.zeros(1))
    assert walked.episodes.endings[0].fell and np.isnan(world.states).all()


@pytest.mark.slow
def test_the_walk_is_that_of_mujoco(amber, brisk):
    policy, x = brisk
    one, other = (
        summary(walk(amber, policy, x[None], controller="fblin", steps=6, simulator=simulator))
        for simulator in ("mujoco", "drake")
    )
    assert one.fell == other.fell == (False,)
    assert other.speed_m_s == pytest.approx(one.speed_m_s, rel=0.03)
    assert other.cost_of_transport == pytest.approx(one.cost_of_transport, rel=0.05)
