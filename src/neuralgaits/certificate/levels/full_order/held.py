"""Effect of held torques on outputs, estimated at points. Nothing here is trusted."""

import math
from typing import NamedTuple

from neuralgaits.certificate.levels.full_order.theorem import lyapunov_rate

JERK = 1.1
"""Bound on the outputs' jerk under held torques at y = 0, as a multiple of the largest seen."""
JERK_SLOPE = 4.0
"""Factor for its slope in xi; enclosures of third derivatives are wide."""
JERK_PUSH = 1.5
"""Factor for its slope in a push."""


class Held(NamedTuple):
    """Errors that holds cause: |S e| up to first + second times the bound on sqrt(V).

    Attributes:
        push: first and second in the mean over a hold [rad/s^2, rad/s^2 per rad].
        peak: first and second at its end, in the same units.
    """

    push: tuple[float, float]
    peak: tuple[float, float]


class Jerk(NamedTuple):
    """Bounds on the outputs' jerk while torques are held, in the norm of S.

    Attributes:
        still: jerk at y = 0 and e = 0 [rad/s^3].
        slope: its slope in xi [rad/s^3 per rad].
        push: its slope in S e [1/s].
    """

    still: float
    slope: float
    push: float

    def held(self, hold: float, error: float, bandwidth: float, radius: float) -> Held | None:
        """Bound the errors of held torques that are off by |S e| = error when they are set.

        Returns None if there is no bound. `radius` bounds sqrt(V) in the set. Source:
        docs/level5_proof.md.
        """
        gamma, back = float(lyapunov_rate(bandwidth)), 2.0 * bandwidth + self.push
        if hold * back >= 0.5:
            return None
        mean = 0.5 * hold * (1.0 + gamma * hold / 8.0)
        growth = math.exp(0.5 * gamma * hold) * (math.sqrt(2.0) * bandwidth**3 + self.slope)
        first = (error + hold * (self.still + back * hold * growth * radius)) / (1.0 - hold * back)
        fast = self.still + back * (first + hold * growth * radius)
        push = error + mean * fast, mean * growth
        return Held(push, (error + hold * fast, hold * growth))
