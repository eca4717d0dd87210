"""Parameters that the controller of a commanded gait has for its steps."""

import jax
import numpy as np

from neuralgaits._blocks import in_blocks
from neuralgaits._quick_jit import quick_filter_jit
from neuralgaits._types import Array, Float
from neuralgaits.analysis.run import PolicyOfSteps, Run
from neuralgaits.gait.commands import Pair


def step_parameters(run: Run, commands: Float[np.ndarray, "N 2 p"]) -> Float[np.ndarray, "N s"]:
    """Return the parameters that the controller had for the step of each tick.

    Args:
        run: the run.
        commands: commands of the step before, and of the step, at every tick.
    """
    pairs, which = np.unique(commands.reshape(len(commands), -1), axis=0, return_inverse=True)
    sides = pairs.reshape(len(pairs), 2, -1)
    policies = PolicyOfSteps(run.trained.policy, run.robot, run.residuals.reset)

    def some(before: np.ndarray, after: np.ndarray) -> tuple[Array]:
        return (_parameters_of_pairs(policies, Pair(before, after)),)

    (parameters,) = in_blocks(some, 64, sides[:, 0], sides[:, 1])
    return np.asarray(parameters)[which.reshape(-1)]


@quick_filter_jit
def _parameters_of_pairs(policies: PolicyOfSteps, pairs: Pair) -> Float[Array, "N s"]:
    """Return the parameters of steps with these commands; compiled for each number of steps."""
    return jax.vmap(policies.parameters_of_step)(pairs)
