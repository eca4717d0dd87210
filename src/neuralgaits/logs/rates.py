"""Rates of angles that a log holds without them: local parabolas, which shift nothing in time.

Source: Savitzky and Golay (1964), here at the true times of the rows. A parabola never reaches
across a touchdown, where rates jump, nor across a gap.
"""

import numpy as np

from neuralgaits._types import Bool, Float, Int

HALF_WINDOW_S = 0.015
"""Rows up to this far on either side [s]: at 1 kHz, noise of an angle is divided by 50 ms. Near
the ends of a piece the window is as long, and one-sided. The windows of rows that are learned from
begin after the contact has settled, some ms after a touchdown."""
DEGREE = 2
_SPOILT = 1e-6
"""Weight of a row that stands out; not zero, so that every parabola has three rows."""
_BLOCK = 4096
"""Rows at a time: a log may be long."""


def rates(
    t: Float[np.ndarray, " k"],
    values: Float[np.ndarray, "k c"],
    piece: Int[np.ndarray, " k"],
    spoilt: Bool[np.ndarray, "k c"],
) -> Float[np.ndarray, "k c"]:
    """Rates at which columns change.

    Args:
        t: times, increasing (s). [k]
        values: of the columns. [k, c]
        piece: number that changes where no window may reach across. [k]
        spoilt: values that count for nothing. [k, c]

    Returns: [k, c] per second; NaN in pieces of fewer than three rows.
    """
    found = np.full(values.shape, np.nan)
    if len(t) < 2:
        return found
    half = max(1, round(HALF_WINDOW_S / float(np.median(np.diff(t)))))
    for rows in np.split(np.arange(len(t)), np.flatnonzero(np.diff(piece)) + 1):
        if rows.size <= DEGREE:
            continue
        width = min(2 * half + 1, rows.size)
        starts = np.clip(np.arange(rows.size) - half, 0, rows.size - width)
        for begin in range(0, rows.size, _BLOCK):
            some = slice(begin, begin + _BLOCK)
            window = rows[starts[some, None] + np.arange(width)]
            found[rows[some]] = _slopes(t, values, spoilt, rows[some], window)
    return found


def _slopes(
    t: Float[np.ndarray, " k"],
    values: Float[np.ndarray, "k c"],
    spoilt: Bool[np.ndarray, "k c"],
    rows: Int[np.ndarray, " r"],
    window: Int[np.ndarray, "r w"],
) -> Float[np.ndarray, "r c"]:
    """Slopes at some rows of the parabolas through their windows."""
    since = (t[window] - t[rows, None]) / HALF_WINDOW_S
    powers = since[..., None] ** np.arange(DEGREE + 1)
    slopes = np.empty((len(rows), values.shape[1]))
    for column in range(values.shape[1]):
        weights = np.where(spoilt[window, column], _SPOILT, 1.0)
        weighted = np.swapaxes(powers * weights[..., None], 1, 2)
        change = values[window, column] - values[rows, column][:, None]
        solved = np.linalg.solve(weighted @ powers, weighted @ change[..., None])
        slopes[:, column] = solved[:, 1, 0] / HALF_WINDOW_S
    return slopes
