"""Control laws know no biped: they drive a double pendulum, whose pivot has no motor."""

from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from neuralgaits._quick_jit import quick_jit
from neuralgaits.control import ClfQp, Fblin, Pd
from neuralgaits.control.driven_mechanism import DrivenMechanism
from neuralgaits.control.law import Demand, MeasuredState
from neuralgaits.gait.zero_coordinates import ZeroCoordinates
from neuralgaits.robots.linear import solve

MASSES, LENGTHS, GRAVITY = np.array([2.0, 1.5]), np.array([0.5, 0.4]), 9.81
W = 7.0


class DoublePendulum(NamedTuple):
    """Point masses at the ends of two rods, upright at q = 0; the motor is between the rods."""

    n: int = 2
    position_rows: np.ndarray = np.array([[1.0, 0.4]])
    damping: np.ndarray = np.array([0.0, 0.3])
    friction: float = 50.0

    def ends(self, q):
        """Places of both masses from the pivot, (x, z). [2, 2] (m)."""
        angle = jnp.cumsum(q)
        rods = jnp.asarray(LENGTHS)[:, None] * jnp.stack([-jnp.sin(angle), jnp.cos(angle)], axis=1)
        return jnp.cumsum(rods, axis=0)

    def momenta(self, q, dq):
        """Momenta conjugate to the coordinates. [2]."""
        jacobian = jax.jacfwd(self.ends)(q)
        return jnp.einsum("i,iaj,iak,k->j", jnp.asarray(MASSES), jacobian, jacobian, dq)

    def weight_moment(self, q):
        """Slope of the potential energy. [2]."""
        return jax.grad(lambda at: GRAVITY * jnp.asarray(MASSES) @ self.ends(at)[:, 1])(q)

    def mass_matrix(self, q):
        return jax.jacfwd(lambda dq: self.momenta(q, dq))(jnp.zeros(2))

    def bias(self, q, dq):
        _, turned = jax.jvp(lambda at: self.momenta(at, dq), (q,), (dq,))
        pull = jax.grad(lambda at: 0.5 * dq @ self.momenta(at, dq))(q)
        return turned - pull + self.weight_moment(q) + self.damping * dq

    def momentum_rows(self, q):
        return self.mass_matrix(q)[:1]

    def momentum(self, q, dq):
        return -self.momenta(q, dq)[:1]

    def momentum_rate(self, q, dq=None):
        del dq
        return self.weight_moment(q)[:1]

    def momentum_rate_rate(self, q, dq):
        return jax.jvp(self.momentum_rate, (q,), (dq,))[1]

    def moment_scale(self):
        return jnp.asarray(MASSES.sum() * LENGTHS.sum())

    def weight(self):
        return jnp.asarray(MASSES.sum() * GRAVITY)

    def ground_reaction_force(self, q, dq, ddq):
        def velocities(q, dq):
            return jax.jvp(self.ends, (q,), (dq,))[1]

        _, moved = jax.jvp(velocities, (q, dq), (dq, ddq))
        return jnp.asarray(MASSES) @ moved + jnp.array([0.0, 1.0]) * self.weight()


PENDULUM: DrivenMechanism = DoublePendulum()
COORDINATES = ZeroCoordinates(PENDULUM)


def outputs(z):
    """Desired angle between the rods: curved, and of the momentum as well."""
    return jnp.array([0.3]) + 0.5 * jnp.sin(z[:1]) + 0.1 * jnp.sin(z[1:])


def reading_of(q, dq):
    return MeasuredState(q, dq, COORDINATES.of(q, dq), COORDINATES.rate(q, dq))


def states(rng, count=4):
    return [(rng.uniform(-0.3, 0.3, 2), rng.uniform(-1.0, 1.0, 2)) for _ in range(count)]


@quick_jit
def driven(q, dq, torque):
    """Return the accelerations, and errors and their rates with their changes along the motion."""

    def errors(q, dq):
        z, dz = COORDINATES.of(q, dq), COORDINATES.rate(q, dq)
        y, dy = jax.jvp(outputs, (z,), (dz,))
        return q[1:] - y, dq[1:] - dy

    push = jnp.concatenate([jnp.zeros(1), torque])
    ddq = solve(PENDULUM.mass_matrix(q), push - PENDULUM.bias(q, dq))
    return ddq, *jax.jvp(errors, (q, dq), (dq, ddq))


def torque_of(law, q, dq):
    reading = reading_of(q, dq)
    return law.torque(PENDULUM, reading, law.desired(PENDULUM, outputs, reading))


def test_the_joint_follows_its_output_as_an_oscillator(rng):
    law = Fblin(bandwidth=W)
    for q, dq in states(rng):
        _, (y, dy), (_, ddy) = driven(q, dq, quick_jit(lambda *at: torque_of(law, *at))(q, dq))
        np.testing.assert_allclose(ddy, -(W**2) * y - 2.0 * W * dy, rtol=1e-9, atol=1e-9)


def test_pd_adds_its_gains_to_the_torques_of_the_model(rng):
    law, model = Pd(stiffness=(30.0,), damping=(4.0,)), Pd(stiffness=(0.0,), damping=(0.0,))
    for q, dq in states(rng, 2):
        own, alone = (np.asarray(torque_of(one, q, dq)) for one in (law, model))
        _, (y, dy), _ = driven(q, dq, alone)
        np.testing.assert_allclose(own - alone, -30.0 * y - 4.0 * dy, rtol=1e-9, atol=1e-9)


def test_the_program_leaves_torques_that_are_within_all_limits(rng):
    law = ClfQp(bandwidth=W, least_normal=-50.0)
    for q, dq in states(rng, 2):
        reading = reading_of(q, dq)
        desired = law.desired(PENDULUM, outputs, reading)
        wanted = law.torque(PENDULUM, reading, desired)
        found = law.apply_limits(PENDULUM, Demand(reading, desired, wanted, jnp.array([1e3])))
        np.testing.assert_allclose(found.torque, wanted, rtol=1e-5, atol=1e-5)
        assert not np.any(found.relaxed) and not found.saturated
