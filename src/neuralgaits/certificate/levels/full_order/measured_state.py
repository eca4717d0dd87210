"""Effect of errors of a measured state, in the coordinates of a set at full order."""

from typing import NamedTuple

import jax
import jax.numpy as jnp

from neuralgaits._types import Array, Float
from neuralgaits.certificate.levels.full_order.model import (
    FullOrderModel,
    Vector,
    scaled_coordinates,
    unweighted,
    weighted,
)
from neuralgaits.gait.error_slopes import error_slopes, state_slopes
from neuralgaits.gait.full_order import FullPoint
from neuralgaits.gait.zero_coordinates import position_of


class StateMovements(NamedTuple):
    """Slopes of coordinates of the set in the angles and rates of a state, x = (q, dq).

    Attributes:
        chart: of phase and level (per rad, per rad/s). [2, 2n]
        xi: of xi (rad per rad, per rad/s). [2m, 2n]
    """

    chart: Float[Array, "2 two_n"]
    xi: Float[Array, "two_m two_n"]


def state_movements(model: FullOrderModel, point: FullPoint) -> StateMovements:
    """Return how errors of the state move it in the set's coordinates."""
    gait, slopes = model.gait, state_slopes(point)
    chart = jax.jacfwd(lambda z: jnp.stack([gait.phase(position_of(z)), gait.level(z)]))
    eta = jnp.concatenate([slopes.output, slopes.output_rate])
    return StateMovements(
        chart(point.z) @ slopes.z, scaled_coordinates(eta, model.bandwidth, model.weights)
    )


def weighted_error_slopes(
    model: FullOrderModel, point: FullPoint, e: Vector
) -> Float[Array, "m two_n"]:
    """Return the slopes in the state of S times the error that a constant torque makes. [m, 2n].

    Args:
        model: model with the set's norm.
        point: the state.
        e: S times the error of that torque in this state [rad/s^2]. [m]
    """
    return weighted(model.weights, error_slopes(point, unweighted(model.weights, e)))
