"""Put a free network into a walking posture before training, by a few supervised steps.

Without this, every run from random weights ends in the minimum with both feet together.
"""

from collections.abc import Callable

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import optax
from jaxtyping import PRNGKeyArray

from neuralgaits._types import Float
from neuralgaits.barriers import Gait

Postures = Callable[[Float[np.ndarray, " k"]], Float[np.ndarray, "k m"]]


def start_from_posture(postures: Postures, gait: Gait, steps: int, key: PRNGKeyArray) -> Gait:
    """Fit y_d(z) to the posture at z1, for all z of the tube.

    Args:
        postures: outputs of the posture at hip positions z1 (m). [k] to [k, m]
        gait: gait with a policy that maps z freely.
        steps: steps of Adam.
        key: random key.

    Returns: the gait with the fitted policy.
    """
    count = 33  # Number of hip positions at which inverse kinematics gives a posture.
    phases = np.linspace(0.0, 1.0, count)
    start, guard = (float(end) for end in gait.span)
    targets = jnp.asarray(postures(start + phases * (guard - start)))
    trained, fixed = eqx.partition(gait.policy, gait.policy.trainable())
    optimizer = optax.adam(3e-3)

    def misfit(policy_part, level_key):
        policy = eqx.combine(policy_part, fixed)
        pick_key, level_key = jax.random.split(level_key)
        batch = 128
        pick = jax.random.randint(pick_key, (batch,), 0, count)
        levels = jax.random.uniform(level_key, (batch,), dtype=float)
        z = jax.vmap(gait.z)(jnp.stack([jnp.asarray(phases)[pick], levels], axis=1))
        error = jax.vmap(policy)(z) - targets[pick]
        return jnp.mean(error * error)

    def step(carry, step_key):
        policy_part, state = carry
        update, state = optimizer.update(jax.grad(misfit)(policy_part, step_key), state)
        return (optax.apply_updates(policy_part, update), state), None

    @jax.jit
    def fit(policy_part, keys):
        (policy_part, _), _ = jax.lax.scan(step, (policy_part, optimizer.init(policy_part)), keys)
        return policy_part

    trained = jax.tree.map(jnp.asarray, trained)
    policy = eqx.combine(fit(trained, jax.random.split(key, steps)), fixed)
    return Gait(policy, gait.tube)
