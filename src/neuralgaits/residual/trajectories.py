"""Errors of predicted trajectories against measured ones, window by window."""

from functools import partial
from typing import NamedTuple

import jax
import numpy as np

from neuralgaits._blocks import in_blocks
from neuralgaits._quick_jit import quick_filter_jit
from neuralgaits._types import Array, Float
from neuralgaits.gait import ZeroDynamics
from neuralgaits.logs import Windows
from neuralgaits.residual.shooting import Rate, model_rate, shoot


class PredictionErrors(NamedTuple):
    """Errors of predicted trajectories, measured minus predicted."""

    errors: Float[np.ndarray, "N k 2"]
    """Errors at all samples but the first (m, kg m^2/s). k = K - 1."""
    defects: Float[np.ndarray, "N 2"]
    """Mean missing rate over the first interval (m/s, N m)."""


def prediction_errors(zd: ZeroDynamics, residual: Rate, windows: Windows) -> PredictionErrors:
    """Integrate every window from its first measured state.

    Args:
        zd: robot and policy; its own residual is ignored.
        residual: addition to omega(0, z).
        windows: measured windows.
    """
    model = ZeroDynamics(zd.robot, zd.policy)
    # Windows integrated at once: one compiled shape for any number of them.
    predicted = in_blocks(partial(_shot, model, residual), 256, windows.t, windows.z[:, 0])
    errors = windows.z[:, 1:] - predicted
    spans = windows.t[:, 1:2] - windows.t[:, 0:1]
    return PredictionErrors(errors, errors[:, 0] / spans)


def root_mean_square(errors: Float[np.ndarray, "N k 2"], scale: Float[np.ndarray, "2"]) -> float:
    """Return the root mean square over windows and samples of the error's size in scaled z."""
    return float(np.sqrt(np.mean(np.sum((errors / scale) ** 2, axis=-1))))


def largest_defects(errors: PredictionErrors) -> Float[np.ndarray, "2"]:
    """Return the largest missing rate over any first interval (m/s, N m)."""
    return np.abs(errors.defects).max(axis=0)


def _shoot_block(
    zd: ZeroDynamics, residual: Rate, t: Float[Array, "B K"], z: Float[Array, "B 2"]
) -> Float[Array, "B k 2"]:
    rate = model_rate(zd)
    return jax.vmap(lambda z, t: shoot(lambda y: rate(y) + residual(y), z, t))(z, t)


_shot = quick_filter_jit(_shoot_block)
