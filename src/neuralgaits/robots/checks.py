"""Checks of arguments of public methods: one state of the right size, in finite numbers."""

from typing import Any

import jax.numpy as jnp
import numpy as np
from jax.core import Tracer

from neuralgaits._types import Array, Float
from neuralgaits.errors import InputError


def vector(name: str, value: Any, size: int) -> Float[Array, " k"]:
    """Check one vector. A traced one has no values yet, so only its shape counts.

    Args:
        name: name of the vector in the message.
        value: an array, or anything that can become one.
        size: number of entries expected.

    Returns: the array. [size]
    Raises: InputError if the shape is another, or a number is not finite.
    """
    array = jnp.asarray(value)
    if array.shape != (size,):
        raise InputError(
            f"{name}: expected shape ({size},), found {array.shape}; use jax.vmap for batches"
        )
    if not isinstance(array, Tracer) and not np.all(np.isfinite(array)):
        raise InputError(f"{name}: expected finite numbers, found {np.asarray(array).tolist()}")
    return array
