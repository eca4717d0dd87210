"""Data movement of JAX, performed on integer arrays.

An array being traced is an array of elements, and a mask or an index is an array of known
numbers; slicing or transposing either is the same NumPy call. Parameters are those of the JAX
primitives of the same name.
"""

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

Arrays = list[np.ndarray]


def broadcast_in_dim(arrays: Arrays, params: Mapping[str, Any]) -> Arrays:
    """Put the axes of the operand at `broadcast_dimensions` of `shape`."""
    shape = [1] * len(params["shape"])
    for axis, size in zip(params["broadcast_dimensions"], arrays[0].shape, strict=True):
        shape[axis] = size
    return [np.broadcast_to(arrays[0].reshape(shape), params["shape"])]


def concatenate(arrays: Arrays, params: Mapping[str, Any]) -> Arrays:
    """Join arrays along the axis `dimension`."""
    return [np.concatenate(arrays, axis=params["dimension"])]


def pad(arrays: Arrays, params: Mapping[str, Any]) -> Arrays:
    """Pad with a scalar: low and high (both may be negative), and between elements."""
    operand, value = arrays
    for axis, (low, high, between) in enumerate(params["padding_config"]):
        size = operand.shape[axis]
        inner = max(size + between * max(size - 1, 0), 0)
        shape = list(operand.shape)
        shape[axis] = inner + max(low, 0) + max(high, 0)
        padded = np.full(shape, value)
        place = [slice(None)] * operand.ndim
        place[axis] = slice(max(low, 0), max(low, 0) + inner, between + 1)
        padded[tuple(place)] = operand
        place[axis] = slice(max(-low, 0), shape[axis] - max(-high, 0))
        operand = padded[tuple(place)]
    return [operand]


def reshape(arrays: Arrays, params: Mapping[str, Any]) -> Arrays:
    """Reshape an array in row-major order."""
    return [arrays[0].reshape(params["new_sizes"])]


def rev(arrays: Arrays, params: Mapping[str, Any]) -> Arrays:
    """Reverse an array along the axes `dimensions`."""
    return [np.flip(arrays[0], axis=tuple(params["dimensions"]))]


def select_n(arrays: Arrays, params: Mapping[str, Any]) -> Arrays:
    """Choose element by element; the predicate is known."""
    which, *cases = arrays
    shape = np.broadcast_shapes(*(array.shape for array in arrays))
    which, *cases = (np.broadcast_to(array, shape) for array in (which.astype(int), *cases))
    return [np.take_along_axis(np.stack(cases), which[None], axis=0)[0]]


def slice_(arrays: Arrays, params: Mapping[str, Any]) -> Arrays:
    """Take a slice with fixed limits and strides."""
    strides = params["strides"] or (1,) * arrays[0].ndim
    limits = zip(params["start_indices"], params["limit_indices"], strides, strict=True)
    return [arrays[0][tuple(slice(*limit) for limit in limits)]]


def split(arrays: Arrays, params: Mapping[str, Any]) -> Arrays:
    """Cut into pieces of `sizes` along `axis`."""
    cuts = np.cumsum(params["sizes"])[:-1]
    return list(np.split(arrays[0], cuts, axis=params["axis"]))


def squeeze(arrays: Arrays, params: Mapping[str, Any]) -> Arrays:
    """Remove axes of length 1 from an array."""
    return [np.squeeze(arrays[0], axis=tuple(params["dimensions"]))]


def stack(arrays: Arrays, params: Mapping[str, Any]) -> Arrays:
    """Join arrays along a new axis."""
    return [np.stack(arrays, axis=params["axis"])]


def tile(arrays: Arrays, params: Mapping[str, Any]) -> Arrays:
    """Repeat whole arrays along each axis."""
    return [np.tile(arrays[0], params["reps"])]


def transpose(arrays: Arrays, params: Mapping[str, Any]) -> Arrays:
    """Permute the axes of an array."""
    return [np.transpose(arrays[0], params["permutation"])]


def unstack(arrays: Arrays, params: Mapping[str, Any]) -> Arrays:
    """Cut into arrays without the axis `axis`."""
    return list(np.moveaxis(arrays[0], params["axis"], 0))


def unchanged(arrays: Arrays, params: Mapping[str, Any]) -> Arrays:
    """Return every operand unchanged, as the primitive does."""
    return arrays


MOVEMENT: dict[str, Callable[[Arrays, Mapping[str, Any]], Arrays]] = {
    "broadcast_in_dim": broadcast_in_dim,
    "concatenate": concatenate,
    "copy": unchanged,
    "copy_p": unchanged,
    "optimization_barrier": unchanged,
    "pad": pad,
    "reshape": reshape,
    "rev": rev,
    "select_n": select_n,
    "slice": slice_,
    "split": split,
    "squeeze": squeeze,
    "stack": stack,
    "tile": tile,
    "transpose": transpose,
    "unstack": unstack,
}

INDEXED = frozenset({"gather", "dynamic_slice"})
"""Movement at known places whose rules are JAX's own: they are run on the elements by JAX."""


def outside(name: str, arrays: Arrays, params: Mapping[str, Any]) -> str:
    """Describe an index that lies beyond its array, which JAX moves to the nearest end in silence.

    Args:
        name: name of the primitive, one of `INDEXED`.
        arrays: its operands: the array, then the known places.
        params: its parameters. An index with a mode (`clip`, `fill`) is meant so.

    Returns: words for a refusal; empty if all places are inside.
    """
    operand, *places = arrays
    if name == "dynamic_slice":
        axes, starts = range(operand.ndim), np.stack(places, axis=-1)
    elif "PROMISE" in str(params["mode"]):
        axes, starts = params["dimension_numbers"].start_index_map, places[0]
    else:
        return ""
    for column, axis in enumerate(axes):
        size, start = operand.shape[axis], starts[..., column]
        wrong = (start < 0) | (start + params["slice_sizes"][axis] > size)
        if np.any(wrong):
            # JAX has added the size to an index that counts from the end.
            place = int(start[wrong].flat[0])
            place -= size if place < 0 else 0
            return f"index {place} of an axis of {size}"
    return ""
