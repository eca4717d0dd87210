"""Margins of membership in the set D of levels 4 and 5, for states (q, dq) of the robot."""

import jax.numpy as jnp
import numpy as np

from neuralgaits._types import Array, Coordinates, Float
from neuralgaits.certificate.levels.full_order.inequalities import tightening
from neuralgaits.certificate.levels.full_order.margins import TheoremArrays
from neuralgaits.certificate.levels.full_order.model import FullOrderModel, scaled_coordinates
from neuralgaits.certificate.levels.full_order.theorem import FENCES, FullOrderConstants
from neuralgaits.certificate.levels.walking_set import membership as walking_set
from neuralgaits.certificate.premises import above
from neuralgaits.gait import ZeroDynamics
from neuralgaits.gait.zero_coordinates import position_of

ENDS = (*walking_set.ENDS, "foot")
"""Names of the margins of a step's ends: those of the tube, and of the foot above the ground."""


def full_order_membership(
    model: FullOrderModel, constants: FullOrderConstants, q: Coordinates, dq: Coordinates
) -> dict[str, Float[Array, "..."]]:
    """Return margins that are not negative exactly in D.

    Args:
        model: robot, gait and spec.
        constants: constants of the set.
        q: coordinates of the robot on its stance foot (rad). [n]
        dq: their rates (rad/s). [n]

    Returns: `ends`, see `ENDS`, in phases, units of the tube's z2, and strides; `walls`,
        1 - V/R(phase)^2, then h - t - sigma V of every barrier: of fences in tube widths, of
        others in units of the h that is proved after an impact with zero outputs.
    """
    gait, its = model.gait, TheoremArrays.of(constants, model.names)
    model = its.model(model)
    eta, z = ZeroDynamics(model.robot, gait.policy).phi(jnp.concatenate([q, dq]))
    xi = scaled_coordinates(eta, model.bandwidth, model.weights)
    v, bound = xi @ xi, its.bound(gait.phase(position_of(z)))
    tightened, sigma, unit = _barriers(constants)
    h = model.barriers(z)
    # The tube's ends and z2 > 0; the foot is on or above the ground: p_z(q) >= 0.
    foot = model.robot.swing_foot(q)[1] / gait.stride
    # sqrt(V) <= R(phase), and h_i - t_i >= sigma_i V.
    walls = [jnp.reshape(1.0 - v / (bound * bound), 1), (h - tightened - sigma * v) / unit]
    return {
        "ends": jnp.stack([*walking_set.ends(gait, constants.ends, z), foot]),
        "walls": jnp.concatenate(walls),
    }


def wall_names(constants: FullOrderConstants) -> tuple[str, ...]:
    """Return what each of the `walls` is of, in their order."""
    # The first is sqrt(V) <= R(phase).
    return "output-error", *(barrier.name for barrier in constants.barriers)


def _barriers(constants: FullOrderConstants) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return t, rounded up, sigma and the unit of every barrier. [I] each."""
    rows = constants.barriers
    tightened = [0.0 if b.name in FENCES else above(tightening(b)) for b in rows]
    unit = [1.0 if b.name in FENCES else b.reset for b in rows]
    return np.array(tightened), np.array([b.sigma for b in rows]), np.array(unit)
