"""Fit a residual to windows of measured states by multiple shooting: init, step, validate, done.

Every window starts at its measured state and is integrated through omega(0, z) + epsilon(z); the
loss is the trajectory's error, in scaled z, relative to the error of the model alone. The batch of
step k follows from seed and k alone. Runs in float64.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Literal, NamedTuple

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import optax

from neuralgaits._quick_jit import quick_jit
from neuralgaits._types import Array, Float
from neuralgaits.errors import InputError
from neuralgaits.gait import ZeroDynamics
from neuralgaits.gait.flow_residual import Residual
from neuralgaits.logs import Windows
from neuralgaits.residual.nero import balanced, nero
from neuralgaits.residual.shooting import model_rate, shoot
from neuralgaits.residual.trajectories import prediction_errors

Optimizer = Literal["adam", "adamw", "nero"]
Progress = Callable[[int, int, float], None]
"""Callback with (steps done, steps in all, validation loss relative to the model's)."""


@dataclass(frozen=True)
class FitConfig:
    """Settings of a fit.

    Attributes:
        optimizer: adam, adamw, or nero.
        hidden: widths of the hidden layers.
        learning_rate: initial rate; a cosine brings it to zero.
        weight_decay: decay of adamw.
        windows: windows of a batch.
        steps: largest number of gradient steps.
        validate_every: steps between two validations.
        patience: validations without improvement after which the fit ends.
    """

    optimizer: Optimizer = "adam"
    hidden: tuple[int, ...] = (16, 16)
    learning_rate: float = 0.01
    weight_decay: float = 1e-3
    windows: int = 16
    steps: int = 3000
    validate_every: int = 100
    patience: int = 8

    def __post_init__(self):
        """Check the name of the optimiser. Raises: InputError if it is unknown."""
        if self.optimizer not in ("adam", "adamw", "nero"):
            raise InputError(f"unknown optimizer {self.optimizer!r}: expected adam, adamw or nero")


class FitState(NamedTuple):
    """Everything a fit needs to go on. Arrays only."""

    step: Array
    """Number of gradient steps done. int32 scalar."""
    parameters: Any
    """Current parameters, as a tree."""
    optimizer: Any
    """State of the optimiser, as a tree."""
    best: Any
    """Parameters with the smallest validation loss so far."""
    best_loss: Array
    """Smallest validation loss so far."""
    stale: Array
    """Number of validations since that loss. int32 scalar."""


@dataclass(frozen=True)
class Fitter:
    """Fit residuals of one policy's zero dynamics to one set of windows.

    Attributes:
        zd: robot and policy that walked; its own residual is ignored.
        train, validation: windows.
        scale: scale of z in the loss (m, kg m^2/s). [2]
        config: settings of the fit.
        seed: seed of weights and batches.
        unit: mean squared error of the model alone on `train`, in scaled z.
    """

    zd: ZeroDynamics
    train: Windows
    validation: Windows
    scale: Float[np.ndarray, "2"]
    config: FitConfig
    seed: int
    unit: float
    _template: Residual
    _optimizer: optax.GradientTransformation
    _step: Callable

    @classmethod
    def build(
        cls,
        zd: ZeroDynamics,
        train: Windows,
        validation: Windows,
        scale: Float[np.ndarray, "2"],
        *,
        config: FitConfig | None = None,
        seed: int = 0,
    ) -> "Fitter":
        """Set the residual's scales and bound from the windows and prepare the step.

        Raises: InputError if there are no windows for training or validation.
        """
        config = FitConfig() if config is None else config
        for name, windows in (("learn from", train), ("choose by", validation)):
            if not len(windows.z):
                raise InputError(f"expected windows to {name}, found none: walk longer")
        # Nothing as a residual of the same structure: one compilation for both.
        model = prediction_errors(zd, Residual.like(config.hidden), train)
        template = Residual.init(
            train.z[:, 0], model.defects, hidden=config.hidden, key=jax.random.key(seed)
        )
        unit = float(np.mean((model.errors / scale) ** 2))
        optimizer = _optimizer(config)
        step = _make_step(zd, template, optimizer)
        return cls(
            zd=zd,
            train=train,
            validation=validation,
            scale=np.asarray(scale, dtype=np.float64),
            config=config,
            seed=seed,
            # A model without any error would otherwise divide zero by zero.
            unit=max(unit, 1e-30),
            _template=template,
            _optimizer=optimizer,
            _step=step,
        )

    def init(self) -> FitState:
        """Return the state before the first step."""
        parameters, _ = eqx.partition(self._template, self._template.trainable())
        parameters = jax.tree.map(jnp.asarray, parameters)
        if self.config.optimizer == "nero":
            parameters = balanced(parameters)
        zero, worst = jnp.zeros((), jnp.int32), jnp.full((), jnp.inf)
        return FitState(zero, parameters, self._optimizer.init(parameters), parameters, worst, zero)

    def step(self, state: FitState) -> tuple[FitState, Array]:
        """Take one gradient step. Returns: the new state and the batch's loss."""
        draws = np.random.default_rng([self.seed, int(state.step)])
        pick = draws.integers(len(self.train.z), size=self.config.windows)
        parameters, optimizer, loss = self._step(
            state.parameters,
            state.optimizer,
            self.train.t[pick],
            self.train.z[pick],
            self.scale,
            self.unit,
        )
        updated = state._replace(step=state.step + 1, parameters=parameters, optimizer=optimizer)
        return updated, loss

    def validate(self, state: FitState) -> FitState:
        """Keep the parameters if their validation loss is the smallest so far."""
        errors = prediction_errors(self.zd, self.residual(state.parameters), self.validation).errors
        loss = float(np.mean((errors / self.scale) ** 2)) / self.unit
        if loss < float(state.best_loss):
            return state._replace(
                best=state.parameters, best_loss=jnp.asarray(loss), stale=jnp.zeros((), jnp.int32)
            )
        return state._replace(stale=state.stale + 1)

    def done(self, state: FitState) -> bool:
        """Return whether all steps are done, or validation has stopped improving."""
        return int(state.step) >= self.config.steps or int(state.stale) >= self.config.patience

    def residual(self, parameters: Any) -> Residual:
        """Return the residual with these parameters, in NumPy."""
        return eqx.combine(jax.tree.map(np.asarray, parameters), self._template)


def fit(fitter: Fitter, progress: Progress | None = None) -> tuple[Residual, FitState]:
    """Fit until done. Returns: the residual of smallest validation loss, and the last state."""
    state = fitter.validate(fitter.init())
    while not fitter.done(state):
        state, _ = fitter.step(state)
        if int(state.step) % fitter.config.validate_every == 0:
            state = fitter.validate(state)
            if progress is not None:
                progress(int(state.step), fitter.config.steps, float(state.best_loss))
    return fitter.residual(state.best), state


def _optimizer(config: FitConfig) -> optax.GradientTransformation:
    rate = optax.cosine_decay_schedule(config.learning_rate, config.steps)
    if config.optimizer == "nero":
        return nero(rate)
    if config.optimizer == "adamw":
        return optax.adamw(rate, weight_decay=config.weight_decay)
    return optax.adam(rate)


def _make_step(zd: ZeroDynamics, template: Residual, optimizer) -> Callable:
    # Numbers are arguments, so that every policy and robot of one structure shares a compilation.
    model = ZeroDynamics(zd.robot, zd.policy)
    arrays, structure = eqx.partition(model, eqx.is_array)
    _, fixed = eqx.partition(template, template.trainable())
    numbers, shape = eqx.partition(fixed, eqx.is_array)
    # NumPy arrays would be copied in again at every step.
    arrays, numbers = jax.tree.map(jnp.asarray, (arrays, numbers))

    def step(arrays, numbers, parameters, state, t, z, scale, unit):
        rate = model_rate(eqx.combine(arrays, structure))

        def loss(parameters):
            epsilon = eqx.combine(parameters, numbers, shape)

            def miss(t, z):
                return (shoot(lambda y: rate(y) + epsilon(y), z[0], t) - z[1:]) / scale[None]

            return jnp.mean(jax.vmap(miss)(t, z) ** 2) / unit

        value, gradient = jax.value_and_grad(loss)(parameters)
        change, state = optimizer.update(gradient, state, parameters)
        return optax.apply_updates(parameters, change), state, value

    compiled = quick_jit(step)
    return lambda *inputs: compiled(arrays, numbers, *inputs)
