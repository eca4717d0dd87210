"""The tube about a periodic orbit: what the linearised flow and touchdown shrink."""

from collections.abc import Callable, Mapping
from typing import NamedTuple, TypeVar

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from numpy.polynomial import chebyshev
from scipy.linalg import solve_discrete_lyapunov

from neuralgaits._quick_jit import quick_jit
from neuralgaits._types import Array, Float
from neuralgaits.errors import NonFiniteError
from neuralgaits.programs import Program
from neuralgaits.programs.tracing.tracer import trace
from neuralgaits.systems.condition_table import ConditionTable
from neuralgaits.systems.walker3d.spatial_conditions import spatial_margins
from neuralgaits.systems.walker3d.spatial_dynamics import flow
from neuralgaits.systems.walker3d.spatial_gait import (
    AXES_DEGREE,
    CENTRE_DEGREE,
    AbstractSpatialGait,
    SpatialGait,
)
from neuralgaits.systems.walker3d.spatial_levels import TABLE
from neuralgaits.systems.walker3d.spatial_orbit import SpatialOrbit
from neuralgaits.systems.walker3d.spatial_policy import SpatialPolicy
from neuralgaits.systems.walker3d.spatial_start import section_scale
from neuralgaits.systems.walker3d.spatial_step import step_from
from neuralgaits.systems.walker3d.spatial_tube import SpatialTube
from neuralgaits.systems.walker3d.spatial_walker import SpatialWalker
from neuralgaits.systems.walker3d.tube_samples import all_above

Gait = TypeVar("Gait", bound=AbstractSpatialGait)
DISTURBANCE = np.array([[0.83, 2.92, 0.0], [0.0, 1.0, 0.0], [0.44, -4.17, 0.56]])
"""Half axes, as columns, of what may happen to the start of each step, of any size, in deviations
of `section_scale`: the tube's section is in proportion to what accumulates. Chosen for the robot
that is shipped so that the conditions hold on tubes as wide as possible in L_y."""
SHRINKING = 0.2
"""Exponent by which the tube lets deviations grow over a step beyond the linearised flow, so that
the flow points inward; the touchdown takes at least as much back."""


class Followed(NamedTuple):
    """Values and slopes by phase, at equal distances of phase. [phases, 3], [phases, 3, 3]."""

    centre: np.ndarray
    centre_slope: np.ndarray
    deviations: np.ndarray
    deviation_slopes: np.ndarray


def widest_gait(robot: SpatialWalker, orbit: SpatialOrbit) -> SpatialGait:
    """Return the gait with the widest tube in which a search finds no condition broken.

    The narrowest one is returned if there is none. Raises: NonFiniteError as `gait_of`.
    """
    scale = section_scale(robot, orbit.policy.pendulum)
    policies = jax.tree.map(lambda one: np.asarray(one)[None], orbit.policy)
    (step,) = followed(robot, policies, np.asarray(orbit.start)[None], scale)
    return widest(robot, lambda size: gait_of(orbit, step, scale, size), TABLE)


def widest(robot: SpatialWalker, sized: Callable[[float], Gait], table: ConditionTable) -> Gait:
    """Return the gait with the widest tube in which a search finds no condition broken.

    Args:
        robot: the model.
        sized: returns the gait with a tube of a half width in L_y, in deviations of
            `section_scale`.
        table: regions of the conditions.

    Returns: the narrowest one that is tried if there is none.
    """
    sizes = (0.62, 0.54, 0.47, 0.41, 0.35, 0.28, 0.2, 0.12)
    program = None
    for size in sizes[:-1]:
        gait = sized(size)
        if program is None:
            program = _margins_in_any_tube(robot, gait, table)
        # Two axes more take more draws to find a corner.
        count = 2**10 if gait.command is None else 2**14
        least_margin = 0.004
        if all_above(least_margin, program, count, 0, table, _numbers_of(gait)):
            return gait
    return sized(sizes[-1])


def _margins_in_any_tube(
    robot: SpatialWalker, gait: AbstractSpatialGait, table: ConditionTable
) -> Program:
    """Trace the margins once for tubes of all widths, whose numbers are inputs."""
    numbers = _numbers_of(gait)

    def margins(u: Array, **tube: Array) -> Mapping[str, Array]:
        leaves = [tube[name] for name in numbers]
        return spatial_margins(robot, eqx.tree_at(_leaves_of_tube, gait, leaves), u)

    shapes = {name: array.shape for name, array in numbers.items()}
    return trace(margins, {"u": (table.chart.size,), **shapes})


def _numbers_of(gait: AbstractSpatialGait) -> dict[str, np.ndarray]:
    """Return the numbers of a gait's tube by the names of inputs."""
    leaves = map(np.asarray, _leaves_of_tube(gait))
    return {f"tube_{number}": leaf for number, leaf in enumerate(leaves)}


def _leaves_of_tube(gait: AbstractSpatialGait) -> list[Array]:
    return jax.tree.leaves(gait.tube)


def gait_of(
    orbit: SpatialOrbit, step: Followed, scale: Float[np.ndarray, "3"], size: float
) -> SpatialGait:
    """Return the gait of an orbit with a tube about it.

    Args:
        orbit: the periodic orbit.
        step: its step, followed.
        scale: see `section_scale`.
        size: half width of the tube in L_y, in these.

    Raises: NonFiniteError if the orbit is not stable enough.
    """
    tube = tube_along(step, first_axes(orbit.section, scale, size))
    # NumPy's own numbers, as a run's folder gives them back.
    return jax.tree.map(np.asarray, SpatialGait(policy=orbit.policy, tube=tube))


def first_axes(
    section: Float[np.ndarray, "3 3"],
    scale: Float[np.ndarray, "3"],
    size: float,
    disturbances: Float[np.ndarray, "3 k"] = DISTURBANCE,
) -> Float[np.ndarray, "3 3"]:
    """Return half axes R(0) of the tube where a step starts.

    They are such that the touchdown brings R(1) back into R(0), with as much to spare as
    multipliers allow: with Q = R(0) R(0)^T and the section's derivatives A,
    Q = A Q A^T / share^2 + D D^T of the disturbances D.

    Args:
        section: derivatives A of the start of the next step, in scaled coordinates.
        scale: see `section_scale`.
        size: half width of the tube in L_y, in these.
        disturbances: see `DISTURBANCE`.

    Raises: NonFiniteError if the orbit is not stable enough.
    """
    largest = float(np.abs(np.linalg.eigvals(section)).max())
    if not largest * np.exp(SHRINKING) < 1.0:
        raise NonFiniteError(
            f"expected multipliers of a gait below {np.exp(-SHRINKING):.2f}, found {largest:.3g}: "
            "the robot's gait is not stable"
        )
    grown = np.exp(SHRINKING) * section
    share = 0.5 * (1.0 + largest * np.exp(SHRINKING))
    shape = solve_discrete_lyapunov(grown / share, disturbances @ disturbances.T)
    # The first axis is the one along L_y, which `closer` is least coupled with; the last is
    # reversed, so that the volume is positive.
    order = np.ix_([1, 0, 2], [1, 0, 2])
    first = np.linalg.cholesky(shape[order])[[1, 0, 2]] * np.array([1.0, 1.0, -1.0])
    return size / np.linalg.norm(first[1]) * scale[:, None] * first


def tube_along(step: Followed, first: Float[np.ndarray, "3 3"]) -> SpatialTube:
    """Return the tube of a step about its motion from its start.

    Half axes grow as R(t) = Phi(t) R(0) e^(SHRINKING t) with the linearised flow Phi.

    Args:
        step: the step, followed.
        first: R(0).
    """
    shares = np.linspace(0.0, 1.0, len(step.centre))
    growth = np.exp(SHRINKING * shares)[:, None, None]
    axes = growth * (step.deviations @ first)
    axes_slope = SHRINKING * axes + growth * (step.deviation_slopes @ first)
    return SpatialTube(
        _fitted(shares, step.centre, step.centre_slope, CENTRE_DEGREE),
        _fitted(shares, axes, axes_slope, AXES_DEGREE),
    )


def followed(
    robot: SpatialWalker,
    policies: SpatialPolicy,
    starts: Float[np.ndarray, "k 3"],
    scale: Float[np.ndarray, "3"],
) -> list[Followed]:
    """Follow steps from their starts, and their neighbours; no tube's width is in that.

    Args:
        robot: the model.
        policies: one policy a step: each array has a first axis.
        starts: (y, L_y, n) where the steps start.
        scale: see `section_scale`.
    """
    deviation = 1e-3  # Deviations from a step that are followed, in those of `section_scale`.
    near = np.vstack([np.zeros(3), deviation * np.eye(3), -deviation * np.eye(3)]) * scale
    pendulum = jax.tree.map(lambda one: one[0], policies.pendulum)

    def of_step(policy: SpatialPolicy, start: Array) -> tuple[Array, Array]:
        # The pendulum's numbers are those of all steps, and known to the compiler.
        policy = eqx.tree_at(lambda one: one.pendulum, policy, pendulum)
        states = jax.vmap(lambda one: step_from(robot, policy, one).states)(start[None] + near)
        rates = jax.vmap(lambda z: flow(robot, policy, z).rates)(states.reshape(-1, 4))
        slopes = rates[:, 1:] / rates[:, :1] * (policy.ends[1] - policy.ends[0])
        return states[..., 1:], slopes.reshape(*states.shape[:-1], 3)

    states, slopes = map(np.asarray, quick_jit(jax.vmap(of_step))(policies, jnp.asarray(starts)))

    def differences(rows: np.ndarray) -> np.ndarray:
        return np.moveaxis(rows[1:4] - rows[4:], 0, -1) / (2.0 * deviation * scale)

    return [
        Followed(way[0], slope[0], differences(way), differences(slope))
        for way, slope in zip(states, slopes, strict=True)
    ]


def _fitted(
    shares: Float[np.ndarray, " p"], values: np.ndarray, slopes: np.ndarray, degree: int
) -> np.ndarray:
    """Return coefficients, of ascending powers of 2 t - 1, that fit values and slopes best."""
    place = 2.0 * shares - 1.0
    rows = chebyshev.chebvander(place, degree)
    rising = chebyshev.chebvander(place, degree - 1) @ (2.0 * chebyshev.chebder(np.eye(degree + 1)))
    # Both ends count most, slopes least.
    weights = np.where((shares == 0.0) | (shares == 1.0), 20.0, 1.0)
    weights = np.concatenate([weights, 0.05 * weights])[:, None]
    targets = np.concatenate([part.reshape(len(shares), -1) for part in (values, slopes)])
    left = weights * np.concatenate([rows, rising])
    coefficients = np.linalg.lstsq(left, weights * targets, rcond=None)[0]
    powers = np.stack([chebyshev.cheb2poly(column) for column in coefficients.T], axis=1)
    return powers.reshape(degree + 1, *values.shape[1:])
