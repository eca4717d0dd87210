"""Change the precision of every array in a tree: training is float32, results are float64."""

from typing import TypeVar

import equinox as eqx
import jax
import numpy as np

Tree = TypeVar("Tree")
Named = TypeVar("Named", bound=tuple)


def cast(tree: Tree, dtype) -> Tree:
    """The same tree with floating-point arrays in another precision, as NumPy arrays."""
    return jax.tree.map(
        lambda leaf: (
            np.asarray(leaf, dtype)
            if eqx.is_array(leaf) and np.issubdtype(leaf.dtype, np.floating)
            else leaf
        ),
        tree,
    )


def cast_named(table: Named, dtype) -> Named:
    """The same for the direct fields of a NamedTuple, leaving all others alone."""
    return type(table)(*(cast(field, dtype) if eqx.is_array(field) else field for field in table))
