"""How a box is halved, and the tree of halvings as a string of bits.

A split halves every axis whose width is not zero, at low + (high - low) / 2 in float64, which
every reader computes alike. Children stand in the order (low, low), (high, low), (low, high),
(high, high) of (phase, level), or low, high on a curve. The tree is written depth first: 1 for a
split, 0 for a leaf. So leaves cover their root by construction: there is no list to be trusted.
"""

import numpy as np

from neuralgaits._types import Float

Corners = Float[np.ndarray, "n 2"]
Halves = Float[np.ndarray, "halves 2"]


def split_axes(low: np.ndarray, high: np.ndarray) -> tuple[int, ...]:
    """Axes along which a box is split: those of positive width, (0, 1), (0,), (1,) or ()."""
    return tuple(axis for axis in (0, 1) if high[axis] > low[axis])


def halves(low: Corners, high: Corners, axes: tuple[int, ...]) -> tuple[Halves, Halves]:
    """Children of boxes, those of one box together. Returns: corners. [n 2^axes, 2]."""
    middle = low + (high - low) * 0.5
    lows, highs = [], []
    for child in range(2 ** len(axes)):
        child_low, child_high = low.copy(), high.copy()
        for place, axis in enumerate(axes):
            if child >> place & 1:
                child_low[:, axis] = middle[:, axis]
            else:
                child_high[:, axis] = middle[:, axis]
        lows.append(child_low)
        highs.append(child_high)
    return np.stack(lows, axis=1).reshape(-1, 2), np.stack(highs, axis=1).reshape(-1, 2)


def to_bits(first: np.ndarray, leaf: np.ndarray, children: int) -> str:
    """The bit string of a tree cut at its first leaves.

    Args:
        first: number of each node's first child, the others following it; -1 without. [N]
        leaf: where to stop. Every node without children must be one. [N]
        children: how many a node has.
    """
    bits, stack = [], [0]
    while stack:
        node = stack.pop()
        if leaf[node]:
            bits.append("0")
        elif first[node] < 0:
            raise ValueError(f"expected every end of the tree to be a leaf, found node {node} open")
        else:
            bits.append("1")
            start = int(first[node])
            stack.extend(range(start + children - 1, start - 1, -1))
    return "".join(bits)
