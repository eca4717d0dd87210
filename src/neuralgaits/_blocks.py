"""Evaluate compiled functions of many rows in blocks of one size, so that they compile once."""

from collections.abc import Callable
from functools import partial, wraps
from typing import Any

import jax
import numpy as np

from neuralgaits._quick_jit import quick_filter_jit

RowFunction = Callable[..., Any]
"""Function of one object, as a robot, and of arrays, to an array with as many rows."""


def in_blocks_of(size: int) -> Callable[[RowFunction], RowFunction]:
    """Compile the decorated function once, and evaluate it on `size` rows at a time.

    It is then called with its object and with NumPy arrays of any number of rows, and returns NumPy
    arrays. A row of its results may depend on that row alone.
    """

    def decorate(function: RowFunction) -> RowFunction:
        compiled = quick_filter_jit(function)

        @wraps(function)
        def call(about: Any, *arrays: np.ndarray) -> Any:
            return in_blocks(partial(compiled, about), size, *arrays)

        return call

    return decorate


def in_blocks(function: Callable[..., Any], size: int, *arrays: np.ndarray) -> Any:
    """Evaluate a function row by row, on `size` rows at a time.

    Args:
        function: function of blocks of all arrays, [size, ...] each, to arrays with as many rows,
            or to a tree of them; a row of its results depends on that row alone.
        size: number of rows of a block.
        arrays: all inputs. [k, ...] each.

    Returns: what the function returns, as NumPy arrays with k rows.
    """
    count = len(arrays[0])
    whole = [_in_whole_blocks(array, size) for array in arrays]
    parts = [
        function(*(array[first : first + size] for array in whole))
        for first in range(0, len(whole[0]), size)
    ]
    return jax.tree.map(
        lambda *blocks: np.concatenate([np.asarray(block) for block in blocks])[:count], *parts
    )


def _in_whole_blocks(array: np.ndarray, size: int) -> np.ndarray:
    """Fill up the last block; an array without rows becomes a block of zeros."""
    if not len(array):
        return np.zeros((size, *array.shape[1:]), array.dtype)
    # The last row again: padding must not leave the domain of the function.
    return np.concatenate([array, np.repeat(array[-1:], -len(array) % size, axis=0)])
