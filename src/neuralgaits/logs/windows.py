"""Windows of evenly spaced samples out of strides, to which a residual is fitted."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from neuralgaits._types import Float, Int
from neuralgaits.errors import InputError
from neuralgaits.logs.strides import Stride


class Windows(NamedTuple):
    """N windows of K samples each; none reaches across a touchdown or a gap."""

    t: Float[np.ndarray, "N K"]
    """Time of the samples, in the clock of their log [s]."""
    z: Float[np.ndarray, "N K 2"]
    """Zero dynamics states (m, kg m^2/s)."""
    stride: Int[np.ndarray, " N"]
    """Index of each window's stride in the list the windows were cut from."""


def windows(
    strides: Sequence[Stride], *, samples: int = 3, step: float = 0.01, every: float | None = None
) -> Windows:
    """Cut windows of evenly spaced samples.

    Each sample is the row nearest to its due time; its true time is kept.

    Args:
        strides: strides to cut; samples of a window lie in one piece of one stride.
        samples: number of samples of a window.
        step: time between two samples (s).
        every: time between the starts of two windows (s); `step` if None.

    Raises: InputError if `samples` or a time makes no sense.
    """
    every = step if every is None else every
    if samples < 2 or not (step > 0.0 and every > 0.0):
        raise InputError(
            f"windows: expected at least 2 samples and positive times, found {samples} samples, "
            f"step {step:g} s, every {every:g} s"
        )
    times, states, owners = [], [], []
    for index, stride in enumerate(strides):
        picked = _picked(stride, samples, step, every)
        times.append(stride.t[picked])
        states.append(stride.z[picked])
        owners.append(np.full(len(picked), index))
    return Windows(
        np.concatenate([np.zeros((0, samples)), *times]),
        np.concatenate([np.zeros((0, samples, 2)), *states]),
        np.concatenate([np.zeros(0, dtype=int), *owners]),
    )


def _picked(stride: Stride, samples: int, step: float, every: float) -> Int[np.ndarray, "w K"]:
    """Return the rows of each window of one stride."""
    starts = np.arange(stride.t[0], stride.t[-1], every)
    due = starts[:, None] + step * np.arange(samples)
    right = np.clip(np.searchsorted(stride.t, due), 1, len(stride.t) - 1)
    nearer_left = due - stride.t[right - 1] < stride.t[right] - due
    rows = np.where(nearer_left, right - 1, right)
    # A sample of a window is off its due time by at most this many sample periods, or this share of
    # the time between samples, whichever is longer: where rows are missing their neighbours serve.
    late = max(0.6 * stride.period_s, 0.2 * step)
    on_time = np.all(np.abs(stride.t[rows] - due) <= late, axis=1)
    together = stride.piece[rows[:, 0]] == stride.piece[rows[:, -1]]
    distinct = np.all(np.diff(rows, axis=1) > 0, axis=1)
    return rows[on_time & together & distinct]
