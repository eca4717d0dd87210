"""Measure landing errors of touchdowns, with and without a residual of the reset map."""

import numpy as np

from neuralgaits.gait import ZeroDynamics
from neuralgaits.gait.zero_coordinates import momenta_of, positions_of
from neuralgaits.logs import Touchdowns
from neuralgaits.records.fitted import ResetErrors, TouchdownErrors
from neuralgaits.residual.reset import Landings, ResetResidual, landings


def landing_errors(
    zd: ZeroDynamics, reset: ResetResidual | None, touchdowns: Touchdowns
) -> TouchdownErrors:
    """Return root mean square errors at touchdowns that no fit has used.

    Args:
        zd: robot and policy that walked, with the residual of the flow.
        reset: residual of the reset map, or None.
        touchdowns: measured touchdowns.

    Returns: z1, z2, the largest output and output rate before and after the residual; None without
        touchdowns or residual.
    """
    before = ZeroDynamics(zd.robot, zd.policy, zd.residual)
    after = ZeroDynamics(zd.robot, zd.policy, zd.residual, reset)
    some = len(touchdowns.z_before) > 0
    return TouchdownErrors(
        count=len(touchdowns.z_before),
        before=_sizes(landings(before, touchdowns)) if some else None,
        after=_sizes(landings(after, touchdowns)) if some and reset is not None else None,
    )


def _sizes(missed: Landings) -> ResetErrors:
    m = missed.eta.shape[1] // 2
    outputs, rates = missed.eta[:, :m], missed.eta[:, m:]
    return ResetErrors(
        z1_m=_rms(positions_of(missed.z)),
        z2_kg_m2_s=_rms(momenta_of(missed.z)),
        output_rad=_rms(np.linalg.norm(outputs, axis=1)),
        rate_rad_s=_rms(np.linalg.norm(rates, axis=1)),
    )


def _rms(values: np.ndarray) -> float:
    return float(np.sqrt(np.mean(values**2)))
