"""Input-output linearisation: the outputs obey ddy = -w^2 y - 2 w dy on the model's dynamics.

Source: Westervelt et al. (2007), section 5.
"""

from dataclasses import replace

import equinox as eqx
from typing_extensions import override

from neuralgaits._types import Actuated
from neuralgaits.control.driven_mechanism import DrivenMechanism
from neuralgaits.control.inverse_dynamics import accelerated, inverse_dynamics
from neuralgaits.control.law import (
    AbstractLaw,
    CompiledLaw,
    Desired,
    MeasuredState,
    Outputs,
    errors,
)


class Fblin(AbstractLaw):
    """Critically damped outputs on the model's own dynamics.

    Attributes:
        bandwidth: w, the double pole of the output errors [rad/s].
        hold_ticks: control ticks between two evaluations of the policy.
    """

    bandwidth: float = eqx.field(default=30.0, static=True)
    hold_ticks: int = eqx.field(default=1, static=True)

    @override
    def at_bandwidth(self, bandwidth: float) -> "Fblin":
        return replace(self, bandwidth=bandwidth)

    @override
    def in_c(self) -> CompiledLaw:
        words = f"input-output linearisation, {self.bandwidth:g} rad/s"
        return CompiledLaw(words, model=True, bandwidth=self.bandwidth)

    @property
    def takes_joints(self) -> bool:
        """Whether joint friction may be added: yes, its torques are the model's."""
        return True

    def desired(self, robot: DrivenMechanism, outputs: Outputs, reading: MeasuredState) -> Desired:
        """Return desired outputs, rates, and the terms of their accelerations, a `Desired`."""
        return accelerated(robot, outputs, reading)

    @override
    def torque(self, robot: DrivenMechanism, reading: MeasuredState, desired: Desired) -> Actuated:
        error, rate = errors(reading, desired)
        pull = -(self.bandwidth**2) * error - 2.0 * self.bandwidth * rate
        return inverse_dynamics(robot, reading, desired.slope, desired.drift + pull)
