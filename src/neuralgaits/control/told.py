"""Commands of a controller: latched at touchdowns, with the step parameters computed from them.

A command outside its range is clamped, one that is not a number leaves the last request unchanged,
and a change faster than the gait can follow is spread over steps.
"""

from typing import TYPE_CHECKING, NamedTuple

import jax
import jax.numpy as jnp

from neuralgaits._types import Array, Bool, Float
from neuralgaits.gait import AbstractPolicy
from neuralgaits.gait.commands import Commands, Limits, Pair
from neuralgaits.gait.reset_residual import Reset
from neuralgaits.robots import PlanarBiped

if TYPE_CHECKING:
    from neuralgaits.control.controller import Controller


class Told(NamedTuple):
    """Commands by their order, in their units; all of it empty for a gait that takes none."""

    wanted: Float[Array, " p"]
    """Requested commands: the next touchdown goes there, as far as one step may change."""
    pair: Pair
    """Commands of the step under way."""
    numbers: Float[Array, " s"]
    """Parameters of the step, computed from that pair; see `AbstractPolicy.step_numbers`."""


def steady(
    robot: PlanarBiped,
    policy: AbstractPolicy,
    command: Float[Array, " p"],
    reset_residual: Reset = None,
) -> Told:
    """Return the state of a command that has been constant for long."""
    one = jnp.asarray(command, dtype=float)
    pair = Pair(one, one)
    return Told(one, pair, policy.step_numbers(robot, pair, reset_residual))


def tell(commands: Commands, told: Told, wanted: Float[Array, " p"]) -> Told:
    """Request other values from the next touchdown on: clamped, the last one in place of NaN."""
    limits = Limits.of(commands)
    inside = jnp.clip(wanted, limits.low, limits.high)
    return told._replace(wanted=jnp.where(jnp.isnan(wanted), told.wanted, inside))


def next_pair(commands: Commands, told: Told) -> Pair:
    """Return the pair of the step that begins at a touchdown."""
    change = Limits.of(commands).change
    last = told.pair.after
    return Pair(last, jnp.clip(told.wanted, last - change, last + change))


def latch(controller: "Controller", told: Told, touchdown: Bool[Array, ""]) -> Told:
    """Return the commands after a tick that may be a touchdown."""
    policy = controller.policy
    if not policy.commands:
        return told
    pair = next_pair(policy.commands, told)
    numbers = policy.step_numbers(controller.robot, pair, controller.reset_residual)
    after = Told(told.wanted, pair, numbers)
    return jax.tree.map(lambda new, old: jnp.where(touchdown, new, old), after, told)
