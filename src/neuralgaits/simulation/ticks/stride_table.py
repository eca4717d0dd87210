"""Touchdowns of a walk: when, where, and what the step that ended there was told."""

from typing import NamedTuple

import numpy as np

from neuralgaits._types import Float


class Strides(NamedTuple):
    """Touchdowns of one walk, a row each; see `NG_STRIDE` in `c/walk.h`."""

    time: Float[np.ndarray, " K"]
    """[s]"""
    hip: Float[np.ndarray, " K"]
    """Forward [m]."""
    length: Float[np.ndarray, " K"]
    """Of the step: how far the new foothold is ahead of the old one [m]."""
    height: Float[np.ndarray, " K"]
    """And how far above it [m]."""
    place: Float[np.ndarray, " K"]
    """Of the new foothold, forward [m]."""
    told: Float[np.ndarray, "K p"]
    """Commands of that step, in their units."""

    @classmethod
    def of_rows(cls, rows: Float[np.ndarray, "K r"]) -> "Strides":
        """Of the numbers that the loops keep."""
        time, hip, length, height, place = rows[:, :5].T
        return cls(time, hip, length, height, place, rows[:, 5:])


def width(commands: int) -> int:
    """Numbers of a row."""
    return 5 + commands
