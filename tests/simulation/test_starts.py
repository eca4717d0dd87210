import jax.numpy as jnp
import mujoco
import numpy as np
import pytest

from neuralgaits.analysis.flow import Mesh, returns
from neuralgaits.analysis.poincare_map import motion_of
from neuralgaits.barriers import Gait, Tube
from neuralgaits.errors import InputError
from neuralgaits.gait import ZeroDynamics
from neuralgaits.robots import load_robot
from neuralgaits.simulation.setup.disturbance import PlantChanges
from neuralgaits.simulation.setup.plant import build
from neuralgaits.simulation.setup.starts import full_states, momentum_range, periodic_orbit
from neuralgaits.simulation.walk import plant_states


@pytest.fixture(scope="module")
def gait(amber, slow):
    policy, _ = slow
    start, guard = (float(end) for end in policy.z1_range)
    tube = Tube.between_energies(amber, (0.1, 0.5), height=0.85, span=(start, guard))
    return Gait(policy, tube)


@pytest.fixture(scope="module")
def zd(amber, gait):
    return ZeroDynamics(amber, gait.policy)


def states(zd, gait, kind, seed=0, episodes=3):
    x = full_states(zd, gait, kind, seed=seed, episodes=episodes)
    assert x.shape == (episodes, 10)
    return x


@pytest.mark.parametrize("kind", ["centre", "region"])
def test_starts_lie_in_the_region_with_zero_outputs(zd, gait, kind):
    start, guard = gait.policy.z1_range
    for x in states(zd, gait, kind):
        eta, z = zd.phi(x)
        np.testing.assert_allclose(eta, 0.0, atol=1e-9)
        assert start <= z[0] <= guard
        assert 0.0 <= gait.level(z) <= 1.0


def test_the_centre_is_one_state_and_the_region_many(zd, gait):
    assert len(np.unique(states(zd, gait, "centre"), axis=0)) == 1
    drawn = states(zd, gait, "region", seed=4)
    assert len(np.unique(drawn, axis=0)) == 3
    np.testing.assert_array_equal(drawn, states(zd, gait, "region", seed=4))
    # An episode starts where it starts, however many others there are.
    np.testing.assert_allclose(drawn, states(zd, gait, "region", 4, 5)[:3], atol=1e-12)


def test_the_fixed_point_is_that_of_the_poincare_map(zd, gait):
    orbit = periodic_orbit(zd, gait)
    _, z = zd.phi(states(zd, gait, "fixed-point")[0])
    np.testing.assert_allclose(z, orbit.fixed_point, atol=1e-9)


def test_the_fixed_point_of_a_learned_robot_is_that_of_its_corrected_dynamics(amber, zd, gait):
    heavier = ZeroDynamics(amber, gait.policy, lambda z: jnp.array([0.0, -0.3]))
    _, z = zd.phi(states(heavier, gait, "fixed-point")[0])
    mesh, start = Mesh.of_leg(amber.leg_length), np.array(z[1:])
    assert returns(motion_of(heavier), start, mesh).z2 == pytest.approx(start, rel=1e-8)
    assert returns(motion_of(zd), start, mesh).z2 > start + 0.01


def test_momenta_of_the_region_bound_those_of_its_states(zd, gait):
    low, high = momentum_range(gait)
    # As many as elsewhere: another number would be compiled again.
    for x in states(zd, gait, "region", 4, 5):
        assert low <= zd.phi(x)[1][1] <= high


def test_another_start_is_refused(zd, gait):
    with pytest.raises(InputError, match="expected one of centre, region, fixed-point"):
        full_states(zd, gait, "middle", seed=0, episodes=1)


@pytest.mark.parametrize("slope_deg", [-3.0, 0.0, 2.0])
def test_a_flat_stance_foot_begins_on_the_slope_and_not_inside_of_it(slope_deg):
    plant = build(load_robot("amber3m-feet"), PlantChanges(slope_deg=slope_deg))
    data = mujoco.MjData(plant.model)
    start = np.zeros((1, 2 * plant.robot.n))
    start[0, :2] = 0.2, -0.3
    data.qpos[:] = plant_states(plant, start)[0, 1 : 1 + plant.model.nq]
    mujoco.mj_kinematics(plant.model, data)
    sole = plant.model.geom("sole_left").id
    slope = np.radians(slope_deg)
    along, up = np.array([np.cos(slope), np.sin(slope)]), np.array([-np.sin(slope), np.cos(slope)])
    axis = data.geom_xmat[sole].reshape(3, 3)[[0, 2], 0]
    np.testing.assert_allclose(axis, along, atol=1e-12)
    above = up @ data.geom_xpos[sole][[0, 2]] - plant.model.geom_size[sole, 2]
    assert above == pytest.approx(0.0, abs=1e-12)
