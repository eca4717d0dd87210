"""A gait in three dimensions: its policy, its periodic orbit and the tube of steps about it."""

from typing import Any

import equinox as eqx
import jax.numpy as jnp
import numpy as np

from neuralgaits._types import Array, Float
from neuralgaits.systems.walker3d.spatial_policy import Pendulum, SpatialPolicy
from neuralgaits.systems.walker3d.spatial_tube import SpatialTube, in_ball

CENTRE_DEGREE, AXES_DEGREE = 12, 8
"""Degrees of the tube's polynomials."""


class SpatialGait(eqx.Module):
    """A gait.

    Attributes:
        policy: outputs of a state.
        tube: states that steps stay in.
    """

    policy: SpatialPolicy
    tube: SpatialTube

    @property
    def start(self) -> Float[np.ndarray, "3"]:
        """(y, L_y, n) in the tube's middle where a step starts, on the periodic orbit."""
        return self.tube.sections(np.zeros(1))[0][0]

    def state(self, t: Float[Array, ""], deviating: Float[Array, "3"]) -> Float[Array, "4"]:
        """Return the state with (y, L_y, n) at a phase."""
        begin, end = self.policy.ends
        return jnp.append(begin + (end - begin) * t, deviating)

    def state_at(self, u: Float[Array, "4"]) -> Float[Array, "4"]:
        """Return the state at a point of the chart: phase, and a point of the cube."""
        return self.state(u[0], self.tube.section(u[0]).states(in_ball(u[1:])))

    def deviations(
        self, states: Float[np.ndarray, "N 4"]
    ) -> tuple[Float[np.ndarray, " N"], Float[np.ndarray, "N 3"], Float[np.ndarray, "N 3"]]:
        """Return phases, and how far (y, L_y, n) are from the tube's middle, also in half axes.

        Phases beyond a step's ends count as these.
        """
        phases = np.clip(np.asarray(self.policy.phase(states.T)), 0.0, 1.0)
        centres, axes = self.tube.sections(phases)
        off = states[:, 1:] - centres
        return phases, off, np.linalg.solve(axes, off[..., None])[..., 0]

    def holds(self, states: Float[np.ndarray, "N 4"]) -> np.ndarray:
        """Return which states are in the tube. [N]."""
        _, _, w = self.deviations(states)
        return np.sum(w * w, axis=1) <= 1.0

    def starts(self, inside: Float[np.ndarray, "N 3"]) -> Float[np.ndarray, "N 4"]:
        """Return states where steps start: 0 is the tube's centre there, unit vectors its face."""
        (centre,), (axes,) = self.tube.sections(np.zeros(1))
        rows = centre + inside @ axes.T
        first = np.full((len(rows), 1), float(self.policy.ends[0]))
        return np.concatenate([first, rows], axis=1)


def empty_gait() -> SpatialGait:
    """Return a gait of zeros, to read arrays into."""
    sizes = (2, 4, 4, 3, 3, 4, 4, 2, 3)
    pendulum: Any = Pendulum(*(np.zeros(()) for _ in range(4)))  # pyright: ignore
    policy = SpatialPolicy(*(np.zeros(size) for size in sizes), pendulum)  # pyright: ignore
    centre, axes = np.zeros((CENTRE_DEGREE + 1, 3)), np.zeros((AXES_DEGREE + 1, 3, 3))
    return SpatialGait(policy, SpatialTube(centre, axes))
