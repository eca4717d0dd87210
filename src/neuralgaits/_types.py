"""Array type aliases: axes are named, so a signature states its shapes.

Axis names used throughout: `n` generalised coordinates, `m` actuated joints (n - 1),
`N` samples.
"""

import jax
import numpy as np
from jaxtyping import Bool, Float, Int

Array = jax.Array | np.ndarray

Scalar = Float[Array, ""]
Coordinates = Float[Array, " n"]
Actuated = Float[Array, " m"]
ZeroState = Float[Array, "2"]
FullState = Float[Array, " 2n"]
Planar = Float[Array, "2"]

__all__ = [
    "Actuated",
    "Array",
    "Bool",
    "Coordinates",
    "Float",
    "FullState",
    "Int",
    "Planar",
    "Scalar",
    "ZeroState",
]
