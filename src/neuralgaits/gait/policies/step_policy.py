"""A policy of one step, and the few parameters in which two steps of a family differ.

On the robot those numbers are computed once, at the touchdown that begins a step; a tick evaluates
`StepPolicy` with them.
"""

import equinox as eqx
import jax.numpy as jnp

from neuralgaits._types import Actuated, Array, Float, Scalar, ZeroState
from neuralgaits.gait.commands import Number
from neuralgaits.gait.policy import NetworkPolicy
from neuralgaits.gait.zero_coordinates import position_of


class StepPolicy(NetworkPolicy):
    """Desired outputs y_d = lower + (upper - lower) logistic(H(t) + 4 (4t(1-t))^2 N(z)).

    t = (z1 - z_start) / (z_guard - z_start) is the phase of the step, H a cubic, N a network.

    Attributes:
        z_start: z1 after the impact [m].
        z_guard: z1 at the guard [m].
        cubic: coefficients of H in powers of t. [4, m]
        z2_dependence: False makes y_d a function of z1 alone.
    """

    z_guard: Float[Array, ""]
    z_start: Float[Array, ""]
    cubic: Float[Array, "4 m"]
    z2_dependence: eqx.AbstractVar[bool]

    def __call__(self, z: ZeroState) -> Actuated:
        """Desired actuated joint angles. Returns: [m] (rad)."""
        phase = self.phase(position_of(z))
        inputs = self.inputs(z)
        if not self.z2_dependence:
            inputs = jnp.stack([inputs[0], jnp.zeros_like(inputs[0])])
        bump = 4.0 * phase * (1.0 - phase)
        return self.within_bounds(self.path(phase) + (4.0 * bump * bump) * self.network(inputs))

    def path(self, phase: Number) -> Actuated:
        """H at a phase. Returns: [m]."""
        a0, a1, a2, a3 = self.cubic
        return a0 + phase * (a1 + phase * (a2 + phase * a3))

    @property
    def z1_range(self) -> tuple[Scalar, Scalar]:
        """z1 after the impact and at the guard (m)."""
        return self.z_start, self.z_guard

    @property
    def step_parameters(self) -> Float[Array, " s"]:
        """Parameters of this step: z_start, z_guard, cubic, first bias. [2 + 4 m + h]."""
        ends = jnp.stack([self.z_start, self.z_guard])
        return jnp.concatenate([ends, self.cubic.reshape(-1), self.network.biases[0]])


class TabulatedStep(StepPolicy):
    """Policy of one step, put together from its parameters: all that a tick evaluates."""

    z2_dependence: bool = eqx.field(static=True, default=True)

    @property
    def step_size(self) -> int:
        """Length of the vector of parameters of the step."""
        return len(self.step_parameters)

    def trainable(self) -> "TabulatedStep":
        """Raise NotImplementedError, because a step is computed and not trained."""
        raise NotImplementedError("a step is computed, not trained")
