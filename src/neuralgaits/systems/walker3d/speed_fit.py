"""Find a gait for a range of speeds: orbits at a few of them, and polynomials through these."""

from collections.abc import Callable
from dataclasses import replace
from typing import NamedTuple

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np

from neuralgaits._quick_jit import quick_jit
from neuralgaits._types import Array, Float
from neuralgaits.gait.commands import Command
from neuralgaits.systems.condition_table import ConditionTable
from neuralgaits.systems.walker3d.orbit_search import find_orbit
from neuralgaits.systems.walker3d.spatial_gait import SpatialGait
from neuralgaits.systems.walker3d.spatial_orbit import OrbitAims, SpatialOrbit
from neuralgaits.systems.walker3d.spatial_policy import INPUT_SCALE, StepNumbers
from neuralgaits.systems.walker3d.spatial_start import section_scale
from neuralgaits.systems.walker3d.spatial_step import step_from
from neuralgaits.systems.walker3d.spatial_walker import SpatialWalker
from neuralgaits.systems.walker3d.speed_gait import (
    DEGREE,
    SpeedGait,
    SpeedTube,
    empty_speed_gait,
    pair_terms,
    speed_terms,
)
from neuralgaits.systems.walker3d.tube_fit import (
    DISTURBANCE,
    Followed,
    first_axes,
    followed,
    tube_along,
    widest,
)

DISTURBANCES = np.hstack([DISTURBANCE, [[0.0], [0.7], [0.0]]])
"""See `tube_fit.DISTURBANCE`; a change of speed moves the momentum forward, too."""


def widest_speed_gait(
    robot: SpatialWalker,
    command: Command,
    table: ConditionTable,
    iterations: int = 250,
    progress: Callable[[int, float], None] | None = None,
) -> SpeedGait:
    """Find a gait for every speed of a range, with tubes as wide as a search allows.

    Args:
        robot: the model.
        command: range of the speed, and its largest change from step to step.
        table: conditions and their regions.
        iterations: largest number of iterations of the search for an orbit.
        progress: called after each of them with its number and the cost.

    Raises: NonFiniteError if there is no stable gait at some speed.
    """
    orbits = []
    for share in _shares(DEGREE + 1):
        speed = float(command.middle + command.half * share)
        near = orbits[-1] if orbits else None
        orbits.append(find_orbit(robot, OrbitAims.of(robot, speed), iterations, progress, near))
    scale = section_scale(robot, orbits[0].policy.pendulum)
    bare = _steered(robot, orbits, _through(orbits, command), scale)
    steps = _steps_of_pairs(robot, bare, scale)
    return widest(robot, lambda size: _with_tubes(orbits, bare, steps, scale, size), table)


def _shares(count: int) -> Float[np.ndarray, " count"]:
    """Return where to lay polynomials through, in [-1, 1] (Chebyshev's), the lowest first."""
    return -np.cos(np.pi * (np.arange(count) + 0.5) / count)


def _through(orbits: list[SpatialOrbit], command: Command) -> SpeedGait:
    """Return the gait of steps through those of some orbits; it has no tubes yet."""
    pendulum, centre = orbits[0].policy.pendulum, orbits[len(orbits) // 2].policy.centre
    rows = [_recentred(one.numbers, np.asarray(one.policy.centre - centre)) for one in orbits]
    numbers = jax.tree.map(lambda *values: _polynomials(np.stack(values)), *rows)
    empty = empty_speed_gait(command)
    return replace(empty, numbers=numbers, centre=centre, pendulum=pendulum)


def _polynomials(values: Float[np.ndarray, "k *shape"]) -> Float[np.ndarray, "k *shape"]:
    """Return coefficients of `speed_terms` of polynomials through values at the nodes."""
    terms = np.stack([np.asarray(speed_terms(jnp.asarray(x))) for x in _shares(len(values))])
    return np.linalg.solve(terms, values.reshape(len(values), -1)).reshape(values.shape)


def _recentred(numbers: StepNumbers, moved: Float[np.ndarray, "3"]) -> StepNumbers:
    """Return numbers of the same steps for invariants about another centre."""

    def about(weights: Array) -> Array:
        return weights - np.append(weights[1:] @ (moved / INPUT_SCALE), np.zeros(3))

    return eqx.tree_at(
        lambda one: (one.start, one.landing),
        numbers,
        (about(numbers.start), about(numbers.landing)),
    )


def _steered(
    robot: SpatialWalker, orbits: list[SpatialOrbit], bare: SpeedGait, scale: Float[np.ndarray, "3"]
) -> SpeedGait:
    """Return the gait with the bumps that lead a step from one speed's orbit to the next one's.

    Four bumps for three numbers: least squares, at each speed of the orbits, of the miss in half
    axes of a tube of usual width, and of the bumps in sizes that count alike.
    """
    size = 0.47  # Half width of that tube in L_y, in deviations of `section_scale`.
    # What counts as much as a miss of one half axis [rad], [m], [m], [m].
    sizes = np.array([0.3, 0.03, 0.1, 0.06])
    starts = _polynomials(np.stack([one.start for one in orbits]))
    bare = eqx.tree_at(lambda one: one.tube.start, bare, starts)

    def missed(added: Array, before: Array, after: Array) -> Float[Array, "3"]:
        step, following = bare.steered(before, after, added)
        start = step.tube.section(jnp.zeros(())).centre
        return step_from(robot, step.policy, start).landed[1:] - following.section.centre

    largest = bare.command.change_limit / bare.command.half
    slopes = quick_jit(jax.jacfwd(missed, argnums=(0, 1, 2)))
    found = []
    for share, orbit in zip(_shares(len(orbits)), orbits, strict=True):
        speed = jnp.asarray(share)
        by_bumps, by_before, by_after = map(np.asarray, slopes(jnp.zeros(4), speed, speed))
        by_change = 0.5 * largest * (by_after - by_before)
        inside = np.linalg.inv(first_axes(orbit.section, scale, size, DISTURBANCES))
        left = np.concatenate([inside @ by_bumps, np.diag(1.0 / sizes)])
        right = np.concatenate([-inside @ by_change, np.zeros(4)])
        found.append(np.linalg.lstsq(left, right, rcond=None)[0])
    return eqx.tree_at(lambda one: one.steering, bare, _polynomials(np.stack(found)))


class _StepsOfPairs(NamedTuple):
    """Steps whose tubes the others are fitted to.

    Attributes:
        pairs: speeds told before and now, as shares of the range.
        terms: their `pair_terms`. [k, terms]
        steps: the steps, followed.
    """

    pairs: list[tuple[float, float]]
    terms: Float[np.ndarray, "k terms"]
    steps: list[Followed]


def _steps_of_pairs(
    robot: SpatialWalker, bare: SpeedGait, scale: Float[np.ndarray, "3"]
) -> _StepsOfPairs:
    """Follow steps of a few pairs of speeds; tubes of all widths are about the same motion."""
    # Mean of both speeds and their difference.
    middles, changes = np.meshgrid(_shares(5), (-1.0, 0.0, 1.0), indexing="ij")
    laid = np.stack([middles.ravel(), changes.ravel()], axis=1)
    terms = np.stack([np.asarray(pair_terms(*map(jnp.asarray, pair))) for pair in laid])
    reach = 0.5 * bare.command.change_limit / bare.command.half
    pairs = [(middle - reach * change, middle + reach * change) for middle, change in laid]
    steps = [_step_of(bare, pair) for pair in pairs]
    policies = jax.tree.map(lambda *parts: np.stack(parts), *(one.policy for one in steps))
    starts = np.concatenate([one.tube.sections(np.zeros(1))[0] for one in steps])
    return _StepsOfPairs(pairs, terms, followed(robot, policies, starts, scale))


def _step_of(gait: SpeedGait, pair: tuple[float, float]) -> SpatialGait:
    return gait.of_shares(*map(jnp.asarray, pair))[0]


def _with_tubes(
    orbits: list[SpatialOrbit],
    bare: SpeedGait,
    known: _StepsOfPairs,
    scale: Float[np.ndarray, "3"],
    size: float,
) -> SpeedGait:
    """Return the gait with tubes of a half width in L_y, in deviations of `section_scale`."""
    axes = np.stack([first_axes(one.section, scale, size, DISTURBANCES) for one in orbits])
    bare = eqx.tree_at(lambda one: one.tube.start_axes, bare, _polynomials(axes))
    first = [_step_of(bare, pair).tube.sections(np.zeros(1))[1][0] for pair in known.pairs]
    tubes = [tube_along(*parts) for parts in zip(known.steps, first, strict=True)]

    def fitted(parts: list[Array]) -> np.ndarray:
        rows = np.stack(parts).reshape(len(parts), -1)
        found = np.linalg.lstsq(known.terms, rows, rcond=None)[0]
        return found.reshape(known.terms.shape[1], *parts[0].shape)

    tube = SpeedTube(
        bare.tube.start,
        bare.tube.start_axes,
        fitted([one.centre for one in tubes]),
        fitted([one.axes for one in tubes]),
    )
    return eqx.tree_at(lambda one: one.tube, bare, tube)
