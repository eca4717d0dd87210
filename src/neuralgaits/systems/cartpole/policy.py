"""The policy: the cart's desired velocity as an odd function of the zero dynamics' state."""

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
    """v_d(z) = gains . a + output . tanh(hidden a) with a = z / scale and z = (x, theta, s).

    Without biases it is odd, so the upright at the middle of the rail is an equilibrium exactly.

    Attributes:
        gains: of the linear part [m/s]. [3]
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
        """Return the desired velocity [m/s]."""
        inputs = z / self.scale
        return self.gains @ inputs + self.output @ tanh(self.hidden @ inputs)
