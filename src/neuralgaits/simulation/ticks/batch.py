"""Compile the tick of many episodes once.

A call of compiled code costs time for every array that goes in or comes out, more than the
arithmetic on one robot. Carries, readings, outcomes and records are therefore packed, one array
each, at this edge.
"""

from collections.abc import Callable, Sequence
from functools import lru_cache
from typing import Any, NamedTuple

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jax.flatten_util import ravel_pytree

from neuralgaits._quick_jit import quick_jit
from neuralgaits._types import Array, Float, Int
from neuralgaits.simulation.ticks.scene import PlantReading, Scene
from neuralgaits.simulation.ticks.tick import begin, tick


class Batch(NamedTuple):
    """Compiled tick of a batch of episodes."""

    tick: Callable[..., tuple[jax.Array, jax.Array, jax.Array]]
    """Function from (arrays, carry, reading) to (carry, outcome, record), each packed. [B, ...]"""
    arrays: list[jax.Array]
    """Arrays with the numbers of the scene."""
    carry: jax.Array
    """Carry of the first tick, packed. [B, ...]"""
    carry_of: "Unpack"
    """Function from packed carries to a `Carry` with a leading axis."""
    outcome_of: "Unpack"
    """Function from packed outcomes to a `TickOutcome` with a leading axis."""
    record_of: "Unpack"
    """Function from packed records to a `TickRecord` with a leading axis."""


class Unpack:
    """Inverse of packing: from an array [B, ...] to a tree whose leaves have a leading axis."""

    def __init__(self, shapes: Any):
        """Learn the layout from a tree of shapes and dtypes of one episode."""
        leaves, self._tree = jax.tree.flatten(shapes)
        ends = np.cumsum([leaf.size for leaf in leaves])
        self._parts = [
            (slice(end - leaf.size, end), leaf.shape, leaf.dtype)
            for leaf, end in zip(leaves, ends, strict=True)
        ]

    def __call__(self, packed: Array) -> Any:
        """Return the tree. Its leaves are NumPy arrays."""
        array = np.asarray(packed)
        return jax.tree.unflatten(
            self._tree,
            [
                array[:, part].reshape(len(array), *shape).astype(dtype, copy=False)
                for part, shape, dtype in self._parts
            ],
        )


def compile_batch(scene: Scene, legs: Int[np.ndarray, " B"], *, shared: bool) -> Batch:
    """Compile the tick for episodes that start on `legs`.

    Args:
        scene: scene of all episodes.
        legs: stance leg of each episode at its start. [B]
        shared: whether all episodes have the same policy.

    Returns: `Batch`. A scene of the same structure is compiled only once in a process.
    """
    fixed = eqx.filter(scene, eqx.is_array, inverse=True)
    tree = jax.tree.structure(_numbers(scene))
    fixed_leaves, fixed_tree = jax.tree.flatten(fixed)
    run, first, shapes_of = _compiled(tree, tuple(fixed_leaves), fixed_tree, shared)
    leaves = numbers(scene)
    carry = first(leaves, jnp.asarray(legs, jnp.int32))
    shapes = shapes_of(leaves, carry, jnp.zeros((len(legs), scene.reading_size)))
    return Batch(run, leaves, carry, *(Unpack(shape) for shape in shapes))


def numbers(scene: Scene) -> list[jax.Array]:
    """Return the `arrays` of a batch for another scene of equal structure, without compilation."""
    return [jnp.asarray(leaf) for leaf in jax.tree.leaves(_numbers(scene))]


def pack(tree: PlantReading) -> Float[np.ndarray, "B r"]:
    """Pack a tree whose leaves have a leading axis of episodes into one array. [B, ...]."""
    return np.concatenate([leaf.reshape(len(leaf), -1) for leaf in tree], axis=1)


def _numbers(scene: Scene) -> tuple[Any, Scene]:
    """Split a scene into parts that may differ between episodes, and all others."""
    arrays = eqx.filter(scene, eqx.is_array)
    return _own_parts(arrays), eqx.tree_at(_own_parts, arrays, (None, None))


def _own_parts(scene: Scene):
    """Return the parts of a scene that may differ between episodes."""
    return scene.controller.policy, scene.controller.bounds


@lru_cache(maxsize=16)
def _compiled(tree: Any, fixed_leaves: tuple, fixed_tree: Any, shared: bool):
    fixed = jax.tree.unflatten(fixed_tree, fixed_leaves)
    own_axis = None if shared else 0

    def whole(own: Any, common: Scene) -> Scene:
        arrays = eqx.tree_at(_own_parts, common, own, is_leaf=lambda leaf: leaf is None)
        return eqx.combine(arrays, fixed)

    shapes: dict[tuple, tuple[Any, Any, Any]] = {}
    unpacked: dict[tuple, Callable[[Any], Any]] = {}

    def one_tick(own: Any, common: Scene, packed: Any, reading: Any):
        scene = whole(own, common)
        carry = unpacked[_kinds((own, common))](packed)
        parts = tick(scene, carry, scene.reading(reading))
        # Noted while it is traced: what is packed has lost them.
        shapes[_kinds((own, common, packed, reading))] = jax.tree.map(_kind, parts)
        return tuple(ravel_pytree(part)[0] for part in parts)

    def one_start(own: Any, common: Scene, leg: Array):
        # Noted while it is traced: `first` runs before the first tick, whose carry this is.
        packed, unpacked[_kinds((own, common))] = ravel_pytree(begin(whole(own, common), leg))
        return packed

    every_tick: Callable[..., Any] = jax.vmap(one_tick, in_axes=(own_axis, None, 0, 0))
    every_start: Callable[..., Any] = jax.vmap(one_start, in_axes=(own_axis, None, 0))

    @quick_jit
    def run(leaves: Sequence[Array], packed: Array, reading: Array):
        return every_tick(*jax.tree.unflatten(tree, leaves), packed, reading)

    @quick_jit
    def first(leaves: Sequence[Array], legs: Array):
        return every_start(*jax.tree.unflatten(tree, leaves), legs)

    def shapes_of(leaves: Sequence[Array], carry: Array, reading: Array) -> tuple[Any, Any, Any]:
        """Return the shapes of one episode. JAX keeps the trace for the first call of `run`."""
        run.trace(leaves, carry, reading)  # pyright: ignore[reportFunctionMemberAccess]
        own, common = jax.tree.unflatten(tree, leaves)
        if not shared:
            own = jax.tree.map(lambda leaf: leaf[0], own)
        return shapes[_kinds((own, common, carry[0], reading[0]))]

    return run, first, shapes_of


def _kind(leaf: Array) -> jax.ShapeDtypeStruct:
    return jax.ShapeDtypeStruct(leaf.shape, leaf.dtype)


def _kinds(parts: Any) -> tuple:
    return tuple((leaf.shape, str(leaf.dtype)) for leaf in jax.tree.leaves(parts))
