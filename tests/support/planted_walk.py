"""Logs of zero dynamics with residuals that are known: what `fit` must find.

Integrated by the classical Runge-Kutta method with steps of 1 ms, far finer than what is fitted;
the robot is on the zero dynamics manifold all along.
"""

import jax
import jax.numpy as jnp
import numpy as np

from neuralgaits.gait import ZeroDynamics
from neuralgaits.gait.reset_residual import AbstractResetResidual, ImpactCorrection
from neuralgaits.logs import Log

PERIOD_S = 1e-3
LONGEST = 1500
"""Rows of a stance phase at most."""
MOMENTUM_LOST = 0.03
"""Of z2 before an impact, beyond what the model's impact takes."""


def flow(z):
    """A load behind, and a drag that grows along the step."""
    return jnp.stack([0.01 + 0.06 * z[0], -3.0 - 6.0 * z[0]])


STAGES = np.array([[0.0, 1 / 6], [0.5, 1 / 3], [0.5, 1 / 3], [1.0, 1 / 6]])
"""Of the Runge-Kutta method: how far ahead, and the weight of the rate there."""


class Reset(AbstractResetResidual):
    """An impact that takes more than the model's."""

    def __call__(self, z):
        return ImpactCorrection(-MOMENTUM_LOST * jnp.ones_like(z[0]), jnp.zeros(4))

    @property
    def centre(self):
        return np.array([0.17, 20.0])


def walked(zd: ZeroDynamics, momenta, strides: int) -> list[Log]:
    """One log a momentum z2 at the start of the first step (kg m^2/s)."""
    true = ZeroDynamics(zd.robot, zd.policy, flow, Reset())
    start, guard = (float(end) for end in zd.policy.z1_range)

    def step(z, _):
        def stage(so_far, row):
            rate, moved = so_far
            ahead, weight = row
            rate = true.zdot(z + PERIOD_S * ahead * rate)
            return (rate, moved + PERIOD_S * weight * rate), None

        # A loop, so that the rate is compiled once.
        return jax.lax.scan(stage, (jnp.zeros_like(z), z), STAGES)[0][1], z

    phase = jax.jit(lambda z: jax.lax.scan(step, z, None, length=LONGEST)[1])
    lifted = jax.jit(jax.vmap(lambda z: true.phi_inv(z)))
    reset = jax.jit(lambda z: true.reset(z))
    logs = []
    for number, momentum in enumerate(momenta):
        z, states, legs = np.array([start, momentum]), [], []
        for stride in range(strides):
            path = np.asarray(phase(z))
            past = np.flatnonzero(path[:, 0] >= guard)
            assert past.size, "the planted robot does not reach the guard"
            path = path[: past[0]]
            states.append(path)
            legs.append(np.full(len(path), stride % 2))
            # The impact takes no time: the next row has flowed on from it.
            z = np.asarray(phase(reset(path[-1])))[1]
        logs.append(_log(zd, np.concatenate(states), np.concatenate(legs), lifted, number))
    return logs


def _log(zd, z, legs, lifted, number) -> Log:
    padded = np.concatenate([z, np.repeat(z[-1:], -len(z) % LONGEST, axis=0)])
    blocks = [np.asarray(lifted(part)) for part in padded.reshape(-1, LONGEST, 2)]
    x = np.concatenate(blocks)[: len(z)]
    n, rows = zd.robot.n, len(z)
    up = zd.robot.link_angles[zd.robot.torso]
    return Log(
        t=PERIOD_S * np.arange(rows),
        stance=legs,
        q=x[:, :n],
        dq=x[:, n:],
        qd=x[:, 1:n],
        dqd=x[:, n + 1 :],
        tau=np.zeros((rows, n - 1)),
        pitch=x[:, :n] @ up,
        dpitch=x[:, n:] @ up,
        z=z,
        z2_plant=None,
        rows=np.arange(1, rows + 1),
        joint_names=zd.robot.joint_names,
        source=f"planted {number}",
    )
