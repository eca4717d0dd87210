"""Plain functions that a trainer compiles: gradient steps in one loop, evaluation of a gait."""

from collections.abc import Callable
from typing import NamedTuple

import equinox as eqx
import jax
import jax.numpy as jnp
import optax

from neuralgaits.barriers import GaitSpec
from neuralgaits.gait import Residuals
from neuralgaits.gait.policies.commanded_gait import AnyGait
from neuralgaits.robots.mjcf.parameters import Model, nominal_robot
from neuralgaits.training.disturbance_corners import DisturbanceBox, pushes_of
from neuralgaits.training.loss import Loss, MarginLayout, barrier_loss, margin_matrix
from neuralgaits.training.repair import with_extra
from neuralgaits.training.sampling import Sampler

VALIDATION_SAMPLES = 8
"""Number of validation samples for each training sample."""


class SinglePrecision(NamedTuple):
    """Parts of a training in single precision, in which its steps are computed."""

    robot: Model
    layout: MarginLayout
    sampler: Sampler
    fixed: AnyGait
    """Leaves of the gait that are not trained."""
    residuals: Residuals


def make_steps(
    spec: GaitSpec,
    parts: SinglePrecision,
    disturbance: DisturbanceBox,
    unflatten: Callable,
    optimizer: optax.GradientTransformation,
    curriculum_iterations: int,
) -> Callable:
    """Return the function that takes gradient steps in one loop.

    Args:
        spec: conditions and recipe.
        parts: robot, layout, sampler, untrained leaves and residuals.
        disturbance: bounds of dz's disturbance under which conditions must hold (m/s, N m).
        unflatten: flat parameters to the trained leaves.
        optimizer: an optax optimizer.
        curriculum_iterations: iterations of which the recipe's curriculum is a share; 0 for none.

    Returns: (parameters, optimiser state, key, first step, count, share of the step size, extra)
        to parameters, state and the `Loss` of the last step before it was taken.
    """
    robot, layout, sampler, fixed, residuals = parts
    growth = spec.recipe.curriculum * curriculum_iterations

    def grown(index):
        return jnp.minimum(1.0, (index + 1.0) / growth) if growth else 1.0

    def loss(parameters, u, counts, pushes):
        gait = eqx.combine(unflatten(parameters), fixed).match_impact(
            nominal_robot(robot), residuals.reset
        )
        margins, torque = margin_matrix(spec, robot, gait, u, residuals, pushes, layout.aimed)
        result = barrier_loss(spec, layout._replace(counts=counts), margins, torque)
        return result.total, result

    def step(parameters, state, key, index, rate, extra):
        key = jax.random.fold_in(key, index)
        # Each of three draws splits this key itself: the sampler uses it and folds in 2 and 3,
        # `with_extra` and `pushes_of` both fold in 1. Places of extra boxes are the last rows of
        # the batch and pushes are drawn for all rows in order, so no row has both from one number.
        batch = sampler.draw(key, grown(index))
        u, counts = with_extra(extra, 1, batch, layout.counts, key)
        gradient_of = jax.value_and_grad(loss, has_aux=True)
        u, pushes = u.astype(jnp.float32), pushes_of(disturbance, key, len(u), jnp.float32)
        (_, result), gradient = gradient_of(parameters, u, counts, pushes)
        update, after = optimizer.update(gradient, state, parameters)
        updated = optax.apply_updates(parameters, rate * update)
        if not spec.commands:
            return updated, after, result
        return *_if_finite((updated, after), (parameters, state)), result

    return _looped(step, len(spec.trained_for))


def _looped(step: Callable, conditions: int) -> Callable:
    """Return the function that repeats a step, whose loss is about so many conditions.

    A step runs for a millisecond or two: calling it from Python took a third of the time.
    """

    def steps(parameters, state, key, first, count, rate, extra):
        single = parameters.dtype

        def body(number, before):
            parameters, state, _ = before
            parameters, state, report = step(parameters, state, key, first + number, rate, extra)
            # A float64 constant in a condition of one's own makes the loss float64.
            same = jax.tree.map(lambda value: value.astype(single), report)
            return parameters, state, same

        zero = jnp.zeros((), single)
        start = Loss(zero, jnp.zeros(conditions, single), zero)
        return jax.lax.fori_loop(0, count, body, (parameters, state, start))

    return steps


def _if_finite(new: tuple, old: tuple) -> tuple:
    """Return new parameters and state, or the old ones if the parameters turned to NaN.

    A fence that crosses another at some rare pair of commands must not end a training.
    """
    good = jnp.all(jnp.isfinite(jnp.asarray(new[0])))
    return jax.tree.map(lambda after, before: jnp.where(good, after, before), new, old)


def make_evaluate(
    spec: GaitSpec,
    robot: Model,
    sampler: Sampler,
    layout: MarginLayout,
    residuals: Residuals,
    disturbance: DisturbanceBox,
) -> Callable:
    """Return the function that evaluates a gait on validation samples.

    Returns: (gait, key, extra, share of the disturbance) to `Loss` and margins [N, K].
    """

    def evaluate(gait, key, extra, share):
        u, counts = with_extra(extra, VALIDATION_SAMPLES, sampler.draw(key), layout.counts, key)
        pushes = pushes_of(disturbance, key, len(u), u.dtype, share)
        margins, torque = margin_matrix(spec, robot, gait, u, residuals, pushes, layout.aimed)
        return barrier_loss(spec, layout._replace(counts=counts), margins, torque), margins

    return evaluate
