"""Levenberg's and Marquardt's search for a periodic gait, and its exact period."""

from collections.abc import Callable
from functools import lru_cache
from typing import NamedTuple

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jax.flatten_util import ravel_pytree

from neuralgaits._quick_jit import quick_jit
from neuralgaits._types import Array, Float
from neuralgaits.errors import NonFiniteError
from neuralgaits.systems.walker3d.spatial_orbit import (
    DIFFERENCE,
    OrbitAims,
    OrbitProblem,
    SpatialOrbit,
)
from neuralgaits.systems.walker3d.spatial_policy import Pendulum, SpatialPolicy
from neuralgaits.systems.walker3d.spatial_start import FirstGuess, first_guess
from neuralgaits.systems.walker3d.spatial_step import step_from
from neuralgaits.systems.walker3d.spatial_walker import SpatialWalker


class _Iterate(NamedTuple):
    """Numbers with their residuals and the derivatives of these."""

    numbers: Float[np.ndarray, " p"]
    residuals: Float[np.ndarray, " r"]
    slopes: Float[np.ndarray, "r p"]

    @property
    def cost(self) -> float:
        return float(self.residuals @ self.residuals)


def find_orbit(
    robot: SpatialWalker,
    aims: OrbitAims,
    iterations: int = 250,
    progress: Callable[[int, float], None] | None = None,
    near: SpatialOrbit | None = None,
) -> SpatialOrbit:
    """Find a periodic gait.

    Args:
        robot: the model.
        aims: properties of the gait that are aimed at.
        iterations: largest number of iterations.
        progress: called after each of them with its number and the cost.
        near: orbit from which the search starts; the first guess if None.

    Raises: NonFiniteError if the first guess is no gait of the robot, or none has a period.
    """
    guess = first_guess(robot, aims.speed, aims.duration, aims.side, aims.lateral)
    problem = OrbitProblem(robot, guess, aims)
    numbers, restored = problem.parts()
    if near is not None:
        numbers = np.asarray(ravel_pytree((near.numbers, near.start))[0])
    of_rows = _residuals_of(robot, guess.pendulum)

    def evaluated(point: Float[np.ndarray, " p"]) -> _Iterate:
        near = np.vstack([point, point + DIFFERENCE * np.eye(len(point))])
        residuals = np.asarray(of_rows(guess, aims, jnp.asarray(near)))
        slopes = (residuals[1:] - residuals[0]).T / DIFFERENCE
        return _Iterate(point, residuals[0], slopes)

    best, damping = evaluated(numbers), 1e-2
    if not np.isfinite(best.cost):
        raise NonFiniteError(
            f"expected a first guess of a gait at {aims.speed:.3g} m/s, found none: this robot's "
            "legs are too short or its motors too weak for it"
        )
    least_gain = 1e-5  # Share of the cost that an iteration must gain to be followed by another.
    for count in range(iterations):
        moved = _moved(best, damping, evaluated)
        if moved is None:
            break
        following, damping = moved
        gain, best = best.cost - following.cost, following
        if progress is not None:
            progress(count + 1, best.cost)
        if gain < least_gain * best.cost:
            break
    found, start = jax.tree.map(np.asarray, restored(best.numbers))
    policy = jax.tree.map(np.asarray, problem.policy(found))
    start, section = exact_period(robot, policy, start, problem.scale)
    return SpatialOrbit(policy, start, section, best.cost, found)


@lru_cache(maxsize=8)
def _residuals_of(
    robot: SpatialWalker, pendulum: Pendulum
) -> Callable[[FirstGuess, OrbitAims, Float[Array, "k p"]], Float[Array, "k r"]]:
    """Return the compiled residuals of sets of numbers, for whatever guess and aims."""

    def residuals(guess: FirstGuess, aims: OrbitAims, row: Array) -> Array:
        # The pendulum's numbers go with the robot, and are known to the compiler.
        problem = OrbitProblem(robot, guess._replace(pendulum=pendulum), aims)
        _, restored = ravel_pytree((guess.numbers, guess.start))
        return problem.residuals(*restored(jnp.asarray(row)))

    return quick_jit(jax.vmap(residuals, in_axes=(None, None, 0)))


@lru_cache(maxsize=8)
def _landed_of(
    robot: SpatialWalker, pendulum: Pendulum
) -> Callable[[SpatialPolicy, Float[Array, "k 3"]], Float[Array, "k 3"]]:
    """Return a compiled function from starts to those of the next steps, for whatever policy."""

    def landed(policy: SpatialPolicy, start: Array) -> Array:
        policy = eqx.tree_at(lambda one: one.pendulum, policy, pendulum)
        return step_from(robot, policy, start).landed[1:]

    return quick_jit(jax.vmap(landed, in_axes=(None, 0)))


def _moved(
    point: _Iterate, damping: float, evaluated: Callable[[np.ndarray], _Iterate]
) -> tuple[_Iterate, float] | None:
    """Return a point with a lower cost and the damping to go on with; None if none was found."""
    square, slope = point.slopes.T @ point.slopes, point.slopes.T @ point.residuals
    dampings = 8
    for _ in range(dampings):
        damped = square + damping * np.diag(np.diag(square) + 1e-6)
        following = evaluated(point.numbers - np.linalg.solve(damped, slope))
        if np.isfinite(following.slopes).all() and following.cost < point.cost:
            return following, max(0.25 * damping, 1e-10)
        damping *= 5.0
    return None


def exact_period(
    robot: SpatialWalker,
    policy: SpatialPolicy,
    start: Float[np.ndarray, "3"],
    scale: Float[np.ndarray, "3"],
) -> tuple[Float[np.ndarray, "3"], Float[np.ndarray, "3 3"]]:
    """Return the start that a step leads back to, and the section's derivatives there.

    Returns: (y, L_y, n) [3], and derivatives in scaled coordinates [3, 3].

    Raises: NonFiniteError if there is none.
    """
    near = np.vstack([np.zeros(3), 0.1 * np.eye(3), -0.1 * np.eye(3)]) * scale
    landed = _landed_of(robot, jax.tree.map(float, policy.pendulum))
    newton_steps = 8
    for _ in range(newton_steps):
        ends = np.asarray(landed(policy, jnp.asarray(start + near)))
        section = (ends[1:4] - ends[4:]).T / 0.2 / scale[:, None]
        missed = (ends[0] - start) / scale
        if not np.isfinite(section).all():
            break
        if np.abs(missed).max() <= 1e-9:  # In scaled coordinates.
            return start, section
        start = start + scale * np.linalg.solve(np.eye(3) - section, missed)
    raise NonFiniteError("expected a gait with a period, found none: the robot does not walk so")
