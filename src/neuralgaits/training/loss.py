"""The Barrier Loss: hinges of all conditions over fresh samples. Source: paper Eq. 10.

One batch holds the samples of every region and every condition is evaluated on all of it; a
constant table says which rows count for which condition. This wastes a little arithmetic and saves
most of the compile time, for which a user waits.
"""

from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from neuralgaits._types import Array, Bool, Float, Scalar
from neuralgaits.barriers import Barrier, GaitSpec
from neuralgaits.barriers.aims import middle_of
from neuralgaits.gait import NO_RESIDUALS, Residuals, ZeroDynamics
from neuralgaits.gait.believed_robot import robot_of_step
from neuralgaits.gait.policies.commanded_gait import AnyGait
from neuralgaits.robots.mjcf.parameters import Model, nominal_robot
from neuralgaits.training.disturbance_corners import DisturbedResidual
from neuralgaits.training.sampling import Sampler, contains


class MarginLayout(NamedTuple):
    """Table of the margin columns and sample rows of each condition.

    Attributes:
        columns: condition name to its columns of the margin matrix.
        scale: scale of each column's condition. [K]
        counts: True where a row counts for a column. [N, K]
        mean_of: averages columns into conditions. [K, C]
        absolute: True for conditions penalised by the size of their error. [C]
        weight: weight of each condition. [C]
        aimed: rows on which the spec's aims are evaluated.
    """

    columns: dict[str, slice]
    scale: Float[np.ndarray, " K"]
    counts: Bool[Array, "N K"]
    mean_of: Float[np.ndarray, "K C"]
    absolute: np.ndarray
    weight: Float[np.ndarray, " C"]
    aimed: slice


class Loss(NamedTuple):
    """The loss, its penalty terms and its effort term."""

    total: Scalar
    terms: Float[Array, " C"]
    """Penalty of each condition, weights included. [C]"""
    effort: Scalar
    """Mean squared torque in the recipe's unit, weight included."""


def lay_out(spec: GaitSpec, robot: Model, gait: AnyGait, sampler: Sampler) -> MarginLayout:
    """Evaluate the conditions once and tabulate their shapes."""
    weights = spec.trained_for

    def margins(u):
        at = spec.parted(u)
        step = gait.at(nominal_robot(robot), at.commands)
        zd = ZeroDynamics(robot_of_step(robot, step, at.errors), step.policy)
        point = zd.point(step.z(at.plane))
        return {c.name: c.margins(point, step) for c in weights}

    shapes = jax.eval_shape(margins, jax.ShapeDtypeStruct((spec.chart_size,), jnp.zeros(0).dtype))
    return _tabulated(spec, [int(np.prod(shapes[c.name].shape)) for c in weights], sampler)


def lay_out_again(layout: MarginLayout, spec: GaitSpec, sampler: Sampler) -> MarginLayout:
    """Return the layout for other samples of the same spec; no condition is evaluated."""
    sizes = [block.stop - block.start for block in layout.columns.values()]
    return _tabulated(spec, sizes, sampler)


def _tabulated(spec: GaitSpec, sizes: list[int], sampler: Sampler) -> MarginLayout:
    """Return the layout of conditions with so many columns each."""
    weights = spec.trained_for
    ends = np.cumsum([0, *sizes])
    columns = {c.name: slice(int(ends[i]), int(ends[i + 1])) for i, c in enumerate(weights)}
    total, rows = int(ends[-1]), len(sampler.low)
    counts = np.zeros((rows, total), dtype=bool)
    mean_of = np.zeros((total, len(weights)))
    scale = np.ones(total)
    for i, c in enumerate(weights):
        block = columns[c.name]
        scale[block], mean_of[block, i] = c.scale, 1.0 / sizes[i]
        for name, part in sampler.rows.items():
            if contains(spec.regions[c.region], spec.regions[name]):
                counts[part, block] = True
    # Aims are costly, so they are evaluated only on the rows that are sampled for them.
    first = len(spec.conditions)
    aimed = _aims_rows(spec, sampler)
    counts[aimed, : int(ends[first])] = False
    counts[: aimed.start, int(ends[first]) :] = False
    absolute = np.array([c.absolute_loss for c in weights])
    weight = np.array([spec.weights.get(c.name, 1.0) for c in weights])
    return MarginLayout(columns, scale, counts, mean_of, absolute, weight, aimed)


def _aims_rows(spec: GaitSpec, sampler: Sampler) -> slice:
    """Return the rows of the aims' regions, which are the last ones."""
    total = len(sampler.low)
    starts = [sampler.rows[c.region].start for c in spec.aims]
    return slice(min(starts, default=total), total)


def margin_matrix(
    spec: GaitSpec,
    robot: Model,
    gait: AnyGait,
    u: Float[Array, "N n"],
    residuals: Residuals = NO_RESIDUALS,
    pushes: Float[Array, "N 2"] | None = None,
    aimed: slice | None = None,
) -> tuple[Float[Array, "N K"], Float[Array, "N m"]]:
    """Return margins of all conditions at all samples, in their own units, and torques.

    Args:
        spec: conditions.
        robot: the biped, or the family that has the spec's parameters.
        gait: policy and tube.
        u: samples.
        residuals: residuals learned for the robot.
        pushes: addition to dz at each sample (m/s, N m); None for none.
        aimed: rows on which the spec's aims are evaluated, 0 elsewhere; None for no rows.

    Returns: [N, K], columns in the order of the spec, aims last, and [N, m] (N m).
    """

    def at(sample, push):
        flow, reset = residuals
        pushed_flow = flow if push is None else DisturbedResidual(flow, push)
        at = spec.parted(sample)
        step = gait.at(nominal_robot(robot), at.commands, reset)
        zd = ZeroDynamics(robot_of_step(robot, step, at.errors), step.policy, pushed_flow, reset)
        return step, zd.point(step.z(at.plane))

    def one(sample, push):
        step, point = at(sample, push)
        # One derivative for all barriers, so that a network in them is evaluated once.
        barriers = [c for c in spec.conditions if isinstance(c, Barrier)]
        values, rates = point.rate(lambda p: [c.function(p) for c in barriers])
        bends = {c.name: c.bent(*both) for c, *both in zip(barriers, values, rates, strict=True)}
        margins = [
            jnp.ravel(bends[c.name] if c.name in bends else c.margins(point, step))
            for c in spec.conditions
        ]
        return jnp.concatenate(margins), point.torque

    margins, torque = jax.vmap(one)(u, pushes)
    if not spec.aims:
        return margins, torque

    def aims(sample):
        # Aims say how the gait is to walk on the robot of the file, so errors of the robot are 0.
        end = spec.chart_size - len(spec.parameters)
        step, point = at(jnp.concatenate([sample[:end], jnp.zeros_like(sample[end:])]), None)
        middle = middle_of(point, step)
        return jnp.concatenate([c.of(middle) for c in spec.aims])

    rows = slice(0, 0) if aimed is None else aimed
    width = jax.eval_shape(aims, jax.ShapeDtypeStruct(u.shape[1:], u.dtype)).shape[0]
    more = jnp.zeros((len(u), width), margins.dtype)
    if u[rows].shape[0]:
        more = more.at[rows].set(jax.vmap(aims)(u[rows]).astype(more.dtype))
    return jnp.concatenate([margins, more], axis=1), torque


def barrier_loss(
    spec: GaitSpec,
    layout: MarginLayout,
    margins: Float[Array, "N K"],
    torque: Float[Array, "N m"],
) -> Loss:
    """Return penalties of all conditions over one batch, plus the effort term.

    A condition's penalty is the mean hinge below the aim plus a share of the worst, or the mean
    absolute error.

    Args:
        spec: conditions and recipe.
        layout: layout of the batch.
        margins: margins from `margin_matrix`.
        torque: torques from `margin_matrix`.

    Returns: `Loss`.
    """
    recipe = spec.recipe
    hinge = jnp.where(layout.counts, jax.nn.relu(recipe.aim - margins / layout.scale[None]), 0.0)
    per_column = jnp.sum(hinge, axis=0) / layout.counts.sum(axis=0)
    if recipe.worst_weight:
        per_column = per_column + recipe.worst_weight * jnp.max(hinge, axis=0)
    # Not a matrix product: 0 * NaN is NaN, so one condition's NaN would spread to all.
    shares = jnp.where(layout.mean_of > 0, per_column[:, None] * layout.mean_of, 0.0)
    terms = jnp.sum(shares, axis=0)
    if np.any(layout.absolute):
        terms = _with_absolute(spec, layout, margins, terms)
    if recipe.logarithmic:
        terms = jnp.where(terms > 1.0, 1.0 + jnp.log(jnp.maximum(terms, 1.0)), terms)
    terms = layout.weight * terms
    effort = jnp.zeros((), terms.dtype)
    if recipe.effort:
        effort = recipe.effort * jnp.mean(torque * torque) / recipe.effort_torque**2
    return Loss(jnp.sum(terms) + effort, terms, effort)


def _with_absolute(
    spec: GaitSpec, layout: MarginLayout, margins: Float[Array, "N K"], terms: Float[Array, " C"]
) -> Float[Array, " C"]:
    """Replace the terms of equalities under absolute loss by their mean error norm."""
    terms = jnp.asarray(terms)
    for i, c in enumerate(spec.trained_for):
        if c.absolute_loss:
            block = layout.columns[c.name]
            rows = layout.counts[:, block.start]
            # tolerance - e and tolerance + e: half their difference is the error.
            below, above = jnp.split(margins[:, block], 2, axis=1)
            # Rows that do not count may be NaN, and so would their gradient be.
            error = jnp.where(rows[:, None], 0.5 * (above - below), 0.0)
            norms = jnp.sqrt(jnp.sum(error * error, axis=1) + 1e-18)
            terms = terms.at[i].set(jnp.sum(jnp.where(rows, norms, 0.0)) / rows.sum())
    return terms
