"""Touchdowns in logged walks, with which the reset map is compared."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from neuralgaits._types import Float, Int
from neuralgaits.gait import ZeroDynamics
from neuralgaits.logs.strides import State, Stride
from neuralgaits.logs.zero_states import output_states, zero_states


class Touchdowns(NamedTuple):
    """N touchdowns: the state just before each, and once the contact has settled."""

    q_before: Float[np.ndarray, "N n"]
    """Coordinates in the last row before the touchdown, old stance leg first [rad]."""
    dq_before: Float[np.ndarray, "N n"]
    """Rates in that row [rad/s]."""
    z_before: Float[np.ndarray, "N 2"]
    """Zero dynamics states (m, kg m^2/s)."""
    z_after: Float[np.ndarray, "N 2"]
    """Zero dynamics states SETTLING_S after the touchdown, in the new stance."""
    eta_after: Float[np.ndarray, "N two_m"]
    """Outputs and their rates at that time (rad, rad/s)."""
    after_s: Float[np.ndarray, " N"]
    """Time from the state before to the state after [s]: z has flowed on for as long."""
    stride: Int[np.ndarray, " N"]
    """Index of the stride that each touchdown ends."""


def touchdowns(strides: Sequence[Stride], zd: ZeroDynamics) -> Touchdowns:
    """Collect the touchdowns that end the strides, seen before and after.

    Args:
        strides: strides of a log; those without a landing are skipped.
        zd: robot and policy that walked, which define z and eta.
    """
    n = zd.robot.n
    rows = [
        (index, stride.landing, stride.landed)
        for index, stride in enumerate(strides)
        if stride.landing is not None and stride.landed is not None
    ]
    t_before, q_before, dq_before = _stacked([landing for _, landing, _ in rows], n)
    t_after, q_after, dq_after = _stacked([landed for _, _, landed in rows], n)
    return Touchdowns(
        q_before=q_before,
        dq_before=dq_before,
        z_before=zero_states(zd.robot, q_before, dq_before),
        z_after=zero_states(zd.robot, q_after, dq_after),
        eta_after=output_states(zd, q_after, dq_after),
        after_s=t_after - t_before,
        stride=np.array([index for index, _, _ in rows], dtype=int),
    )


def _stacked(states: Sequence[State], n: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Stack times [N], coordinates [N, n] and rates [N, n]."""
    t, q, dq = zip(*states, strict=True) if states else ((), (), ())
    return np.array(t), np.array(q).reshape(-1, n), np.array(dq).reshape(-1, n)
