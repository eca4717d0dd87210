"""Commands of a controller, and the parameters that a step computes from them.

`Controller.latch` takes the commands over at each touchdown.

A command outside its range is clamped, one that is no number leaves the last wish as it was, and
a change faster than the gait can follow is spread over steps.
"""

from typing import NamedTuple

import jax.numpy as jnp

from neuralgaits._types import Array, Float
from neuralgaits.gait.commands import CommandLimits, Commands, Pair


class CommandState(NamedTuple):
    """Commands by their order, in their units; all of it empty for a gait that takes none."""

    requested: Float[Array, " p"]
    """Requested commands: the next touchdown goes there, as far as one step may change."""
    pair: Pair
    """Commands of the step under way."""
    step_parameters: Float[Array, " s"]
    """Parameters of that step, see `AbstractPolicy.parameters_of_step`."""


def tell(commands: Commands, state: CommandState, requested: Float[Array, " p"]) -> CommandState:
    """Wish for other values from the next touchdown on: clamped, the last one in place of NaN."""
    limits = CommandLimits.of(commands)
    inside = jnp.clip(requested, limits.low, limits.high)
    return state._replace(requested=jnp.where(jnp.isnan(requested), state.requested, inside))


def next_pair(commands: Commands, state: CommandState) -> Pair:
    """The pair of the step that begins at a touchdown."""
    change = CommandLimits.of(commands).change
    last = state.pair.after
    return Pair(last, jnp.clip(state.requested, last - change, last + change))
