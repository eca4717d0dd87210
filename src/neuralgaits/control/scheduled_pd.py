"""Gain-scheduled PD: torque and gains of all joints together, as functions of phase and level.

The torque is that of `gait.scheduled_gains`: near the gait the outputs decay as under exact
linearisation, and no mass matrix is evaluated.
"""

from dataclasses import replace

import equinox as eqx
import jax
import jax.numpy as jnp
from typing_extensions import override

from neuralgaits._types import Actuated, Array, Float, ZeroState
from neuralgaits.control.driven_mechanism import DrivenMechanism
from neuralgaits.control.law import (
    AbstractLaw,
    CompiledLaw,
    Desired,
    MeasuredState,
    Outputs,
    errors,
)
from neuralgaits.control.saturation import levelled_off
from neuralgaits.errors import InputError, SpecError
from neuralgaits.gait.gaits import Gait
from neuralgaits.gait.joint_inertia import JointResponse
from neuralgaits.gait.policies.commanded_gait import AnyGait
from neuralgaits.gait.scheduled_gains import MARGIN, GainErrors, ScheduledGains
from neuralgaits.gait.zero_coordinates import momentum_of, position_of

LARGEST_ERROR = 0.5
"""Largest error of the inertia: at 1 the feedback might push a joint the wrong way."""


class GainSchedule(eqx.Module):
    """Gains of a gait, and the phase and level that they are functions of.

    Attributes:
        gains: the fitted polynomials.
        gait: policy and tube, which define phase and level.
        errors: errors of the polynomials at sampled states of the tube.
    """

    gains: ScheduledGains
    gait: Gait
    errors: GainErrors = eqx.field(static=True)

    def chart(self, z: ZeroState) -> Float[Array, "2"]:
        """Return (phase, level) of a state, unchanged to half the margin around the tube.

        Beyond it both level off inside the margin, where the polynomials still are fitted.
        """
        phase = _near(self.gait.phase(position_of(z)), 0)
        low, high = self.gait.tube.fences(phase)
        energy = 0.5 * momentum_of(z) * momentum_of(z)
        return jnp.stack([phase, _near((energy - low) / (high - low), 1)])


class ScheduledPd(AbstractLaw):
    """Torque = u0 - M (w^2 y + 2 w dy), with u0 and M of the phase and level of the state.

    Attributes:
        bandwidth: w, the double pole of small output errors [rad/s].
        hold_ticks: control ticks between two evaluations of the policy.
        predicts_rates: whether at a touchdown it goes by `impact_consistent_rates`, as `Pd` does.
            The torque is then not this function of the measured state for one tick a step.
        schedule: gains of a gait; None until the law is fitted to one.
    """

    bandwidth: float = eqx.field(default=40.0, static=True)
    hold_ticks: int = eqx.field(default=1, static=True)
    predicts_rates: bool = eqx.field(default=False, static=True)
    schedule: GainSchedule | None = None

    def for_gait(self, joints: JointResponse, gait: AnyGait) -> "ScheduledPd":
        """Return this law with gains fitted to a gait, unless it has some.

        Raises: SpecError for a gait that takes commands, or that the polynomials do not fit.
        """
        if self.schedule is not None:
            return self
        if not isinstance(gait, Gait):
            raise SpecError(
                "scheduled-pd: expected a gait without commands, whose gains are functions of "
                "phase and level, found one with commands: use pd or fblin"
            )
        gains = ScheduledGains.of(joints.robot, gait)
        errors = GainErrors.of(joints.robot, gait, gains)
        if not errors.inertia <= LARGEST_ERROR:
            raise SpecError(
                f"scheduled-pd: expected gains within {LARGEST_ERROR:g} of the model's, found an "
                f"error of {errors.inertia:.2g} in the tube: use pd or fblin"
            )
        return replace(self, schedule=GainSchedule(gains, gait, errors))

    @override
    def at_bandwidth(self, bandwidth: float) -> "ScheduledPd":
        return replace(self, bandwidth=bandwidth)

    def in_c(self) -> CompiledLaw:
        """Return the law as compiled code has it; without a schedule before it is fitted."""
        words = f"gains of phase and level, {self.bandwidth:g} rad/s"
        if self.schedule is not None:
            lost = self.schedule.errors
            words += f", sampled errors {lost.torque:.2g} N m and {lost.inertia:.2g}"
        return CompiledLaw(words, bandwidth=self.bandwidth, schedule=self.schedule)

    @property
    def takes_joints(self) -> bool:
        """Whether joint friction may be added: yes, its torques are the model's."""
        return True

    @property
    def uses_impact_consistent_rates(self) -> bool:
        """Whether it starts a step from predicted rates instead of measured ones."""
        return self.predicts_rates

    def desired(self, robot: DrivenMechanism, outputs: Outputs, reading: MeasuredState) -> Desired:
        """Return desired outputs and rates; accelerations are in the feed-forward torque."""
        y, dy = jax.jvp(outputs, (reading.z,), (reading.dz,))
        return Desired(y, dy, jnp.zeros_like(y), jnp.zeros_like(y))

    @override
    def torque(self, robot: DrivenMechanism, reading: MeasuredState, desired: Desired) -> Actuated:
        if self.schedule is None:
            raise InputError(
                "ScheduledPd: expected gains, found none: fit them to a gait by `for_gait`"
            )
        error, rate = errors(reading, desired)
        pull = self.bandwidth**2 * error + 2.0 * self.bandwidth * rate
        gains, chart = self.schedule.gains, self.schedule.chart(reading.z)
        return gains.torque_at(chart) - gains.inertia_at(chart) @ pull


def _near(value: Array, axis: int) -> Array:
    """Keep a phase (axis 0) or a level (axis 1) within the margin around 0 to 1, smoothly."""
    half = 0.5 * float(MARGIN[axis])
    return levelled_off(value, -half, 1.0 + half, half)
