"""Find a norm of V in which outputs tolerate the largest push or deviation, at points.

S of V = |S dy/w|^2 + STIFF^2 |S (y + dy/w)|^2 does not change the decay, but it decides how much an
impact enlarges V, and how much of V contact and torques allow. The search finds the S for which
torques can be held the longest (level 5); or, without a hold, the S whose set is the largest.
Nothing here is trusted.
"""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from neuralgaits.certificate.levels.full_order.norm_plans import NormPlans, Plan
from neuralgaits.certificate.levels.full_order.samples import GaitSamples

Worth = Callable[[NormPlans], float]
"""Function from the plans of a norm to the number by which norms are compared."""


def find_plan(samples: GaitSamples, bandwidth: float, error: float = 0.0) -> Plan | None:
    """Return the plan in which torques can be held the longest; None if no set exists."""

    def hold(plans: NormPlans) -> float:
        return 1e3 * plans.best().hold

    found = _best(samples, bandwidth, hold, held=True, error=error)
    if found.best().hold == 0.0 and found.error > 0.0:
        # Where nothing can be held no norm is better than another: start where half the errors are.
        sensed = None if samples.sensed is None else 0.5 * samples.sensed
        half = replace(samples, sensed=sensed), bandwidth, hold
        start = _best(*half, held=True, error=0.5 * error).matrix
        found = _best(samples, bandwidth, hold, held=True, error=error, start=start)
    plan = found.best()
    return plan if plan.hold > 0.0 else None


def find_widest(samples: GaitSamples, bandwidth: float) -> Plan | None:
    """Return the plan of the largest set without pushes; None if no set exists."""

    def size(planned: NormPlans) -> float:
        # Where every impact enlarges outputs by more than a step lets them shrink, the excess.
        return 1e3 * planned.widest().radius or planned.slack_of_impacts

    plan = _best(samples, bandwidth, size).widest()
    return plan if plan.radius > 0.0 else None


def _best(
    samples: GaitSamples,
    bandwidth: float,
    worth: Worth,
    held: bool = False,
    error: float = 0.0,
    start: np.ndarray | None = None,
) -> NormPlans:
    """Return the norm with the highest value, from S = `start` or from the robot's inertia on."""
    from scipy.optimize import minimize  # Slow to import, and only proofs need it.

    m = len(samples.inertia)
    rows, diagonal = np.tril_indices(m), np.diag_indices(m)

    def matrix(x: np.ndarray) -> np.ndarray:
        lower = np.zeros((m, m))
        lower[rows] = x
        # The size of S means nothing, but limits on radii are absolute: 1 for the determinant.
        logarithms = lower[diagonal]
        size = np.exp(logarithms.mean())
        lower[diagonal] = np.exp(logarithms)
        return lower.T / size

    if start is None:
        lower = np.linalg.cholesky(samples.inertia / np.linalg.det(samples.inertia) ** (1.0 / m))
    else:
        lower = start.T.copy()
    lower[diagonal] = np.log(lower[diagonal])
    with np.errstate(all="ignore"):
        best = minimize(
            lambda x: -worth(NormPlans(samples, bandwidth, matrix(x), held, error)),
            lower[rows],
            method="Nelder-Mead",
            options={"maxfev": 900 if held else 500, "adaptive": True},  # Norms that are tried.
        )
        # Few digits, for people to read.
        return NormPlans(samples, bandwidth, np.round(matrix(best.x), 4), held, error)
