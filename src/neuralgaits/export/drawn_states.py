"""Draw commands, steps and states of a gait on which C and Python are compared."""

import jax
import jax.numpy as jnp
import numpy as np

from neuralgaits._blocks import in_blocks
from neuralgaits._quick_jit import quick_filter_jit
from neuralgaits._types import Array, Float
from neuralgaits.control import Controller
from neuralgaits.export.design import Design
from neuralgaits.gait import ZeroDynamics
from neuralgaits.gait.commands import CommandLimits, Pair, coordinates_of
from neuralgaits.gait.policies.commanded_gait import AnyGait

_BATCH = 2048
"""Number of cases computed together; another number would compile the code again."""


def steps_of(
    design: Design, count: int, seed: int
) -> tuple[Float[np.ndarray, "N 2 p"], Float[np.ndarray, "N s"]]:
    """Return commands before and of random steps, and their numbers. Returns: [N, 2, p], [N, s]."""
    pair, _ = drawn_commands(design, min(count, _BATCH), np.random.default_rng([seed, 1]))
    commands, numbers = np.stack(pair, axis=1), _numbers(design, pair)
    return (
        np.resize(commands, (count, *commands.shape[1:])),
        np.resize(numbers, (count, *numbers.shape[1:])),
    )


def steady_steps(design: Design, command: Float[np.ndarray, "N p"]) -> Float[np.ndarray, "N s"]:
    """Return numbers of steps whose command has been constant for long. Returns: [N, s]."""
    return _numbers(design, Pair(command, command))


def _numbers(design: Design, pair: Pair) -> Float[np.ndarray, "N s"]:
    count = len(pair.before)
    rows = max(count, _BATCH)
    whole = Pair(*(np.resize(side, (rows, *side.shape[1:])) for side in pair))
    return np.asarray(_parameters_of_steps(design.controller, whole))[:count]


@quick_filter_jit
def _parameters_of_steps(controller: Controller, pairs: Pair) -> Float[Array, "N s"]:
    return jax.vmap(controller.parameters_of_step)(pairs)


def drawn_commands(
    design: Design, count: int, rng: np.random.Generator
) -> tuple[Pair, dict[str, np.ndarray]]:
    """Draw admissible pairs of commands, wishes, and commands before a tick, some out or NaN."""
    limits = CommandLimits.of(design.commands)
    shape, width = (count, len(design.commands)), limits.high - limits.low
    before = rng.uniform(limits.low, limits.high, shape)
    after = before + rng.uniform(-1.0, 1.0, shape) * limits.change
    after = np.clip(after, limits.low, limits.high)
    commands = rng.uniform(limits.low - 0.2 * width, limits.high + 0.2 * width, shape)
    commands = np.where(rng.uniform(size=shape) < 0.2, np.nan, commands)
    drawn = rng.uniform(limits.low, limits.high, shape)
    return Pair(single(before), single(after)), {
        "given": single(commands),
        "requested": single(drawn),
    }


def lifted(
    design: Design,
    chart: Float[np.ndarray, "N 2"],
    eta: Float[np.ndarray, "N two_m"],
    pair: Pair,
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Return full states, desired outputs, their slopes in z1, and numbers of the step.

    Returns: [N, 2n], [N, m], [N, m], [N, s].
    """

    def lift(*cases: np.ndarray) -> tuple[Array, Array, Array, Array]:
        return _lift(design.gait, design.controller, list(cases))

    return in_blocks(lift, _BATCH, chart, eta, *map(np.asarray, pair))


@quick_filter_jit
def _lift(
    gait: AnyGait, controller: Controller, cases: list[np.ndarray]
) -> tuple[Array, Array, Array, Array]:
    """Lift a fixed count of cases, so that the code is compiled once.

    Every case of a family has a policy of its own, so only a few are lifted at a time, to save
    memory.
    """
    robot, residual = controller.robot, controller.reset_residual

    def lift(u, error, before, after):
        pair = Pair(before, after)
        here = gait.at(robot, coordinates_of(gait.commands, pair), residual, exact=True)
        low, high = here.tube.fences(u[0])
        start, guard = here.span
        zeta = jnp.maximum(low + u[1] * (high - low), 1e-3 * high)
        z = jnp.stack([start + u[0] * (guard - start), jnp.sqrt(2.0 * zeta)])
        y, slope = jax.jvp(here.policy, (z,), (jnp.array([1.0, 0.0]),))
        numbers = controller.parameters_of_step(pair)
        return ZeroDynamics(robot, here.policy).phi_inv(z, error), y, slope, numbers

    return jax.vmap(lift)(*cases)


def single(values: np.ndarray) -> np.ndarray:
    """Return the nearest numbers of single precision, as doubles."""
    return np.asarray(values, dtype=np.float64).astype(np.float32).astype(np.float64)
