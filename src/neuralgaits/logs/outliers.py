"""Single rows far from their neighbours: glitches of an encoder or of the link to it.

A row is an outlier if an angle or rate is far from the median of the rows around it. Far means
both further than a robot moves in that time and a multiple of the log's own noise. Source: Hampel
(1974), the median filter; Pearson et al. (2016), Generalized Hampel filters.
"""

import numpy as np

from neuralgaits._types import Bool, Float
from neuralgaits.logs.walk_table import Log

NEIGHBOURS = 3
"""Number of neighbouring rows on either side."""
ANGLE_RAD = 0.02


def outliers(log: Log) -> Bool[np.ndarray, " k"]:
    """Find the rows of a log that are outliers. [k]."""
    bad = np.zeros(len(log), dtype=bool)
    for rows in np.split(np.arange(len(log)), np.flatnonzero(np.diff(log.stance)) + 1):
        if rows.size <= 2 * NEIGHBOURS:
            continue
        # Rates jump where a stance phase begins, which is no fault of the encoder.
        inner = slice(NEIGHBOURS, None)
        rate = 1.0  # Least deviation of an outlier [rad/s]: joints jerk as much within three rows.
        for values, floor in ((log.q, ANGLE_RAD), (log.dq, rate)):
            bad[rows[inner]] |= np.any(stand_out(values[rows], floor)[inner], axis=1)
    return bad


def stand_out(values: Float[np.ndarray, "k n"], floor: float) -> Bool[np.ndarray, "k n"]:
    """Find values of one stance phase that are far from the median of their neighbours. [k, n]."""
    ends = [(NEIGHBOURS, NEIGHBOURS), (0, 0)]
    padded = np.pad(values, ends, mode="edge")
    around = np.lib.stride_tricks.sliding_window_view(padded, 2 * NEIGHBOURS + 1, axis=0)
    distance = np.abs(values - np.median(around, axis=-1))
    # Standard deviation of normal noise over the median of its absolute value.
    noise = 1.4826 * np.median(distance, axis=0)
    # Threshold in robust standard deviations of the log's own scatter about its running median.
    return distance > np.maximum(floor, 6.0 * noise)
