"""Halvings of boxes, and the tree of halvings as text.

A split halves one axis, at low + (high - low) / 2 in float64, which every reader computes alike.
The tree is written depth first, the lower half before the upper one: a digit (0 to 9, a to f) is
the axis that is halved, from 0 on, and `-` a leaf. So leaves cover their root by construction:
there is no list to be trusted.
"""

import numpy as np

from neuralgaits._types import Float, Int

Corners = Float[np.ndarray, "B n"]
"""One corner of each of B boxes in n dimensions."""
PerCondition = Float[np.ndarray, "B C"]
"""One number for each of C conditions, in its scale: a row for every box or point."""
LEAF, DIGITS = "-", "0123456789abcdef"


def wide_axes(low: np.ndarray, high: np.ndarray) -> tuple[int, ...]:
    """Return the axes along which a box can be halved: those of positive width."""
    return tuple(int(axis) for axis in np.flatnonzero(np.asarray(high) > np.asarray(low)))


def halves(
    low: Corners, high: Corners, axis: Int[np.ndarray, " B"]
) -> tuple[Float[np.ndarray, "B2 n"], Float[np.ndarray, "B2 n"]]:
    """Return both halves of boxes, each along its axis, the lower half first. [2B, n]."""
    rows = np.arange(len(low))
    middle = (low + (high - low) * 0.5)[rows, axis]
    lows, highs = np.repeat(low, 2, axis=0), np.repeat(high, 2, axis=0)
    highs[2 * rows, axis] = middle
    lows[2 * rows + 1, axis] = middle
    return lows, highs


def boxes_of(
    first: np.ndarray, axis: np.ndarray, low: np.ndarray, high: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return corners of all boxes of a tree, and how often each axis was halved. [N, n] each.

    Args:
        first: number of each node's lower half, the upper one following it; -1 without. [N]
        axis: along which each node is halved. [N]
        low: lower corner of the root. [n]
        high: upper corner of the root. [n]
    """
    lows, highs = np.tile(low, (len(first), 1)), np.tile(high, (len(first), 1))
    cuts = np.zeros(lows.shape, np.int64)
    parents = np.zeros(1, np.int64)
    while len(parents := parents[first[parents] >= 0]):
        parts = halves(lows[parents], highs[parents], axis[parents])
        family = np.repeat(parents, 2)
        children = first[family] + np.arange(len(family)) % 2
        lows[children], highs[children] = parts
        cuts[children] = cuts[family]
        cuts[children, axis[family]] += 1
        parents = children
    return lows, highs, cuts


def to_text(first: np.ndarray, axis: np.ndarray, leaf: np.ndarray) -> str:
    """Return the text of a tree cut at its first leaves.

    Args:
        first: number of each node's lower half, the upper one following it; -1 without. [N]
        axis: along which each node is halved. [N]
        leaf: nodes at which to stop. Every node without halves must be one. [N]
    """
    text, stack = [], [0]
    while stack:
        node = stack.pop()
        if leaf[node]:
            text.append(LEAF)
        elif first[node] < 0:
            raise ValueError(f"expected every end of the tree to be a leaf, found node {node} open")
        else:
            text.append(DIGITS[axis[node]])
            start = int(first[node])
            stack += (start + 1, start)
    return "".join(text)
