"""Gaits and conditions read nothing of a robot but what `SteppingRobot` has."""

import inspect

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from neuralgaits.barriers import specs
from neuralgaits.certificate.traced import after_impact, trace_spec
from neuralgaits.errors import InputError
from neuralgaits.gait import ZeroDynamics
from neuralgaits.gait.full_order import FullPoint
from neuralgaits.gait.gaits import Gait
from neuralgaits.gait.joint_inertia import JointResponse
from neuralgaits.gait.policies.hybrid_invariant import HybridInvariantPolicy
from neuralgaits.gait.policies.mlp import MLPPolicy
from neuralgaits.gait.posture import REFERENCE_LEG_M, posture_path, walking_posture
from neuralgaits.gait.stepping_robot import SteppingRobot
from neuralgaits.robots import PlanarBiped, load_robot
from neuralgaits.robots.mjcf.leaning import leaning_robot
from neuralgaits.robots.mjcf.parameters import ParameterAxis, model_of

ASKED = {
    name
    for kind in inspect.getmro(SteppingRobot)
    for name in vars(kind)
    if not name.startswith("_")
}


class OtherRobot:
    """A robot of another class, with the members of the protocol alone."""

    def __init__(self, biped: PlanarBiped):
        self._biped = biped

    def __getattr__(self, name: str):
        if name not in ASKED:
            raise AttributeError(f"a SteppingRobot has no {name}")
        return getattr(self._biped, name)


@pytest.fixture(params=["amber3m", "amber3m-feet", "rabbit"])
def robots(request):
    biped = load_robot(request.param)
    return biped, OtherRobot(biped)


def gait_of(biped):
    spec = specs.load("walking", biped)
    gait = spec.new_gait(jax.random.key(0), "posture", None)
    assert isinstance(gait, Gait)
    return spec, gait


def test_the_protocol_leaves_the_formulas_of_a_biped_out(robots):
    biped, other = robots
    assert isinstance(biped, SteppingRobot)
    assert isinstance(other, SteppingRobot)
    for name in ("coupling", "mass_moment", "hip", "hip_gradient", "inertia"):
        assert hasattr(biped, name)
        with pytest.raises(AttributeError):
            getattr(other, name)


def test_conditions_of_another_robot_are_the_same_program(robots):
    biped, other = robots
    spec, gait = gait_of(biped)
    assert trace_spec(spec, other, gait).hash == trace_spec(spec, biped, gait).hash
    assert after_impact(other, gait) == after_impact(biped, gait)


def test_a_policy_is_matched_to_the_impact_of_another_robot(robots):
    biped, other = robots
    _, gait = gait_of(biped)
    assert isinstance(gait.policy, HybridInvariantPolicy)
    bent = gait.policy.guard_outputs + 0.01
    policy = gait.policy.__class__(**{**vars(gait.policy), "guard_outputs": bent})
    own, matched = policy.match_impact(biped), policy.match_impact(other)
    assert isinstance(own, HybridInvariantPolicy)
    assert isinstance(matched, HybridInvariantPolicy)
    assert not np.array_equal(matched.start_outputs, gait.policy.start_outputs)
    np.testing.assert_array_equal(matched.cubic, own.cubic)
    np.testing.assert_array_equal(matched.momentum_ratio, own.momentum_ratio)


def test_zero_dynamics_and_full_states_of_another_robot(robots):
    biped, other = robots
    _, gait = gait_of(biped)
    z = gait.z(jnp.array([0.4, 0.5]))
    ours, theirs = (ZeroDynamics(robot, gait.policy) for robot in (biped, other))
    for name in ("zdot", "guard", "reset", "phi_inv"):
        np.testing.assert_array_equal(getattr(theirs, name)(z), getattr(ours, name)(z))
    eta = 0.01 * jnp.ones(2 * (biped.n - 1))
    there, here = (FullPoint(robot, gait.policy, z, eta, 30.0) for robot in (other, biped))
    for name in ("torque", "force", "eta_after"):
        np.testing.assert_array_equal(getattr(there, name), getattr(here, name))


def test_only_a_planar_biped_leans_or_has_a_box_around_it(robots):
    _, other = robots
    with pytest.raises(InputError, match="to lean"):
        leaning_robot(other, 0.01)
    with pytest.raises(InputError, match="planar biped for a box"):
        model_of(other, (ParameterAxis("mass[0]", 0.01),))
    assert model_of(other, ()) is other
    with pytest.raises(InputError, match="expected a PlanarBiped"):
        specs.load("walking", other)


def test_postures_and_new_policies_of_another_robot(robots):
    biped, other = robots
    for own, theirs in zip(walking_posture(biped), walking_posture(other), strict=True):
        np.testing.assert_array_equal(theirs, own)
    z1 = np.linspace(-0.5, 0.5, 3) * walking_posture(biped).z_guard
    np.testing.assert_array_equal(posture_path(other, z1), posture_path(biped, z1))
    # One's masses are constants of compiled code, the other's its inputs: rounded otherwise.
    np.testing.assert_allclose(
        JointResponse(other).accelerations, JointResponse(biped).accelerations, rtol=1e-9
    )
    for kind in (HybridInvariantPolicy, MLPPolicy):
        here, there = (kind.init(robot, key=jax.random.key(0)) for robot in robots)
        assert jax.tree.structure(there) == jax.tree.structure(here)
        for own, theirs in zip(jax.tree.leaves(here), jax.tree.leaves(there), strict=True):
            np.testing.assert_allclose(theirs, own, rtol=1e-9, atol=1e-12)


def test_the_hip_of_a_rough_step_is_where_the_robot_has_it(robots):
    """At constant height, and as far ahead of the foot as was asked for."""
    biped, _ = robots
    guard = walking_posture(biped).z_guard
    z1 = np.array([-0.5, 0.0, 0.5]) * guard
    row = np.asarray(biped.position_rows[0])
    heights = []
    for position, outputs in zip(z1, posture_path(biped, z1), strict=True):
        q = np.concatenate([[(position - row[1:] @ outputs) / row[0]], outputs])
        heights.append(float(biped.hip_position(q)[1]))
    height = 0.835 / REFERENCE_LEG_M * biped.leg_length
    np.testing.assert_allclose(heights, height, rtol=0.02)
