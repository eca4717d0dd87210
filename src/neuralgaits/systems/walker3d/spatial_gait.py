"""A gait in three dimensions: its policy, its periodic orbit and the tube of steps about it."""

from abc import abstractmethod
from typing import Any

import equinox as eqx
import jax.numpy as jnp
import numpy as np
from typing_extensions import override

from neuralgaits._types import Array, Float
from neuralgaits.gait.commands import Command
from neuralgaits.systems.walker3d.spatial_policy import Pendulum, SpatialPolicy
from neuralgaits.systems.walker3d.spatial_tube import SpatialTube, TubeSection, in_ball

CENTRE_DEGREE, AXES_DEGREE = 12, 8
"""Degrees of the tube's polynomials."""


class StepStart(eqx.Module):
    """Where a step starts.

    Attributes:
        section: the tube's ellipsoid there.
        aside: where the swing foot is, for (1, invariants), see `SpatialPolicy.start`. [4]
    """

    section: TubeSection
    aside: Float[Array, "4"]


class AbstractSpatialGait(eqx.Module):
    """A gait whose steps are told commands, or none.

    Attributes:
        command: what each touchdown brings; None for a gait that takes no commands.
        tube: numbers of the states that steps stay in.
    """

    command: eqx.AbstractVar[Command | None]
    tube: eqx.AbstractVar[eqx.Module]

    @property
    @abstractmethod
    def typical(self) -> "SpatialGait":
        """The gait as it is told the middle of its commands' range all the time."""

    @abstractmethod
    def step(self, pair: Float[Array, "2"]) -> "SpatialGait":
        """Return the step that was told these values of the command, before and now.

        Both are ignored by a gait that takes no commands.
        """

    @abstractmethod
    def told(self, axes: Float[Array, " k"]) -> "tuple[SpatialGait, StepStart]":
        """Return a step and where the next one starts, at a point of the command's axes."""


class SpatialGait(AbstractSpatialGait):
    """A gait that takes no commands, or one step of a gait that does.

    Attributes:
        policy: outputs of a state.
        tube: states that steps stay in.
    """

    policy: SpatialPolicy
    tube: SpatialTube
    command: Command | None = eqx.field(static=True, default=None)

    @property
    @override
    def typical(self) -> "SpatialGait":
        """The gait itself."""
        return self

    @override
    def step(self, pair: Float[Array, "2"]) -> "SpatialGait":
        del pair
        return self

    @override
    def told(self, axes: Float[Array, " k"]) -> "tuple[SpatialGait, StepStart]":
        del axes
        return self, StepStart(self.tube.section(jnp.zeros(())), self.policy.start)

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
        return self.state(u[0], self.tube.section(u[0]).states(in_ball(u[1:4])))

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

    def distance(self, z: Float[Array, "4"]) -> Float[Array, ""]:
        """Return how far a state is from the tube's middle, in half axes: it is inside up to 1.

        Phases beyond a step's ends count as these.
        """
        section = self.tube.section(jnp.clip(self.policy.phase(z), 0.0, 1.0))
        w = section.inside(z[1:] - section.centre)
        return jnp.sqrt(w @ w)

    def starts(self, inside: Float[np.ndarray, "N 3"]) -> Float[np.ndarray, "N 4"]:
        """Return states where steps start: 0 is the tube's centre there, unit vectors its face."""
        (centre,), (axes,) = self.tube.sections(np.zeros(1))
        rows = centre + inside @ axes.T
        first = np.full((len(rows), 1), float(self.policy.ends[0]))
        return np.concatenate([first, rows], axis=1)


def empty_gait() -> SpatialGait:
    """Return a gait of zeros, to read arrays into."""
    sizes = (2, 5, 5, 5, 3, 4, 4, 2, 3)
    pendulum: Any = Pendulum(*(np.zeros(()) for _ in range(4)))  # pyright: ignore
    policy = SpatialPolicy(*(np.zeros(size) for size in sizes), pendulum)  # pyright: ignore
    centre, axes = np.zeros((CENTRE_DEGREE + 1, 3)), np.zeros((AXES_DEGREE + 1, 3, 3))
    return SpatialGait(policy=policy, tube=SpatialTube(centre, axes))
