"""Fresh samples of every region: stratified along the phase, uniform across the tube."""

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import PRNGKeyArray

from neuralgaits._types import Array, Float
from neuralgaits.barriers import Box


class Sampler(NamedTuple):
    """A plan of one batch: each row is a stratum of a box of a region.

    Attributes:
        low, high: corners of each row's stratum in the chart. [N, 2]
        rows: region name to its rows.
    """

    low: Float[np.ndarray, "N 2"]
    high: Float[np.ndarray, "N 2"]
    rows: dict[str, slice]

    @classmethod
    def plan(
        cls,
        regions: Mapping[str, Sequence[Box]],
        counts: Mapping[str, int],
        overshoot: tuple[float, float] = (0.0, 0.0),
    ) -> "Sampler":
        """Lay out the strata.

        Args:
            regions: name to boxes of the chart.
            counts: name to number of samples.
            overshoot: how far samples reach beyond the chart's own edges, per axis.
        """
        lows, highs, rows, position = [], [], {}, 0
        for name, count in counts.items():
            for box, share in zip(regions[name], _shares(regions[name], count), strict=True):
                low, high = _stretched(box, overshoot)
                edges = np.linspace(low[0], high[0], share + 1)
                lows.append(np.stack([edges[:-1], np.full(share, low[1])], axis=1))
                highs.append(np.stack([edges[1:], np.full(share, high[1])], axis=1))
            rows[name] = slice(position, position + count)
            position += count
        return cls(np.concatenate(lows), np.concatenate(highs), rows)

    def draw(self, key: PRNGKeyArray) -> Float[Array, "N 2"]:
        """One uniform point a stratum. Returns: [N, 2] (phase, level)."""
        share = jax.random.uniform(key, self.low.shape, dtype=jnp.zeros(0).dtype)
        return self.low + (self.high - self.low) * share


def contains(outer: Sequence[Box], inner: Sequence[Box]) -> bool:
    """Whether every inner box lies in one of the outer boxes."""
    return all(
        any(all(o.low[k] <= i.low[k] and i.high[k] <= o.high[k] for k in (0, 1)) for o in outer)
        for i in inner
    )


def _shares(boxes: Sequence[Box], count: int) -> list[int]:
    """How many of the samples each box gets: by its length in phase."""
    lengths = np.array([box.high[0] - box.low[0] for box in boxes])
    lengths = lengths if np.any(lengths > 0) else np.ones(len(boxes))
    ends = np.round(np.cumsum(lengths) / np.sum(lengths) * count).astype(int)
    return list(np.diff(np.concatenate([[0], ends])))


def _stretched(box: Box, overshoot: tuple[float, float]) -> tuple[list[float], list[float]]:
    low, high = list(box.low), list(box.high)
    for axis, reach in enumerate(overshoot):
        if box.low[axis] < box.high[axis]:
            low[axis] -= reach if box.low[axis] == 0.0 else 0.0
            high[axis] += reach if box.high[axis] == 1.0 else 0.0
    return low, high
