"""A gait in three dimensions: its policy, and the set of states at which its steps may start."""

from typing import Any

import equinox as eqx
import numpy as np
from scipy.linalg import solve_discrete_lyapunov

from neuralgaits._types import Float
from neuralgaits.errors import NonFiniteError
from neuralgaits.systems.walker3d.spatial_orbit import SpatialOrbit
from neuralgaits.systems.walker3d.spatial_policy import Pendulum, SpatialPolicy

SHRINKING = 0.15
"""By this exponent a deviation must at least shrink over a step, in the inlet's own metric."""
INLET_SIZE = 1.8
"""Size of the inlet, in deviations of `section_scale`."""


class SpatialGait(eqx.Module):
    """A gait.

    Attributes:
        policy: outputs of a state.
        start: (y, L_y, n) of the periodic orbit where a step starts, x being x0. [3]
        inlet: half axes, as columns, of the ellipsoid of starts about it. [3, 3]
    """

    policy: SpatialPolicy
    start: Float[np.ndarray, "3"]
    inlet: Float[np.ndarray, "3 3"]

    def starts(self, inside: Float[np.ndarray, "N 3"]) -> Float[np.ndarray, "N 4"]:
        """Return states of the inlet: 0 is its centre, unit vectors its face."""
        rows = np.asarray(self.start) + inside @ np.asarray(self.inlet).T
        first = np.full((len(rows), 1), float(self.policy.ends[0]))
        return np.concatenate([first, rows], axis=1)


def gait_of(orbit: SpatialOrbit, scale: Float[np.ndarray, "3"]) -> SpatialGait:
    """Return the gait of an orbit, with the inlet that its linear section map shrinks.

    Raises: NonFiniteError if the orbit is not stable enough.
    """
    largest = float(np.abs(np.linalg.eigvals(orbit.section)).max())
    if not largest * np.exp(SHRINKING) < 1.0:
        raise NonFiniteError(
            f"expected multipliers of a gait below {np.exp(-SHRINKING):.2f}, found {largest:.3g}: "
            "the robot's gait is not stable"
        )
    grown = np.exp(SHRINKING) * orbit.section
    metric = solve_discrete_lyapunov(grown.T, np.eye(3))
    inlet = INLET_SIZE * scale[:, None] * np.linalg.inv(np.linalg.cholesky(metric)).T
    return SpatialGait(orbit.policy, orbit.start, inlet)


def empty_gait() -> SpatialGait:
    """Return a gait of zeros, to read arrays into."""
    sizes = (2, 4, 4, 3, 3, 4, 4, 2, 3)
    pendulum: Any = Pendulum(*(np.zeros(()) for _ in range(4)))  # pyright: ignore
    policy = SpatialPolicy(*(np.zeros(size) for size in sizes), pendulum)  # pyright: ignore
    return SpatialGait(policy, np.zeros(3), np.zeros((3, 3)))
