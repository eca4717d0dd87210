"""Rates of angles that a log holds without them: local parabolas, which shift nothing in time.

Source: Savitzky and Golay (1964), here at the true times of the rows. A parabola never reaches
across a touchdown, where rates jump, nor across a gap; and not from rows that are learned from
into those in which the contact settles.
"""

import math

import numpy as np

from neuralgaits._types import Bool, Float, Int

QUIET_RAD_S = 0.0015
"""Noise that windows leave in rates, unless that needs windows longer than the longest [rad/s]."""
HALF_WINDOWS_S = (0.01, 0.04)
"""Shortest and longest reach of a window to either side [s]. Near the ends of a piece a window is
as long, one-sided, and its noise about four times as large."""
DEGREE = 2


def noise(values: Float[np.ndarray, "k c"]) -> float:
    """Estimate the standard deviation of the noise of angles, of the noisiest column (rad).

    It is that of third differences: those of a motion are far smaller than those of an encoder's
    noise.
    """
    if len(values) < 4:
        return 0.0
    spread = np.median(np.abs(np.diff(values, n=3, axis=0)), axis=0)
    normal = 1.4826  # Standard deviation of normal noise over the median of its absolute value.
    third = math.sqrt(20.0)  # That of the third difference of white noise over its own.
    return float(normal / third * spread.max())


def half_window(period_s: float, noise_rad: float) -> float:
    """Return the reach of windows to either side (s), which grows with the noise."""
    shortest, longest = HALF_WINDOWS_S
    # The slope of a parabola over 2h has the noise sigma sqrt(1.5 dt) / h^1.5.
    needed = (noise_rad * math.sqrt(1.5 * period_s) / QUIET_RAD_S) ** (2.0 / 3.0)
    return min(max(needed, shortest), longest)


def rates(
    t: Float[np.ndarray, " k"],
    values: Float[np.ndarray, "k c"],
    piece: Int[np.ndarray, " k"],
    settled: Bool[np.ndarray, " k"],
    spoilt: Bool[np.ndarray, "k c"],
    reach_s: float,
) -> Float[np.ndarray, "k c"]:
    """Compute the rates at which columns change.

    Args:
        t: times, increasing (s). [k]
        values: values of the columns. [k, c]
        piece: number that changes where no window may reach across. [k]
        settled: rows whose windows hold settled rows only; the last ones of a piece. [k]
        spoilt: values that are ignored. [k, c]
        reach_s: reach of a window to either side (s).

    Returns: [k, c] per second; NaN in pieces of fewer than three rows.
    """
    derivatives = np.full(values.shape, np.nan)
    if len(t) < 2:
        return derivatives
    half = max(1, round(reach_s / float(np.median(np.diff(t)))))
    at_once = 4096  # Number of rows at a time, since a log may be long.
    for rows in np.split(np.arange(len(t)), np.flatnonzero(np.diff(piece)) + 1):
        if rows.size <= DEGREE:
            continue
        first = int(np.count_nonzero(~settled[rows]))
        first = first if rows.size - first > DEGREE else 0
        for some, holding in ((rows[:first], rows), (rows[first:], rows[first:])):
            width = min(2 * half + 1, holding.size)
            place = some - holding[0]
            starts = np.clip(place - half, 0, holding.size - width)
            for begin in range(0, some.size, at_once):
                part = slice(begin, begin + at_once)
                window = holding[starts[part, None] + np.arange(width)]
                derivatives[some[part]] = _slopes(t, values, spoilt, some[part], window, reach_s)
    return derivatives


def _slopes(
    t: Float[np.ndarray, " k"],
    values: Float[np.ndarray, "k c"],
    spoilt: Bool[np.ndarray, "k c"],
    rows: Int[np.ndarray, " r"],
    window: Int[np.ndarray, "r w"],
    scale_s: float,
) -> Float[np.ndarray, "r c"]:
    """Return slopes at some rows of the parabolas through their windows."""
    powers = ((t[window] - t[rows, None]) / scale_s)[..., None] ** np.arange(DEGREE + 1)
    slopes = np.empty((len(rows), values.shape[1]))
    for column in range(values.shape[1]):
        # Weight of an outlier; not zero, so that every parabola has three rows.
        weights = np.where(spoilt[window, column], 1e-6, 1.0)
        weighted = np.swapaxes(powers * weights[..., None], 1, 2)
        change = values[window, column] - values[rows, column][:, None]
        solved = np.linalg.solve(weighted @ powers, weighted @ change[..., None])
        slopes[:, column] = solved[:, 1, 0] / scale_s
    return slopes
