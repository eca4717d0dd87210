"""A gait: a policy and the tube of the zero dynamics that it is meant for."""

import equinox as eqx
import jax.numpy as jnp

from neuralgaits._types import Array, Float, Scalar, ZeroState
from neuralgaits.gait.commands import CommandPoint, Commands
from neuralgaits.gait.network import movable
from neuralgaits.gait.policy import AbstractPolicy
from neuralgaits.gait.reset_residual import ResetCorrection
from neuralgaits.gait.stepping_robot import SteppingRobot
from neuralgaits.gait.tubes import Number, Tube
from neuralgaits.gait.zero_coordinates import momentum_of, position_of


class Gait(eqx.Module):
    """A trained gait: a policy and the tube of the zero dynamics that it is meant for.

    Attributes:
        policy: policy of one step, or of every step where there are no commands.
        tube: tube of that step.
        next_tube: tube of the step after it if its command stays; None for the same.
    """

    policy: AbstractPolicy
    tube: Tube
    next_tube: Tube | None = None

    @property
    def commands(self) -> Commands:
        """Commands of the gait: none."""
        return ()

    def at(
        self,
        robot: SteppingRobot,
        v: CommandPoint,
        reset_residual: ResetCorrection = None,
        *,
        exact: bool = False,
    ) -> "Gait":
        """The gait of one step: itself. See `CommandedGait.at`."""
        del robot, v, reset_residual, exact
        return self

    @property
    def steady_next(self) -> "Gait":
        """The gait of the next step, if the command stays."""
        if self.next_tube is None:
            return self
        return Gait(self.policy.steady_next, self.next_tube, self.next_tube)

    @property
    def span(self) -> tuple[Number, Number]:
        """z1 at phase 0 and at phase 1 (m)."""
        if self.tube.span is None:
            return self.policy.z1_range
        return self.tube.span[0], self.tube.span[1]

    def phase(self, z1: Scalar) -> Scalar:
        """Phase of the step at hip position z1."""
        if self.tube.span is None:
            return self.policy.phase(z1)
        start, guard = self.span
        return (z1 - start) / (guard - start)

    def z(self, u: Float[Array, "2"]) -> ZeroState:
        """Chart: zero dynamics state at (phase, level). Returns: [2] (m, kg m^2/s)."""
        low, high = self.tube.fences(u[0])
        return self.state(u[0], low + u[1] * (high - low))

    def state(self, phase: Number, zeta: Number) -> ZeroState:
        """State at a phase, with z2 = sqrt(2 zeta) > 0 (m, kg m^2/s). [2]."""
        start, guard = self.span
        return jnp.stack([start + phase * (guard - start), jnp.sqrt(2.0 * zeta)])

    @property
    def stride(self) -> Number:
        """Distance that z1 goes in a step [m]."""
        start, guard = self.span
        return guard - start

    def pace(self, dz: ZeroState) -> Scalar:
        """Rate of the phase at a rate of z [1/s]."""
        return position_of(dz) / self.stride

    def slope(self, z: ZeroState, dz: ZeroState) -> Scalar:
        """Return d zeta / d phase along a flow, with zeta = z2^2 / 2 [(kg m^2/s)^2]."""
        return momentum_of(z) * momentum_of(dz) * self.stride / position_of(dz)

    def inward(self, z: ZeroState, dz: ZeroState) -> tuple[Scalar, Scalar]:
        """Slope of a flow against the lower and the upper fence, in tube widths per phase."""
        phase, along = self.phase(position_of(z)), self.slope(z, dz)
        low, high = self.tube.fences(phase)
        low_slope, high_slope = self.tube.fence_slopes(phase)
        return (along - low_slope) / (high - low), (high_slope - along) / (high - low)

    def level(self, z: ZeroState) -> Scalar:
        """Level of a state between the fences: 0 on the lower, 1 on the upper."""
        low, high = self.tube.fences(self.phase(position_of(z)))
        return (0.5 * momentum_of(z) * momentum_of(z) - low) / (high - low)

    def match_impact(self, robot: SteppingRobot, reset_residual: ResetCorrection = None) -> "Gait":
        """Recompute everything that follows from robot and parameters."""
        return Gait(self.policy.match_impact(robot, reset_residual), self.tube, self.next_tube)

    def trainable(self) -> "Gait":
        """A tree of booleans: True where training may move a leaf."""
        fences = movable(self.tube, lambda t: (t.lower, t.upper) if t.trained else ())
        return Gait(self.policy.trainable(), fences)
