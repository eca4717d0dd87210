"""Boxes that a proof left open, as further samples of a training.

A box that fails becomes rows of the batch: each step draws one fresh point in each. Their number
is fixed, so that a training compiles once whatever the boxes are.
"""

from collections.abc import Mapping
from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import PRNGKeyArray

from neuralgaits._types import Array, Bool, Float
from neuralgaits.barriers import Box, GaitSpec
from neuralgaits.training.loss import MarginLayout
from neuralgaits.training.sampling import contains

ROWS = 64
"""Number of rows for boxes: about half of the default batch in addition."""
LEAST_WIDTH = 1.0 / 32.0
"""Least width of a sampled box; smaller ones are widened, because repairing a point moves its
neighbours."""

Boxes = tuple[np.ndarray, np.ndarray]
"""Lower and upper corners in (phase, level). [n, 2] each."""


class Extra(NamedTuple):
    """A box of the chart for each further row of a batch.

    Attributes:
        low, high: corners. [ROWS, 2]
        counts: columns of the margin matrix that a row counts for. [ROWS, K]
    """

    low: Float[Array, "E 2"]
    high: Float[Array, "E 2"]
    counts: Bool[Array, "E K"]

    @staticmethod
    def shapes(layout: MarginLayout) -> "Extra":
        """Return shapes and types in place of the arrays."""
        corner = jax.ShapeDtypeStruct((ROWS, 2), jnp.float64)
        counts = jax.ShapeDtypeStruct((ROWS, len(layout.scale)), jnp.bool_)
        return Extra(corner, corner, counts)  # pyright: ignore[reportArgumentType]

    @classmethod
    def of(
        cls,
        boxes: Mapping[str, Boxes],
        spec: GaitSpec,
        layout: MarginLayout,
        before: "Extra | None" = None,
    ) -> "Extra":
        """Return rows for boxes: the same number for each region, evenly picked among its boxes.

        Args:
            boxes: boxes by region, at least one in all.
            spec: regions and conditions.
            layout: columns of each condition.
            before: rows of an earlier round, half of which are kept, because repaired boxes may
                fail again.
        """
        some = {region: pair for region, pair in boxes.items() if len(pair[0])}
        new = ROWS if before is None else ROWS // 2
        shares = [len(part) for part in np.array_split(np.arange(new), len(some))]
        rows = []
        for (region, (low, high)), share in zip(some.items(), shares, strict=True):
            for pick in np.linspace(0, len(low) - 1, share).round().astype(int):
                box = Box(tuple(low[pick].tolist()), tuple(high[pick].tolist()))
                rows.append(_row(region, box, spec, layout))
        rows_of_cells = cls(*(np.stack(part) for part in zip(*rows, strict=True)))
        if before is None:
            return rows_of_cells
        numbers = np.linspace(0, ROWS - 1, ROWS - new).round().astype(int)
        return cls(
            *(np.concatenate([a, b[numbers]]) for a, b in zip(rows_of_cells, before, strict=True))
        )


def with_extra(
    extra: Extra | None,
    times: int,
    u: Float[Array, "N 2"],
    counts: Bool[Array, "N K"],
    key: PRNGKeyArray,
) -> tuple[Float[Array, "M 2"], Bool[Array, "M K"]]:
    """Return a batch and its table with `times` points in each extra box. M = N + times ROWS."""
    if extra is None:
        return u, counts
    low, high, more = (jnp.concatenate([jnp.asarray(part)] * times) for part in extra)
    share = jax.random.uniform(jax.random.fold_in(key, 1), low.shape, dtype=low.dtype)
    points = low + (high - low) * share
    return jnp.concatenate([u, points]), jnp.concatenate([jnp.asarray(counts), more])


def _row(
    region: str, box: Box, spec: GaitSpec, layout: MarginLayout
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return a box of a region, widened within the region, and the columns it counts for."""
    root = next(root for root in spec.regions[region] if contains([root], [box]))
    low, high = np.array(box.low), np.array(box.high)
    centre, half = 0.5 * (low + high), np.maximum(0.5 * (high - low), 0.5 * LEAST_WIDTH)
    low = np.clip(centre - half, root.low, root.high)
    high = np.clip(centre + half, root.low, root.high)
    wide = [Box(tuple(low.tolist()), tuple(high.tolist()))]
    counts = np.zeros(len(layout.scale), dtype=bool)
    for c in spec.conditions:
        counts[layout.columns[c.name]] = contains(spec.regions[c.region], wide)
    return low, high, counts
