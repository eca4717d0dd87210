"""Change the precision of every array in a tree: training is float32, results are float64."""

from typing import TypeVar

import equinox as eqx
import jax
import numpy as np

Tree = TypeVar("Tree")
Named = TypeVar("Named", bound=tuple)


def cast(tree: Tree, dtype) -> Tree:
    """Return a tree with floating-point arrays in another precision, as NumPy arrays."""
    return jax.tree.map(
        lambda leaf: (
            np.asarray(leaf, dtype)
            if eqx.is_array(leaf) and np.issubdtype(leaf.dtype, np.floating)
            else leaf
        ),
        tree,
    )


def cast_named(table: Named, dtype) -> Named:
    """Return a NamedTuple with its direct array fields in another precision, and no others."""
    return type(table)(*(cast(field, dtype) if eqx.is_array(field) else field for field in table))
