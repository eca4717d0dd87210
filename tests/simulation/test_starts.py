import numpy as np
import pytest

from neuralgaits.barriers import Gait, Tube
from neuralgaits.errors import InputError
from neuralgaits.gait import ZeroDynamics
from neuralgaits.simulation.starts import full_states, momentum_range, periodic_orbit


@pytest.fixture(scope="module")
def gait(amber, slow):
    policy, _ = slow
    start, guard = (float(end) for end in policy.z1_range)
    tube = Tube.between_energies(amber, (0.1, 0.5), height=0.85, span=(start, guard))
    return Gait(policy, tube)


def states(amber, gait, kind, seed=0, episodes=3):
    x = full_states(amber, gait, kind, seed=seed, episodes=episodes)
    assert x.shape == (episodes, 10)
    return x


@pytest.mark.parametrize("kind", ["centre", "region"])
def test_starts_lie_in_the_region_with_zero_outputs(amber, gait, kind):
    zd = ZeroDynamics(amber, gait.policy)
    start, guard = gait.policy.z1_range
    for x in states(amber, gait, kind):
        eta, z = zd.phi(x)
        np.testing.assert_allclose(eta, 0.0, atol=1e-9)
        assert start <= z[0] <= guard
        assert 0.0 <= gait.level(z) <= 1.0


def test_the_centre_is_one_state_and_the_region_many(amber, gait):
    assert len(np.unique(states(amber, gait, "centre"), axis=0)) == 1
    drawn = states(amber, gait, "region", seed=4)
    assert len(np.unique(drawn, axis=0)) == 3
    np.testing.assert_array_equal(drawn, states(amber, gait, "region", seed=4))
    # An episode starts where it starts, however many others there are.
    np.testing.assert_allclose(drawn, states(amber, gait, "region", 4, 5)[:3], atol=1e-12)


def test_the_fixed_point_is_that_of_the_poincare_map(amber, gait):
    orbit = periodic_orbit(amber, gait)
    _, z = ZeroDynamics(amber, gait.policy).phi(states(amber, gait, "fixed-point", episodes=1)[0])
    np.testing.assert_allclose(z, orbit.fixed_point, atol=1e-9)


def test_momenta_of_the_region_bound_those_of_its_states(amber, gait):
    low, high = momentum_range(gait)
    zd = ZeroDynamics(amber, gait.policy)
    for x in states(amber, gait, "region", episodes=10):
        assert low <= zd.phi(x)[1][1] <= high


def test_another_start_is_refused(amber, gait):
    with pytest.raises(InputError, match="expected one of centre, region, fixed-point"):
        full_states(amber, gait, "middle", seed=0, episodes=1)
