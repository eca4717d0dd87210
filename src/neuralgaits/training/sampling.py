"""Draw fresh samples of every region: stratified along the phase, uniform across the tube."""

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import PRNGKeyArray

from neuralgaits._types import Array, Float, Scalar
from neuralgaits.barriers import Box
from neuralgaits.gait.commands import Command, Commands

SPEED_SHORTFALL = 0.04
"""Share by which orbits of a family may be slower than commanded: in trials 1 to 3 % at the upper
end of a range, of which the aims of training allow 1.5 %."""


class Sampler(NamedTuple):
    """A plan of one batch: each row is a stratum of a box of a region.

    Attributes:
        low, high: corners of each row's stratum in (phase, level). [N, 2]
        rows: region name to its rows.
        ends: ends of the axes of commands, the same for all rows. [2, k]
        corners: share of the samples of such an axis that lie on its ends.
        parameters: half widths of the robot's parameters. [p]
    """

    low: Float[np.ndarray, "N 2"]
    high: Float[np.ndarray, "N 2"]
    rows: dict[str, slice]
    ends: Float[np.ndarray, "2 k"]
    corners: float
    parameters: Float[np.ndarray, " p"]

    @classmethod
    def plan(
        cls,
        regions: Mapping[str, Sequence[Box]],
        counts: Mapping[str, int],
        overshoot: tuple[float, float] = (0.0, 0.0),
        *,
        commands: Commands = (),
        corners: float = 0.0,
        widened: float = 0.0,
        faster_changes: float = 0.0,
        strip: float = 0.0,
        parameters: Sequence[float] = (),
    ) -> "Sampler":
        """Lay out the strata.

        Args:
            regions: name to boxes of the chart.
            counts: name to number of samples.
            overshoot: reach of samples beyond the edges of (phase, level), per axis.
            commands: commands of the gait, two axes each.
            corners: see `Recipe`.
            widened: see `Recipe`.
            faster_changes: see `Recipe`.
            strip: see `Recipe`.
            parameters: half widths of the robot's parameters, one axis each.
        """
        lows = []
        highs = []
        rows = {}
        position = 0
        for name, count in counts.items():
            for box, share in zip(regions[name], _shares(regions[name], count), strict=True):
                low, high = _stretched(box, overshoot, strip)
                edges = np.linspace(low[0], high[0], share + 1)
                lows.append(np.stack([edges[:-1], np.full(share, low[1])], axis=1))
                highs.append(np.stack([edges[1:], np.full(share, high[1])], axis=1))
            rows[name] = slice(position, position + count)
            position += count
        ends = np.array([axis[1:] for command in commands for axis in command.axes]).T
        ends = ends.reshape(2, 2 * len(commands))
        for i, command in enumerate(commands):
            more = beyond_range(command, widened)
            ends[:, 2 * i] += [-more, more]
            if command.largest_change is None:  # Both axes are its range.
                ends[:, 2 * i + 1] += [-more, more]
            else:
                ends[:, 2 * i + 1] *= 1.0 + faster_changes
        halves = np.array(parameters, dtype=np.float64)
        return cls(np.concatenate(lows), np.concatenate(highs), rows, ends, corners, halves)

    def draw(self, key: PRNGKeyArray, grown: Scalar | float = 1.0) -> Float[Array, "N n"]:
        """Draw one uniform point in each stratum.

        Args:
            key: random key.
            grown: share of the axes of commands from which points are drawn, about their middles.

        Returns: [N, n] (phase, level, then the axes of commands, then parameters of the robot).
        """
        u = self._commands(key, grown)
        if not len(self.parameters):
            return u
        # The worst robots are corners of the box: most errors of a sample are at an end.
        shape = (len(self.low), len(self.parameters))
        key = jax.random.fold_in(key, 3)
        share = jax.random.uniform(key, shape, dtype=u.dtype, minval=-1.0, maxval=1.0)
        # Three quarters of the draws lie on an end of the range.
        return jnp.concatenate([u, self.parameters * jnp.clip(4.0 * share, -1.0, 1.0)], axis=1)

    def _commands(self, key: PRNGKeyArray, grown: Scalar | float) -> Float[Array, "N c"]:
        """Draw the points without parameters of the robot."""
        share = jax.random.uniform(key, self.low.shape, dtype=jnp.zeros(0).dtype)
        u = self.low + (self.high - self.low) * share
        if self.ends.shape[1] == 0:
            return u
        shape = (len(self.low), self.ends.shape[1])
        share = jax.random.uniform(jax.random.fold_in(key, 2), shape, dtype=u.dtype)
        # Wider than the axis and clipped: what is beyond lies on its ends.
        wide = (share - 0.5) / (1.0 - self.corners)
        low, high = self.ends[:, None]
        middle = 0.5 * (low + high)
        return jnp.concatenate(
            [u, middle + grown * (high - low) * jnp.clip(wide, -0.5, 0.5)], axis=1
        )


def beyond_range(command: Command, widened: float) -> float:
    """Return how far training goes beyond both ends of a command's range, in its unit.

    Of a speed it goes at least as far as orbits may be slower than commanded, so that calibration
    finds one for each end.

    Args:
        command: the command.
        widened: that of the recipe; with 0 it goes nowhere beyond.
    """
    share = widened * (command.high - command.low)
    least = SPEED_SHORTFALL * command.high if command.name == "speed" and widened else 0.0
    return max(share, least)


def contains(outer: Sequence[Box], inner: Sequence[Box]) -> bool:
    """Return whether every inner box lies in one of the outer boxes."""
    return all(
        any(all(o.low[k] <= i.low[k] and i.high[k] <= o.high[k] for k in (0, 1)) for o in outer)
        for i in inner
    )


def _shares(boxes: Sequence[Box], count: int) -> list[int]:
    """Return how many of the samples each box gets, by its length in phase."""
    lengths = np.array([box.high[0] - box.low[0] for box in boxes])
    lengths = lengths if np.any(lengths > 0) else np.ones(len(boxes))
    ends = np.round(np.cumsum(lengths) / np.sum(lengths) * count).astype(int)
    return list(np.diff(np.concatenate([[0], ends])))


def _stretched(
    box: Box, overshoot: tuple[float, float], strip: float
) -> tuple[list[float], list[float]]:
    low, high = list(box.low), list(box.high)
    if low[0] == high[0] == 1.0:
        low[0], high[0] = 1.0 - strip, 1.0 + strip
    for axis, reach in enumerate(overshoot):
        if box.low[axis] < box.high[axis]:
            low[axis] -= reach if box.low[axis] == 0.0 else 0.0
            high[axis] += reach if box.high[axis] == 1.0 else 0.0
    return low, high
