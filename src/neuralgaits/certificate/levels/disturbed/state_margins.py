"""Margins of level 5 about a measured state; none may be negative.

They are functions of a point of the wider set that holds every state between a true one of the set
and a measured one. The argument is in docs/level5_sensing.md.
"""

import jax
import jax.numpy as jnp

from neuralgaits._types import Array, Float
from neuralgaits.certificate.levels.full_order.measured_state import (
    state_movements,
    weighted_error_slopes,
)
from neuralgaits.certificate.levels.full_order.model import (
    FullOrderModel,
    Outputs,
    Quantities,
    Vector,
)


def state_margins(
    model: FullOrderModel,
    u: Float[Array, "2"],
    xi: Outputs,
    axes: Vector,
    moves: Float[Array, "3"],
    slopes: Float[Array, "2"],
) -> Quantities:
    """Return the margins at one chart point and one xi [rad].

    Args:
        model: model with the set's norm.
        u: phase and level.
        xi: scaled outputs. [2m]
        axes: half axes of the ellipsoid of errors of (q, dq) (rad, rad/s). [2n]
        moves: bounds on what such an error moves phase, level and xi by [1, 1, rad].
        slopes: bounds on S e and on its growth with itself [rad/s^2, 1].

    Raises: ValueError for axes that are not one for each angle and rate.
    """
    point = model.point(u, xi)
    none = jnp.zeros(model.size // 2)
    if len(axes) != 2 * model.robot.n:
        raise ValueError(f"{len(axes)} axes of a state of {2 * model.robot.n} numbers")

    def errors(e: Vector) -> Float[Array, "m two_n"]:
        return weighted_error_slopes(model, point, e) * axes[None, :]

    first, growth = errors(none), jax.jacfwd(errors)(none)
    moved = state_movements(model, point)
    sizes = [
        *jnp.sum((moved.chart * axes[None, :]) ** 2, axis=1),
        jnp.sum((moved.xi * axes[None, :]) ** 2),
    ]
    # Frobenius norms as squares, which are smooth: premises of docs/level5_sensing.md.
    return {
        "disturbed/state-moves": moves * moves - jnp.stack(sizes),
        "disturbed/state-error": slopes[0] * slopes[0] - jnp.sum(first * first),
        "disturbed/state-growth": slopes[1] * slopes[1] - jnp.sum(growth * growth),
    }
