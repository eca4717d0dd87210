"""Barrier rates under a disturbance: of a function of z, along every disturbed flow."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from neuralgaits.barriers import Barrier, functions
from neuralgaits.certificate.levels.walking_set import margins as walking_set
from neuralgaits.certificate.levels.walking_set.theorem import WalkingSetConstants

PUSH = (0.01, 0.3)
READS = {"pose": functions.torso_angle, "velocity": functions.forward_rate}


@pytest.mark.parametrize("read", READS.values(), ids=READS)
def test_the_rate_is_that_of_h_along_each_corner_and_linear_between(trained, read):
    barrier = Barrier("read", "tube", 1.0, functions.at_least(read, -0.2), 5.0)
    spec = trained.spec.with_conditions(barrier)
    shape = WalkingSetConstants(1e-7, 1e-7, 0.1, 0.9, PUSH, ("read",), ())
    gait, zd, u = trained.gait, trained.zero_dynamics, jnp.array([0.35, 0.6])

    @jax.jit
    def rates(u):
        return walking_set.margins(spec, gait, zd, shape, u)["set/rate read"]

    @jax.jit
    def undisturbed(z):
        point = zd.point(z)
        return point.dz, barrier.function(point), barrier.margins(point, gait)

    def h(z):
        return float(undisturbed(z)[1])

    found = np.asarray(rates(u)).ravel()
    z, step = gait.z(u), 1e-5
    dz, _, margins = undisturbed(z)

    expected = []
    for first in (-1.0, 1.0):
        for second in (-1.0, 1.0):
            moved = dz + jnp.array([first * PUSH[0], second * PUSH[1]])
            rate = (h(z + step * moved) - h(z - step * moved)) / (2.0 * step)
            expected.append(rate + 5.0 * h(z))
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-6)
    # Linear in the push: opposite corners average to the undisturbed margin.
    still = float(jnp.ravel(margins)[0])
    assert 0.5 * (found[0] + found[3]) == pytest.approx(still, abs=1e-9)
    assert 0.5 * (found[1] + found[2]) == pytest.approx(still, abs=1e-9)
    assert np.ptp(found) > 1e-3
