"""Evaluate compiled functions of many rows in blocks of one size, so that they compile once."""

from collections.abc import Callable
from typing import Any

import jax
import numpy as np


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
