"""A bounded smooth residual of the zero dynamics. Source: paper, section 3.3."""

from itertools import pairwise

import equinox as eqx
import jax.numpy as jnp
import numpy as np
from jaxtyping import PRNGKeyArray

from neuralgaits._types import Array, Float, ZeroState
from neuralgaits.gait.activations import tanh
from neuralgaits.gait.network import Network, movable, scaled_inputs


class Residual(eqx.Module):
    """epsilon(z) = bound * tanh(N(z / scale - shift)), N a small tanh network.

    Smooth, and it can be traced into a Program. Its size is known without looking at weights.

    Attributes:
        network: N.
        scale, shift: scaling of the inputs. [2]
        bound: |epsilon| stays below it, everywhere (m/s, N m). [2]
    """

    network: Network
    scale: Float[Array, "2"]
    shift: Float[Array, "2"]
    bound: Float[Array, "2"]

    @classmethod
    def init(
        cls,
        states: Float[np.ndarray, "N 2"],
        defects: Float[np.ndarray, "N 2"],
        *,
        hidden: tuple[int, ...],
        key: PRNGKeyArray,
    ) -> "Residual":
        """Start near zero, with scales and bound from the data to learn from.

        Args:
            states: visited (m, kg m^2/s).
            defects: measured minus modelled rate there (m/s, N m).
            hidden: widths of the hidden layers.
            key: random key of the network.
        """
        # Inputs are scaled by this many standard deviations of the states learned from.
        scale = 1.5 * np.maximum(np.std(states, axis=0), 1e-3 * np.abs(states).max(axis=0))
        # A residual is bounded by twice this quantile of the defects it is learned from.
        sizes = np.quantile(np.abs(defects), 0.99, axis=0)
        network = Network.init((2, *hidden, 2), activation="tanh", key=key, near=np.zeros(2))
        # Bounds where the model has no defect (m/s, N m): a bound of zero has no gradient.
        least_bound = (1e-3, 1e-2)
        bound = np.maximum(2.0 * sizes, least_bound)
        return cls(network, scale, np.mean(states, axis=0) / scale, bound)

    @classmethod
    def like(cls, hidden: tuple[int, ...]) -> "Residual":
        """A residual of zeros with these widths: the structure to read a stored one into."""
        sizes = (2, *hidden, 2)
        weights = tuple(np.zeros((b, a)) for a, b in pairwise(sizes))
        biases = tuple(np.zeros(b) for b in sizes[1:])
        return cls(Network(weights, biases, "tanh"), np.ones(2), np.zeros(2), np.ones(2))

    def __call__(self, z: ZeroState) -> ZeroState:
        """Residual rate of z. Returns: [2] (m/s, N m)."""
        share = tanh(self.network(scaled_inputs(z, self.scale, self.shift)))
        return jnp.asarray(self.bound) * share

    def trainable(self) -> "Residual":
        """A tree of booleans: the network may move; scales and bound are fixed."""
        return movable(self, lambda residual: residual.network)
