import jax
import numpy as np
import pytest
from scipy.integrate import solve_ivp

from neuralgaits.barriers import specs
from neuralgaits.gait import ZeroDynamics
from neuralgaits.logs import Windows
from neuralgaits.robots import load_robot

PERIOD_S = 0.01


@pytest.fixture(scope="session")
def robot():
    return load_robot("amber3m")


@pytest.fixture(scope="session")
def gait(robot):
    return specs.walking(robot).new_gait(jax.random.key(0), "posture", None)


@pytest.fixture(scope="session")
def zd(robot, gait):
    return ZeroDynamics(robot, gait.policy)


@pytest.fixture(scope="session")
def walked(zd):
    """Makes windows of stance phases of dz = omega(0, z) + epsilon(z), integrated by SciPy.

    `walked(epsilon, starts, samples)`: windows of `samples` every 10 ms from each start, until the
    hip passes the guard.
    """
    omega = jax.jit(lambda z: zd.zdot(z))

    def passed(t, z):
        del t
        return z[0] - 0.17

    passed.terminal = True

    def make(epsilon, starts, samples=3):
        times, states, owners = [], [], []
        missing = jax.jit(epsilon)
        for owner, start in enumerate(starts):
            solution = solve_ivp(
                lambda t, z: np.asarray(omega(z)) + np.asarray(missing(z)),
                (0.0, 1.0),
                start,
                method="DOP853",
                rtol=1e-9,
                atol=1e-9,
                max_step=PERIOD_S,
                dense_output=True,
                events=passed,
            )
            t = np.arange(0.0, solution.t[-1], PERIOD_S)
            z = solution.sol(t).T
            for first in range(0, len(t) - samples + 1):
                times.append(t[first : first + samples])
                states.append(z[first : first + samples])
                owners.append(owner)
        return Windows(np.array(times), np.array(states), np.array(owners))

    return make
