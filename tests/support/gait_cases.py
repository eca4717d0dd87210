"""Robots under policies that turn every term on, and all they imply at many states."""

from dataclasses import dataclass
from functools import cached_property

import jax
import jax.numpy as jnp
import numpy as np

from neuralgaits.gait import HybridInvariantPolicy, MLPPolicy, ZeroDynamics
from neuralgaits.robots import load_robot
from neuralgaits.robots.mjcf.loader import robot_from_text
from support.random_biped import random_biped

STATES = 24


def residual(z):
    """A smooth residual of the zero dynamics, large enough to be seen (m/s, N m)."""
    return jnp.stack([0.05 * jnp.sin(3.0 * z[0]) + 2e-3 * z[1], jnp.cos(z[0] + 0.1 * z[1])])


@dataclass(frozen=True)
class Case:
    """A robot, a policy, and states it may walk through."""

    name: str

    @cached_property
    def robot(self):
        if "-" not in self.name:
            return load_robot(self.name)
        kind, links = self.name.split("-")
        return robot_from_text(random_biped(7, int(links), torso=kind == "torso"), self.name)

    @cached_property
    def policy(self):
        """By construction hybrid invariant on the built-in robots, a free network elsewhere."""
        key = jax.random.key(3)
        if "-" not in self.name:
            return HybridInvariantPolicy.init(self.robot, key=key, hidden=(8, 8))
        activation = "softplus" if self.name == "torso-2" else "tanh"
        return MLPPolicy.init(self.robot, key=key, hidden=(8,), activation=activation)

    @cached_property
    def zd(self):
        return ZeroDynamics(self.robot, self.policy)

    @cached_property
    def z(self):
        """States over the step and a wide range of momenta. [STATES, 2]."""
        draw = np.random.default_rng(5)
        start, guard = (float(end) for end in self.policy.z1_range)
        scale, shift = self.policy.input_scale[1], self.policy.input_shift[1]
        first = draw.uniform(start, guard, STATES)
        return np.stack([first, scale * (shift + draw.uniform(-1.0, 1.0, STATES))], axis=1)


CASES = {name: Case(name) for name in ("amber3m", "rabbit", "torso-2", "legs-2")}
