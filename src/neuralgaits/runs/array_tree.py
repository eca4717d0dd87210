"""Pytrees of arrays as safetensors, leaf by leaf under the leaf's path.

The format holds bytes, shapes and dtypes and can run no code. A file is read *into* a tree
of the same structure: an array that does not fit is refused, never reshaped or cast.
"""

from pathlib import Path
from typing import Any, TypeVar

import jax
import jax.numpy as jnp
import numpy as np

from neuralgaits.errors import RunError
from neuralgaits.runs.arrays import packed, read_arrays
from neuralgaits.runs.atomic import write_bytes

Tree = TypeVar("Tree")


def write_tree(path: Path, tree: Any) -> None:
    """Save the arrays, random keys and Python numbers of a pytree, exactly.

    Other leaves (functions, strings) are structure and are not stored.
    """
    arrays = {name: _to_numpy(leaf) for name, leaf in _named_leaves(tree) if _is_stored(leaf)}
    write_bytes(path, packed(arrays, {}))


def read_tree(path: Path, like: Tree) -> Tree:
    """Read a file of `write_tree` into the structure of `like`.

    Leaves keep the kind they have in `like`: JAX array, NumPy array, random key or number. A
    `jax.ShapeDtypeStruct` leaf is read as a JAX array.

    Raises: RunError if the file is missing, damaged, or holds other names, shapes or dtypes.
    """
    stored, _ = read_arrays(path)
    named = _named_leaves(like)
    stored_names = {name for name, leaf in named if _is_stored(leaf)}
    for name in sorted(stored_names ^ set(stored)):
        problem = "it is missing" if name in stored_names else "the model has none"
        raise _misfit(path, f"array {name}: {problem}")
    leaves = [
        _like(path, name, stored[name], leaf) if name in stored_names else leaf
        for name, leaf in named
    ]
    return jax.tree_util.tree_unflatten(jax.tree_util.tree_structure(like), leaves)


def _named_leaves(tree: Any) -> list[tuple[str, Any]]:
    leaves, _ = jax.tree_util.tree_flatten_with_path(tree)
    return [(jax.tree_util.keystr(keys).lstrip(".") or "value", leaf) for keys, leaf in leaves]


def _is_key(leaf: Any) -> bool:
    return hasattr(leaf, "dtype") and jnp.issubdtype(leaf.dtype, jax.dtypes.prng_key)


def _is_stored(leaf: Any) -> bool:
    return isinstance(leaf, bool | int | float) or hasattr(leaf, "dtype")


def _to_numpy(leaf: Any) -> np.ndarray:
    array = np.asarray(jax.random.key_data(leaf) if _is_key(leaf) else leaf)
    # safetensors writes the buffer as it lies in memory.
    return np.array(array, order="C")


def _like(path: Path, name: str, array: np.ndarray, leaf: Any) -> Any:
    """Convert the stored array to the kind of leaf at its place in the tree."""
    if isinstance(leaf, bool | int | float):
        if array.shape == () and array.dtype == np.asarray(leaf).dtype:
            return type(leaf)(array)
        raise _misfit(path, f"{name}: expected a {type(leaf).__name__}, found {_kind(array)}")
    expected = jax.eval_shape(jax.random.key_data, leaf) if _is_key(leaf) else leaf
    if array.shape != tuple(expected.shape) or array.dtype != expected.dtype:
        raise _misfit(path, f"array {name}: expected {_kind(expected)}, found {_kind(array)}")
    if _is_key(leaf):
        return jax.random.wrap_key_data(jnp.asarray(array), impl=jax.random.key_impl(leaf))
    # jnp.asarray would compile a copy for every shape.
    return array if isinstance(leaf, np.ndarray | np.generic) else jax.device_put(array)


def _kind(array: Any) -> str:
    return f"{np.dtype(array.dtype).name}{list(array.shape)}"


def _misfit(path: Path, what: str) -> RunError:
    return RunError(
        f"{path} does not fit, {what}: use the robot, spec and sizes in the run's config.json"
    )
