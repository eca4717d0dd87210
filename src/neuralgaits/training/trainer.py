"""Training as an explicit state: init, step, done. One step is a pure jitted function.

The state is a handful of flat arrays, and the samples of step k follow from seed and k alone, so a
run that was killed continues to the same bits. Training runs in float32; the result is cast to
float64 and matched to the robot once more.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import optax
from jax.flatten_util import ravel_pytree

from neuralgaits._quick_jit import quick_filter_jit, quick_jit
from neuralgaits._types import Array, Float
from neuralgaits.barriers import GaitSpec
from neuralgaits.errors import InputError
from neuralgaits.gait import NO_RESIDUALS, Residuals
from neuralgaits.gait.policies.commanded_gait import AnyGait
from neuralgaits.gait.reset_residual import ResetCorrection
from neuralgaits.robots.mjcf.parameters import Model, nominal_robot
from neuralgaits.training.disturbance_corners import DisturbanceBox
from neuralgaits.training.gradient_step import (
    VALIDATION_SAMPLES,
    SinglePrecision,
    make_evaluate,
    make_steps,
)
from neuralgaits.training.learning_rate import optimizer_of, width_factor
from neuralgaits.training.loss import Loss, MarginLayout, lay_out, lay_out_again
from neuralgaits.training.precision import cast, cast_named
from neuralgaits.training.repair import Extra
from neuralgaits.training.sampling import Sampler
from neuralgaits.training.train_state import FreshMargins, TrainState

VALIDATE_EVERY = 100
"""Gradient steps between two evaluations of the fixed validation samples."""
SMALLER = 0.3
"""Factor on the size of steps after NaN."""
RESTARTS = 3
"""Number of times that this factor may be applied."""
VALIDATION_SEED = 0
"""Of the samples on which weights are compared, the same for all gaits."""


@dataclass(frozen=True)
class Trainer:
    """Train gaits for one robot and one spec; gaits may differ in their weights only.

    Attributes:
        model: the robot, or those of a box around it that the spec's parameters make.
        spec: conditions, regions and recipe.
        steps: gradient steps in all.
        seed: seed of the samples.
        layout: columns of each condition's margins on them.
        residuals: residuals learned for the robot.
        disturbance: each sample has one corner of this box added to dz (m/s, N m); None for none.
            Reports leave it out.
        extra: boxes that get samples beside the regions' own, in steps and validation; None
            for an ordinary training.
        round: 0 for an ordinary training; each number has samples of its own.
    """

    model: Model
    spec: GaitSpec
    steps: int
    seed: int
    layout: MarginLayout
    residuals: Residuals
    disturbance: DisturbanceBox
    _step: Callable
    _evaluate: Callable
    _unflatten: Callable
    _optimizer: optax.GradientTransformation
    _template: AnyGait
    _single: SinglePrecision
    _validation_layout: MarginLayout
    extra: Extra | None = None
    round: int = 0

    @classmethod
    def build(
        cls,
        model: Model,
        spec: GaitSpec,
        template: AnyGait,
        *,
        steps: int,
        seed: int,
        residuals: Residuals = NO_RESIDUALS,
        disturbance: DisturbanceBox = None,
        rate: float = 1.0,
    ) -> "Trainer":
        """Lay out samples and margins and prepare the jitted functions.

        Args:
            model: the robot, or those of a box around it that the spec's parameters make.
            spec: conditions, regions and recipe.
            template: a gait of the structure to be trained.
            steps: gradient steps in all; the schedule depends on it.
            seed: seed of the samples.
            residuals: residuals learned for the robot.
            disturbance: bounds of dz's disturbance under which conditions must hold (m/s, N m).
            rate: factor on the recipe's learning rate.
        """
        sampler, validation = samplers_of(spec)
        layout = lay_out(spec, model, template, sampler)
        trained, fixed = eqx.partition(template, template.trainable())
        _, unflatten = ravel_pytree(cast(trained, jnp.float32))
        optimizer = optimizer_of(spec.recipe, steps, rate * width_factor(spec, template))
        single = SinglePrecision(
            robot=cast(model, np.float32),
            layout=cast_named(layout, np.float32),
            sampler=cast_named(sampler, np.float32),
            fixed=cast(fixed, np.float32),
            residuals=cast(residuals, np.float32),
        )
        steps_taken = make_steps(spec, single, disturbance, unflatten, optimizer, steps)
        checked = lay_out_again(layout, spec, validation)
        evaluate = make_evaluate(spec, model, validation, checked, residuals, disturbance)
        return cls(
            model=model,
            spec=spec,
            steps=steps,
            seed=seed,
            layout=layout,
            residuals=residuals,
            disturbance=disturbance,
            _step=quick_jit(steps_taken),
            _evaluate=quick_filter_jit(evaluate),
            _unflatten=unflatten,
            _optimizer=optimizer,
            _template=template,
            _single=single,
            _validation_layout=checked,
        )

    def repairing(self, steps: int) -> "Trainer":
        """Return a trainer for repair rounds of a trained gait, `steps` steps each."""
        # Slower than the recipe: the gait is nearly there.
        factor = 0.5 * width_factor(self.spec, self._template)
        optimizer = optimizer_of(self.spec.recipe, steps, factor)
        parts = self.spec, self._single, self.disturbance, self._unflatten
        compiled = quick_jit(make_steps(*parts, optimizer, curriculum_iterations=0))
        return replace(self, steps=steps, _step=compiled, _optimizer=optimizer)

    def for_repair_round(self, extra: Extra, number: int) -> "Trainer":
        """Return the trainer of one round: these boxes get samples too. Nothing is compiled."""
        return replace(self, extra=extra, round=number)

    def init(self, gait: AnyGait) -> TrainState:
        """Return the state before the first step."""
        trained, _ = eqx.partition(gait, gait.trainable())
        flat, _ = ravel_pytree(cast(trained, jnp.float32))
        start = jnp.zeros((), jnp.int32)
        worst = jnp.full((), jnp.inf, jnp.float64)
        rate = jnp.ones((), jnp.float32)
        return TrainState(start, flat, self._optimizer.init(flat), flat, worst, rate)

    def restart_with_smaller_rate(self, state: TrainState) -> TrainState | None:
        """Go back to the best weights, with smaller steps, where a state turned to NaN.

        Returns: None if its steps are as small as makes sense.
        """
        # Half-way to the next factor, since the rate is in single precision.
        if float(state.rate) < 1.5 * SMALLER**RESTARTS:
            return None
        return state._replace(parameters=state.best, rate=SMALLER * state.rate)

    def step(self, state: TrainState, count: int = 1) -> tuple[TrainState, Loss]:
        """Take gradient steps, each on fresh samples. Results arrive asynchronously, when read.

        Args:
            state: state to continue from.
            count: number of steps; the way they are split into calls does not change any bit.

        Returns: the state after them, and the loss of the last one before it was taken.
        """
        key = jax.random.key(self.seed)
        if self.round:
            # Step numbers stay below 2^31: no step of an ordinary training has this key.
            key = jax.random.fold_in(key, 2**31 + self.round)
        parameters, optimizer, loss = self._step(
            state.parameters,
            state.optimizer,
            key,
            state.step,
            jnp.int32(count),
            state.rate,
            self.extra,
        )
        state = state._replace(step=state.step + count, parameters=parameters, optimizer=optimizer)
        return state, loss

    def validate(self, state: TrainState) -> TrainState:
        """Keep the parameters if their loss on the validation samples is the lowest so far."""
        gait = self.gait(state.parameters)
        key, disturbed = jax.random.key(VALIDATION_SEED), jnp.ones(())
        result, _ = self._evaluate(gait, key, self.extra, disturbed)
        loss = float(result.total)
        if loss < float(state.best_loss):
            return state._replace(best=state.parameters, best_loss=jnp.asarray(loss, jnp.float64))
        return state

    def gait(self, parameters: Float[Array, " P"]) -> AnyGait:
        """Return the gait with these parameters, in float64 and matched to the robot."""
        trained = cast(self._unflatten(parameters), np.float64)
        gait = eqx.combine(trained, self._template)
        return _match_impact(gait, self.model, self.residuals.reset)

    def report(self, gait: AnyGait, *, seed: int) -> FreshMargins:
        """Return loss and margins on samples inside the regions (`VALIDATION_SAMPLES` x batch).

        Samples of extra boxes count for the loss alone.
        """
        key, undisturbed = jax.random.key(seed), jnp.zeros(())
        loss, margins = self._evaluate(gait, key, self.extra, undisturbed)
        rows = self._validation_layout.counts
        margins = np.asarray(margins)[: len(rows)]
        by_condition = {
            name: margins[rows[:, block.start]][:, block]
            for name, block in self._validation_layout.columns.items()
        }
        return FreshMargins(float(loss.total), by_condition)

    def of_seed(self, seed: int, gait: AnyGait) -> "Trainer":
        """Return the trainer of another seed. Nothing is compiled again.

        Args:
            seed: seed of the samples.
            gait: untrained gait of that seed.

        Raises: InputError if it differs from the trainer's gait in more than weights.
        """
        others = [eqx.partition(one, one.trainable())[1] for one in (gait, self._template)]
        if not eqx.tree_equal(*others):
            raise InputError(
                "expected gaits of all seeds to differ in trained weights alone, found others "
                f"in that of seed {seed}: train them one by one, with --seed"
            )
        return replace(self, seed=seed)

    def done(self, state: TrainState) -> bool:
        """Return whether all steps are done."""
        return int(state.step) >= self.steps


def samplers_of(spec: GaitSpec) -> tuple[Sampler, Sampler]:
    """Return the samplers of a gradient step, and of the validation and the report on a gait."""
    recipe = spec.recipe
    halves = tuple(axis.half for axis in spec.parameters)
    plan = partial(Sampler.plan, spec.regions, commands=spec.commands, parameters=halves)
    sampler = plan(
        recipe.samples,
        recipe.overshoot,
        corners=recipe.corners,
        widened=recipe.widened,
        faster_changes=recipe.faster_changes,
        strip=recipe.strip,
    )
    more = {name: VALIDATION_SAMPLES * count for name, count in recipe.samples.items()}
    return sampler, plan(more)


@quick_filter_jit
def _match_impact(gait: AnyGait, model: Model, reset_residual: ResetCorrection) -> AnyGait:
    return gait.match_impact(nominal_robot(model), reset_residual)
