"""Start of a training: a linear-quadratic policy, and a small ellipsoid where it comes to rest."""

import jax
import numpy as np
from jaxtyping import PRNGKeyArray
from scipy.linalg import solve_continuous_are

from neuralgaits.systems.cartpole.cartpole_model import CartPole
from neuralgaits.systems.equilibrium.ellipsoid_training import EllipsoidRecipe, EllipsoidStart
from neuralgaits.systems.equilibrium.velocity_policy import Controls, ErrorDecay, VelocityPolicy

RECIPE = EllipsoidRecipe(
    samples=1024,
    worst=32,
    target=0.03,
    targets={"descent": 0.1, "settling": 0.1},
    gain=0.03,
    penalty=2.0,
    learning_rate=0.05,
    last_share=0.01,
)


def linear_start(robot: CartPole, width: int, key: PRNGKeyArray) -> EllipsoidStart:
    """Return a linear-quadratic policy for the linearised zero dynamics, and a small ellipsoid."""
    # Angular velocity of the pole that is weighed like one metre and one radian [rad/s].
    turning = 3.0
    a, b = robot.linearised()
    scale = np.array([1.0, 1.0, turning * robot.inertia])
    riccati = solve_continuous_are(a, b[:, None], np.diag(scale**-2.0), np.eye(1))
    first, second = jax.random.split(key)
    policy = VelocityPolicy.init(-b @ riccati, scale, width, first)
    decay = ErrorDecay.init(5.0, np.append(scale, 1.0), width, second)
    sizes = np.array([1.0, 1.0, 1.0, turning])
    share = 0.05  # Of an ellipsoid of unit Lyapunov weights.
    return EllipsoidStart.linear(robot, Controls(policy, decay), sizes, share)
