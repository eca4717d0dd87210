"""Disturbances of dz in training: each sample meets one corner of their box.

Forces on a simulated robot are in `simulation.setup.push`.
"""

from collections.abc import Callable
from typing import NamedTuple

import jax
import jax.numpy as jnp

from neuralgaits._types import Array, Float, Scalar, ZeroState

DisturbanceBox = tuple[float, float] | None
"""Bounds of the addition to dz (m/s, N m)."""


class DisturbedResidual(NamedTuple):
    """A residual of the flow, or none, with a constant added."""

    flow: Callable[[ZeroState], ZeroState] | None
    push: ZeroState

    def __call__(self, z: ZeroState) -> ZeroState:
        """Return the addition to dz. Returns: [2] (m/s, N m)."""
        return self.push if self.flow is None else self.flow(z) + self.push


def pushes_of(
    disturbance: DisturbanceBox, key: Array, count: int, dtype, share: Scalar | float = 1.0
) -> Float[Array, "N 2"] | None:
    """Return a random corner for each sample: the worst of a box is there, or near it.

    Args:
        disturbance: half widths of the box.
        key: random key.
        count: number of samples.
        dtype: type of the pushes.
        share: share of the box that is used.

    Returns: [N, 2] (m/s, N m), None for no disturbance.
    """
    if disturbance is None:
        return None
    signs = jax.random.rademacher(jax.random.fold_in(key, 1), (count, 2), dtype)
    return (share * jnp.array(disturbance)).astype(dtype)[None] * signs
