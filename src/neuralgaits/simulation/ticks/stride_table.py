"""Touchdowns of a walk: time, place, and commands of the step that ended there."""

from typing import NamedTuple

import numpy as np

from neuralgaits._types import Float


class Strides(NamedTuple):
    """Touchdowns of one walk, a row each; see `NG_STRIDE` in `c/walk.h`."""

    time: Float[np.ndarray, " K"]
    """Times of the touchdowns [s]."""
    hip: Float[np.ndarray, " K"]
    """Hip positions forward [m]."""
    length: Float[np.ndarray, " K"]
    """Lengths of the steps: distance of the new foothold ahead of the old one [m]."""
    height: Float[np.ndarray, " K"]
    """Heights of the new footholds above the old ones [m]."""
    place: Float[np.ndarray, " K"]
    """Places of the new footholds, forward [m]."""
    commands: Float[np.ndarray, "K p"]
    """Commands of that step, in their units."""
    reference: Float[np.ndarray, " K"]
    """Speed that the step was to have, as requested, see `speed_adapter`; NaN without that command
    [m/s]."""
    measured: Float[np.ndarray, " K"]
    """Mean speed of the step by joint angles and pitch; NaN where it is not measured [m/s]."""

    @classmethod
    def of_rows(cls, rows: Float[np.ndarray, "K r"]) -> "Strides":
        """Return touchdowns from the rows of numbers that the loops keep."""
        time, hip, length, height, place = rows[:, :5].T
        reference = measured = np.full(len(rows), np.nan)
        if rows.shape[1] > 5:
            reference, measured = rows[:, 5:7].T
        return cls(time, hip, length, height, place, rows[:, 7:], reference, measured)


def width(commands: int) -> int:
    """Return how many numbers a row has."""
    return 7 + commands if commands else 5
