"""The lean that a robot believes in, from step to step: the command `lean` of its gait.

Between touchdowns nothing changes. At each touchdown the belief moves towards the lean that the
step that ended shows, see `lean_sums`; it stays within the range of the gait's commands, and the
controller limits its change from step to step. A proof about every sequence of beliefs is about
this one, too, however wrong the estimate is.
"""

import math
from typing import NamedTuple

from neuralgaits.gait.commands import LEAN, Commands, command_named

SETTLED_M = 1e-3
"""A belief that moves by less a step has settled [m]: AMBER-3M's speed changes by 0.009 m/s then,
which a speed that is adapted, too, need not wait for."""


class LeanBelief(NamedTuple):
    """Limits of a believed lean, and the gain."""

    low: float
    """Lowest lean [m]."""
    high: float
    """Highest lean [m]."""
    gain: float = 0.3
    """Share of the way to what a step shows [1]: it averages over about three steps."""


def belief_for(commands: Commands) -> LeanBelief | None:
    """Return how a gait's lean is learned; None if it takes none."""
    lean = command_named(commands, LEAN)
    return None if lean is None else LeanBelief(lean.low, lean.high)


def next_belief(belief: LeanBelief, believed: float, learned: float) -> float:
    """Return what the next touchdown is to latch (m).

    Args:
        belief: limits and gain.
        believed: lean of the step that begins, as the controller latched it (m).
        learned: lean that the step that ended shows (m); NaN if it shows none.
    """
    if not math.isfinite(learned):
        return believed
    wanted = believed + belief.gain * (learned - believed)
    return min(max(wanted, belief.low), belief.high)
