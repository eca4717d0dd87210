"""Friction and rotor inertia of a joint by least squares, with intervals."""

from typing import NamedTuple

import numpy as np

from neuralgaits._types import Float, Int
from neuralgaits.residual.joint_windows import JointWindows


class JointNumbers(NamedTuple):
    """Rotor inertia, dry friction, damping and delay of the torques, with intervals. [4] each."""

    value: Float[np.ndarray, "4"]
    """Estimates; only a delay may be negative [kg m^2, N m, N m s/rad, s]."""
    low: Float[np.ndarray, "4"]
    """Lower ends of the intervals."""
    high: Float[np.ndarray, "4"]
    """Upper ends of the intervals."""


def identified(windows: JointWindows) -> JointNumbers:
    """Return the numbers of a joint that explain its torques best.

    Windows of one stride err together, and so do windows at one place of all strides where the
    model errs: the half width of an interval is that of errors that are independent between
    strides, and between places, only. Source: Cameron, Gelbach and Miller (2011), without the
    subtraction of what both have in common, which makes intervals wider.

    Args:
        windows: equations of the joint, more than four, in two strides or more.
    """
    from scipy.optimize import nnls  # Slow to import, and seldom needed.
    from scipy.special import stdtrit

    features, torque = windows.features, windows.torque
    inverse = np.linalg.inv(features.T @ features)
    free = inverse @ (features.T @ torque)
    scores = features * (torque - features @ free)[:, None]
    by_stride, by_phase = (_clustered(scores, group) for group in (windows.stride, windows.phase))
    spread = np.sqrt(np.diag(inverse @ (by_stride + by_phase) @ inverse))
    groups = min(len(np.unique(group)) for group in (windows.stride, windows.phase))
    # Intervals of 95 % confidence.
    half = stdtrit(groups - 1, 0.975) * spread
    # A delay may have either sign: a column of its own for each.
    parts, _ = nnls(np.column_stack([features, -features[:, -1]]), torque)
    value = np.append(parts[:-2], parts[-2] - parts[-1])
    # Where a number is held at 0, the others no longer make up for it.
    low, high = np.minimum(value, free) - half, np.maximum(value, free) + half
    least = np.array([0.0, 0.0, 0.0, -np.inf])
    return JointNumbers(value, np.maximum(low, least), np.maximum(high, least))


def torque_error(windows: JointWindows, numbers: Float[np.ndarray, "4"]) -> float:
    """Return the torque that numbers leave unexplained, root mean square [N m]."""
    return float(np.sqrt(np.mean((windows.torque - windows.features @ numbers) ** 2)))


def _clustered(
    scores: Float[np.ndarray, "N 4"], group: Int[np.ndarray, " N"]
) -> Float[np.ndarray, "4 4"]:
    """Return the covariance of the sum of scores that are independent between groups only."""
    _, place = np.unique(group, return_inverse=True)
    sums = np.zeros((place.max() + 1, scores.shape[1]))
    np.add.at(sums, place, scores)
    count = len(sums)
    return sums.T @ sums * count / (count - 1)
