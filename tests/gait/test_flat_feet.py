"""A gait on flat feet: its zero dynamics with an ankle's torque, and hybrid invariance."""

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import pytest

from neuralgaits.barriers import functions, specs
from neuralgaits.errors import SpecError
from neuralgaits.gait import ZeroDynamics
from neuralgaits.gait.third_order import ThirdOrderPolicy
from neuralgaits.robots import load_robot


@pytest.fixture(scope="module")
def robot():
    return load_robot("amber3m-feet")


@pytest.fixture(scope="module")
def gait(robot):
    """An untrained gait whose ankle pushes all the same."""
    found = specs.load("walking", robot).new_gait(jax.random.key(3), "random", None)
    last = lambda g: g.policy.ankle.network.weights[-1]  # noqa: E731
    return eqx.tree_at(last, found, 30.0 * last(found))


@pytest.fixture(scope="module")
def points(robot, gait):
    zd = ZeroDynamics(robot, gait.policy)
    return [zd.point(gait.z(jnp.array(u))) for u in ((0.2, 0.1), (0.5, 0.9), (0.9, 0.4))]


def test_the_ankle_pushes_within_its_share_of_the_limit(robot, points):
    torques = np.array([point.ankle_torque for point in points])
    assert np.ptp(torques) > 0.5
    assert np.all(np.abs(torques) <= 0.9 * robot.feet.torque_limit)


def test_its_torque_is_part_of_the_momentum_s_rate_and_moves_the_robot(robot, points):
    for point in points:
        weight = robot.mass * robot.gravity * robot.centre_of_mass(point.q)[0]
        np.testing.assert_allclose(point.dz[1], weight + point.ankle_torque, rtol=1e-12)
        found = robot.acceleration(point.q, point.dq, point.torque, point.ankle_torque)
        np.testing.assert_allclose(found, point.ddq, atol=1e-9)


def test_an_expansion_that_would_lose_the_ankle_is_refused(gait):
    with pytest.raises(SpecError, match="expected a policy of a robot on point feet"):
        ThirdOrderPolicy.of(gait.policy, gait.z(jnp.array([0.5, 0.5])))


def test_accelerations_are_those_of_the_flow(robot, gait, points):
    zd = ZeroDynamics(robot, gait.policy)
    for point in points:
        _, along = jax.jvp(lambda z: zd.point(z).dq, (point.z,), (point.dz,))
        np.testing.assert_allclose(along, point.ddq, atol=1e-9)


def test_full_states_and_back(robot, gait, points):
    zd = ZeroDynamics(robot, gait.policy)
    eta = 0.01 * np.arange(1.0, 2 * robot.n - 1)
    for point in points:
        np.testing.assert_allclose(
            zd.phi_inv(point.z), np.concatenate([point.q, point.dq]), atol=1e-12
        )
        found, z = zd.phi(zd.phi_inv(point.z, eta))
        np.testing.assert_allclose(found, eta, atol=1e-12)
        np.testing.assert_allclose(z, point.z, atol=1e-12)


def test_it_lands_flat_and_on_its_own_start(robot, gait):
    zd = ZeroDynamics(robot, gait.policy)
    for level in (0.1, 0.9):
        point = zd.point(gait.z(jnp.array([1.0, level])))
        foot = robot.link_angles[-1]
        np.testing.assert_allclose([foot @ point.q, foot @ point.dq, point.foot[1]], 0.0, atol=1e-9)
        np.testing.assert_allclose(point.impact.q, point.after.q, atol=1e-9)
        np.testing.assert_allclose(point.impact.dq, point.after.dq, atol=1e-9)


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"name": "rugged"}, "spec rugged: expected a robot on point feet"),
        ({"name": "walking", "speed": 0.7}, "expected one gait without a speed, commands"),
        ({"name": "walking", "parameters": {"mass": 0.05}}, "expected one gait without a speed"),
    ],
)
def test_what_flat_feet_cannot_have_is_refused(robot, given, said):
    with pytest.raises(SpecError, match=said):
        specs.load(robot=robot, **given)


def test_their_spec_is_of_no_use_on_point_feet():
    with pytest.raises(SpecError, match="expected a robot with flat feet, found point feet"):
        specs.load("walking-flat-feet", load_robot("amber3m"))


def test_the_plain_walk_of_flat_feet_is_theirs(robot):
    assert specs.walking(robot).name == "walking-flat-feet"
    for make in (lambda: specs.walking(robot, policy="mlp"), lambda: specs.rugged(robot)):
        with pytest.raises(SpecError, match="expected a robot on point feet, found flat feet"):
            make()


def test_the_motor_of_an_ankle_brings_up_its_friction_as_well(robot, gait):
    """A torque within the limit is none if the joint's own friction takes the rest."""
    stiff = robot.damping.copy()
    stiff[0] = 100.0
    rubbed = eqx.tree_at(lambda r: r.damping, robot, stiff)
    lower, upper = (functions.ankle_reserve(side, 1.0) for side in ("lower", "upper"))
    u = jnp.array([0.5, 0.5])
    point, other = (ZeroDynamics(one, gait.policy).point(gait.z(u)) for one in (robot, rubbed))
    limit = robot.feet.torque_limit
    np.testing.assert_allclose(lower(point), 1.0 - point.ankle_torque / limit)
    motor = 100.0 * other.dq[0] - other.ankle_torque
    np.testing.assert_allclose([lower(other), upper(other)], [1 + motor / limit, 1 - motor / limit])
    assert min(lower(other), upper(other)) < 0.0 < min(lower(point), upper(point))
