"""Array type aliases: axes are named, so a signature states its shapes.

Axis names used throughout: `n` generalised coordinates, `m` actuated joints, `k` joints without
motors (n - m), `d` a zero dynamics state, 2 k numbers, `N` samples, `two_n` and `two_m` 2 n and
2 m: a state, the outputs with their rates.
"""

import jax
import numpy as np
from jaxtyping import Bool, Float, Int

Array = jax.Array | np.ndarray

Scalar = Float[Array, ""]
Coordinates = Float[Array, " n"]
Actuated = Float[Array, " m"]
Positions = Float[Array, " k"]
ZeroState = Float[Array, " d"]
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
    "Positions",
    "Scalar",
    "ZeroState",
]
