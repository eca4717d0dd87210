"""A small linear solve without LAPACK.

Batched LAPACK calls inside jitted code have hung on CPU back ends of JAX, and no interpreter
of a Program can read them. Gauss-Jordan elimination without pivoting is safe for the symmetric
positive definite matrices it is used on here: every pivot is a Schur complement, hence positive.
"""

import jax.numpy as jnp
import numpy as np

from neuralgaits._types import Array, Float


def solve(matrix: Float[Array, "n n"], right: Float[Array, " n"]) -> Float[Array, " n"]:
    """Solve `matrix @ x = right` for a symmetric positive definite matrix.

    Returns: [n].
    """
    size = matrix.shape[0]
    table = jnp.concatenate([matrix, right[:, None]], axis=1)
    for k in range(size):
        row = table[k] / table[k, k]
        column = table[:, k] - np.eye(size, dtype=table.dtype)[k]
        table = table - column[:, None] * row[None, :]
    return table[:, size]


def pivots(matrix: Float[Array, "n n"]) -> Float[Array, " n"]:
    """Return the pivots of a symmetric matrix: all are positive if and only if it is definite.

    Only then are they its own; behind the first that is not positive they mean nothing.

    Returns: [n], in the units of the matrix.
    """
    diagonal = [matrix[0, 0]]
    while len(matrix) > 1:
        row = matrix[0, 1:]
        matrix = matrix[1:, 1:] - row[:, None] * (row / diagonal[-1])[None, :]
        diagonal.append(matrix[0, 0])
    return jnp.stack(diagonal)
