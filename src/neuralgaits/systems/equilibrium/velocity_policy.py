"""The policy, the driven joint's desired velocity, and how quickly the velocity's error decays.

A state of the zero dynamics has three numbers; a fourth is the error of the velocity.
"""

from typing import Any

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import PRNGKeyArray

from neuralgaits._types import Array, Float
from neuralgaits.gait.activations import tanh

SMALL = 0.01
"""Factor on the output weights at the start: the policy starts near its linear part."""


class VelocityPolicy(eqx.Module):
    """v_d(z) = gains . a + output . tanh(hidden a) with a = z / scale.

    Without biases it is odd, so 0 is an equilibrium exactly.

    Attributes:
        gains: gains of the linear part, in units of the velocity. [3]
        hidden: weights of the hidden layer. [h, 3]
        output: weights of the output. [h]
        scale: sizes of z, which training leaves as they are. [3]
    """

    gains: Float[Array, "3"]
    hidden: Float[Array, "h 3"]
    output: Float[Array, " h"]
    scale: Float[Array, "3"]

    @classmethod
    def init(cls, gains: np.ndarray, scale: np.ndarray, width: int, key: PRNGKeyArray):
        """Return a policy near gains . z, with gains in the units of z."""
        first, second = jax.random.split(key)
        hidden = jax.random.normal(first, (width, len(scale)))
        output = SMALL * jax.random.normal(second, (width,))
        return cls(jnp.asarray(gains * scale), hidden, output, jnp.asarray(scale))

    def __call__(self, z: Float[Array, "3"]) -> Float[Array, ""]:
        """Return the desired velocity."""
        inputs = z / self.scale
        return self.gains @ inputs + self.output @ tanh(self.hidden @ inputs)


class ErrorDecay(eqx.Module):
    """The factor of e' = -decay(z, e) e: base + output . tanh(hidden ((z, e) / scale))^2 [1/s].

    It is even, and whatever it is, e = 0 stays: the zero dynamics are a part of the full order.

    Attributes:
        base: the factor at rest [1/s].
        hidden: weights of the hidden layer. [h, 4]
        output: weights of the output [1/s]. [h]
        scale: sizes of (z, e), which training leaves as they are. [4]
    """

    base: Float[Array, ""]
    hidden: Float[Array, "h 4"]
    output: Float[Array, " h"]
    scale: Float[Array, "4"]

    @classmethod
    def init(cls, base: float, scale: np.ndarray, width: int, key: PRNGKeyArray):
        """Return a factor that is nearly constant."""
        first, second = jax.random.split(key)
        hidden = jax.random.normal(first, (width, len(scale)))
        output = SMALL * jax.random.normal(second, (width,))
        return cls(jnp.asarray(base), hidden, output, jnp.asarray(scale))

    def __call__(self, y: Float[Array, "4"]) -> Float[Array, ""]:
        """Return the factor at y = (z, e)."""
        return self.base + self.output @ jnp.square(tanh(self.hidden @ (y / self.scale)))


class Controls(eqx.Module):
    """Functions of a controller: the policy, and the decay of the velocity's error."""

    policy: VelocityPolicy
    decay: ErrorDecay

    @classmethod
    def zeros(cls, width: int) -> "Controls":
        """Return functions of zeros, to read arrays into."""
        policy = VelocityPolicy(np.zeros(3), np.zeros((width, 3)), np.zeros(width), np.zeros(3))
        decay = ErrorDecay(np.zeros(()), np.zeros((width, 4)), np.zeros(width), np.zeros(4))
        return cls(policy, decay)

    def input_sizes(self) -> tuple[Any, Any]:
        """Return the sizes of inputs, which training leaves as they are."""
        return self.policy.scale, self.decay.scale
