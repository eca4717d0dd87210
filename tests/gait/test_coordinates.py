"""Zero dynamics coordinates of k joints without motors: k = 2, a planar chain, against MuJoCo."""

from typing import NamedTuple

import jax
import jax.numpy as jnp
import mujoco
import numpy as np
import pytest

from neuralgaits._quick_jit import quick_jit
from neuralgaits.gait import runge_kutta
from neuralgaits.gait.zero_coordinates import ZeroCoordinates, combined, solved

MASSES, LENGTH, GRAVITY = (3.0, 2.0, 1.5, 1.0), 0.4, 9.81
ROWS = np.array([[1.0, 0.2, 0.3, -0.1], [0.1, 1.0, -0.2, 0.4]])
SLOPES = np.array([[0.6, -0.3], [0.2, 0.5]])
CURVATURES = np.array([[0.3, -0.2], [-0.4, 0.1]])


class Chain(NamedTuple):
    """A planar chain of point masses: two joints without motors, then two with."""

    n: int = 4
    position_rows: np.ndarray = ROWS

    def mass(self, q):
        angle = jnp.cumsum(q)
        ends = LENGTH * jnp.stack([jnp.cos(angle), jnp.sin(angle)])
        # A joint turns every link behind it: velocity of mass i per rate of joint j.
        behind = np.tril(np.ones((4, 4)))
        across, along = (behind @ (behind * end[:, None]) for end in ends)
        masses = jnp.asarray(MASSES)[:, None]
        return across.T @ (masses * across) + along.T @ (masses * along)

    def energy(self, q, dq):
        return 0.5 * dq @ self.mass(q) @ dq

    def weight(self, q):
        height = jnp.cumsum(-LENGTH * jnp.cos(jnp.cumsum(q)))
        return GRAVITY * jnp.asarray(MASSES) @ height

    def momentum(self, q, dq):
        return -(self.mass(q) @ dq)[:2]

    def momentum_rows(self, q):
        return self.mass(q)[:2]

    def momentum_rate(self, q, dq=None):
        return -(jax.grad(self.energy)(q, dq) - jax.grad(self.weight)(q))[:2]


CHAIN = Chain()
COORDINATES = ZeroCoordinates(CHAIN)


def outputs(p):
    """Desired angles of the joints with motors: curved functions of the positions."""
    return SLOPES @ p + CURVATURES @ (p * p) + jnp.array([0.3, -0.2])


@quick_jit
def lifted(z):
    """The state on the zero dynamics manifold: q and dq."""
    p, s = COORDINATES.split(z)
    q = COORDINATES.lift(p, outputs(p))
    return q, COORDINATES.rates(q, s, jax.jacfwd(outputs)(p), jnp.zeros(4))


@quick_jit
def flow(z):
    """Rate of the zero dynamics."""
    return COORDINATES.rate(*lifted(z))


@quick_jit
def onward(z, span):
    """The state a step later."""
    return runge_kutta.step(runge_kutta.RK4, flow, z, span)


@quick_jit
def torque(z):
    """Torques that keep the outputs at zero, by Lagrange's equations of the chain."""
    chain = CHAIN
    (q, dq), (_, ddq) = jax.jvp(lifted, (z,), (flow(z),))
    _, rate = jax.jvp(lambda q, dq: chain.mass(q) @ dq, (q, dq), (dq, ddq))
    return rate - jax.grad(chain.energy)(q, dq) + jax.grad(chain.weight)(q)


@pytest.fixture(scope="module")
def chain():
    """The same chain in MuJoCo."""
    text = ""
    for mass in reversed(MASSES):
        place = "0 0 0" if mass == MASSES[0] else f"0 0 {-LENGTH}"
        text = (
            f'<body pos="{place}"><joint type="hinge" axis="0 -1 0"/>'
            f'<inertial pos="0 0 {-LENGTH}" mass="{mass}" diaginertia="1e-9 1e-9 1e-9"/>'
            f"{text}</body>"
        )
    model = mujoco.MjModel.from_xml_string(
        f'<mujoco><option timestep="0.0005" integrator="RK4" gravity="0 0 {-GRAVITY}"/>'
        f"<worldbody>{text}</worldbody></mujoco>"
    )
    return model, mujoco.MjData(model)


def test_two_joints_without_motors_move_as_in_mujoco(chain):
    model, data = chain
    z = start = jnp.array([0.4, -0.3, 0.5, 0.2])
    assert COORDINATES.k == 2
    data.qpos, data.qvel = lifted(z)
    np.testing.assert_allclose(COORDINATES.of(data.qpos, data.qvel), z, atol=1e-12)
    needed = np.zeros(4)
    for _ in range(400):
        now = COORDINATES.of(data.qpos, data.qvel)
        needed = np.asarray(torque(now))
        # What holds the outputs is on the joints with motors alone.
        np.testing.assert_allclose(needed[:2], 0.0, atol=1e-9)
        data.qfrc_applied = needed
        mujoco.mj_step(model, data)
        z = onward(z, model.opt.timestep)
    # Torques are held over a step of half a millisecond, so MuJoCo's walk drifts by as little.
    np.testing.assert_allclose(COORDINATES.of(data.qpos, data.qvel), z, atol=1e-4)
    assert np.abs(z - start).max() > 0.2
    assert np.abs(needed[2:]).max() > 1.0


def test_mujoco_has_the_same_momenta_and_rates(chain):
    model, data = chain
    rng = np.random.default_rng(0)
    for q, dq in rng.uniform(-1.0, 1.0, (20, 2, 4)):
        data.qpos, data.qvel = q, dq
        data.qfrc_applied = [0.0, 0.0, 3.0, -2.0]
        mujoco.mj_forward(model, data)
        mass = np.zeros((4, 4))
        mujoco.mj_fullM(model, data, mass)
        z, slope = COORDINATES.of(q, dq), COORDINATES.rate(q, dq)
        np.testing.assert_allclose(z, [*ROWS @ q, *-(mass @ dq)[:2]], atol=1e-7)
        acceleration, step = data.qacc.copy(), 1e-6
        ahead = COORDINATES.of(q + step * dq, dq + step * acceleration)
        behind = COORDINATES.of(q - step * dq, dq - step * acceleration)
        np.testing.assert_allclose(slope, (ahead - behind) / (2.0 * step), atol=1e-5)


def test_solves_of_one_and_two_agree_with_numpy():
    rng = np.random.default_rng(1)
    for k in (1, 2):
        matrix, right = np.eye(k) + 0.3 * rng.normal(size=(k, k)), rng.normal(size=(k, 3))
        np.testing.assert_allclose(
            solved(matrix, right), np.linalg.solve(matrix, right), rtol=1e-12
        )
        np.testing.assert_allclose(
            solved(matrix, right[:, 0]), np.linalg.solve(matrix, right[:, 0]), rtol=1e-12
        )
        np.testing.assert_allclose(combined(right.T, matrix[0]), right.T @ matrix[0], rtol=1e-12)
