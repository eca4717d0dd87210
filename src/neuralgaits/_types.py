"""Array type aliases: axes are named, so a signature states its shapes.

Axis names used throughout: `n` generalised coordinates, `m` actuated joints (n - 1),
`N` samples, `two_n` and `two_m` 2 n and 2 m: a state, the outputs with their rates.
"""

import jax
import numpy as np
from jaxtyping import Bool, Float, Int

Array = jax.Array | np.ndarray

Scalar = Float[Array, ""]
Coordinates = Float[Array, " n"]
Actuated = Float[Array, " m"]
ZeroState = Float[Array, "2"]
FullState = Float[Array, " two_n"]
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
