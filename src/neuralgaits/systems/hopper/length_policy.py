"""The policy: the leg's length in stance, over the progress of the stance and the momentum."""

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import PRNGKeyArray

from neuralgaits._types import Array, Float
from neuralgaits.gait.activations import tanh
from neuralgaits.systems.hopper.hop_tube import polynomial
from neuralgaits.systems.hopper.hopper_model import Flight, Hopper, flight


class LengthPolicy(eqx.Module):
    """l(s, sigma) = cubic(s) + 16 s^2 (1 - s)^2 (2 s - 1) network(s, sigma), s from 0 to 1.

    The network leaves value and slope at both ends. So lift-off and touchdown are as the ends say,
    and every stance begins where the flight before it ended, at any momentum.

    Attributes:
        ends: lean at touchdown and lift-off [rad], length [m] and its slope over the lean [m/rad]
            at lift-off. [4]
        gain: gain on the energy [m].
        hidden, bias: weights and biases of the hidden layer. [h, 2], [h]
        output: weights of the output [m]. [h]
        reference: coefficients of the energy sigma^2 / 2 at which the gain adds nothing. [a]
        scale: unit of energies beside it [kg^2 m^4/s^2].
    """

    ends: Float[Array, "4"]
    gain: Float[Array, ""]
    hidden: Float[Array, "h 2"]
    bias: Float[Array, " h"]
    output: Float[Array, " h"]
    reference: Float[Array, " a"]
    scale: Float[Array, ""]

    @classmethod
    def init(cls, ends: np.ndarray, gain: float, width: int, key: PRNGKeyArray):
        """Return a policy near a gain on the energy, with a reference of 0."""
        first, second = jax.random.split(key)
        hidden = jax.random.normal(first, (width, 2))
        output = 0.01 * abs(gain) * jax.random.normal(second, (width,))
        start = jnp.asarray(ends), jnp.asarray(gain), hidden, jnp.zeros(width), output
        return cls(*start, jnp.zeros(1), jnp.ones(()))

    @property
    def sweep(self) -> Float[Array, ""]:
        """Range of the lean over a stance [rad]."""
        ends = jnp.asarray(self.ends)
        return ends[1] - ends[0]

    def lean(self, s: Float[Array, ""]) -> Float[Array, ""]:
        """Return theta at a progress of the stance [rad]."""
        return jnp.asarray(self.ends)[0] + self.sweep * s

    def landing_length(self, robot: Hopper) -> Float[Array, ""]:
        """Return the length at touchdown: the centre of mass is as high as at lift-off [m]."""
        touch, lift, length, _ = jnp.asarray(self.ends)
        moment = robot.mass_moment(length) * jnp.cos(lift) / jnp.cos(touch)
        return robot.length_with_moment(moment)

    def flight(self, robot: Hopper) -> Flight:
        """Return the flight between two stances."""
        touch, lean, length, push = jnp.asarray(self.ends)
        return flight(robot, (lean, length, push), (touch, self.landing_length(robot)))

    def length(
        self, robot: Hopper, s: Float[Array, ""], sigma: Float[Array, ""]
    ) -> Float[Array, ""]:
        """Return the leg's desired length [m]."""
        low, high = self.landing_length(robot), self.ends[2]
        first, last = self.flight(robot).slope * self.sweep, self.ends[3] * self.sweep
        # The cubic with these values and slopes at both ends.
        rise = high - low
        cubic = low + s * (
            first + s * (3.0 * rise - 2.0 * first - last + s * (first + last - 2.0 * rise))
        )
        centred = 2.0 * s - 1.0
        beside = 0.5 * sigma * sigma - polynomial(self.reference, s)
        inputs = jnp.stack([centred, beside / self.scale])
        network = self.gain * inputs[1] + self.output @ tanh(self.hidden @ inputs + self.bias)
        bump = s * (1.0 - s)
        return cubic + 16.0 * bump * bump * centred * network
