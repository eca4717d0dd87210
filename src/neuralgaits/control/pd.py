"""Joint PD towards the policy's outputs, on top of the model's feed-forward torques."""

from collections.abc import Sequence
from dataclasses import replace

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from typing_extensions import override

from neuralgaits._types import Actuated, ZeroState
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
from neuralgaits.errors import InputError
from neuralgaits.gait.joint_inertia import JointResponse

BANDWIDTH = 45.0
"""w of the default gains where the joints share little [rad/s]."""

SLOWEST = 15.0
"""Frequency that the slowest mode of all joints together shall have [rad/s]. Ten random robots
walked for it; below 7 those fell whose legs have no rotors to speak of and three links."""

MOST = 150.0
"""w that a control period of 1 ms allows: the fastest mode is up to 1.7 times as fast [rad/s]."""


class Pd(AbstractLaw):
    """Torque = feed-forward - stiffness (q_a - y_d) - damping (dq_a - dy_d).

    The feed-forward is the model's torque for the policy's own accelerations. Gains are fitted
    to a robot, stiffness = I w^2 and damping = 2 I w with I of `JointResponse.inertia`, unless they
    are given; w is raised where all joints together would give way too slowly.

    Attributes:
        bandwidth: w of fitted gains [rad/s]; `fitted_bandwidth` if none is given.
        stiffness: position gains by joint, or one for all [N m/rad]; nothing until it is fitted.
        damping: rate gains by joint, or one for all [N m s/rad]; nothing until it is fitted.
        feed_forward: whether the model's torques are added.
        hold_ticks: control ticks between two evaluations of the policy: 500 Hz at 1 kHz.
        measure_z2: False gives the policy z2 = 0, as the paper's experiments did.
    """

    bandwidth: float | None = eqx.field(default=None, static=True)
    stiffness: tuple[float, ...] = eqx.field(default=(), static=True)
    damping: tuple[float, ...] = eqx.field(default=(), static=True)
    feed_forward: bool = eqx.field(default=True, static=True)
    hold_ticks: int = eqx.field(default=2, static=True)
    measure_z2: bool = eqx.field(default=True, static=True)

    def with_gains_for(self, joints: JointResponse) -> "Pd":
        """Return this law with gains for each of a robot's joints."""
        if self.stiffness and self.damping:
            w, stiffness, damping = self.bandwidth, self.stiffness, self.damping
        else:
            w, inertia = self.bandwidth or fitted_bandwidth(joints), joints.inertia
            stiffness, damping = self.stiffness or w * w * inertia, self.damping or 2 * w * inertia
        gains = (_each(stiffness, joints.count), _each(damping, joints.count))
        return replace(self, bandwidth=w, stiffness=gains[0], damping=gains[1])

    @override
    def in_c(self) -> CompiledLaw:
        gains = f"{_gain_text(self.stiffness)} N m/rad, {_gain_text(self.damping)} N m s/rad"
        return CompiledLaw(
            words=f"the model's torques, {gains}" if self.feed_forward else gains,
            stiffness=self.stiffness,
            damping=self.damping,
            model=self.feed_forward,
            measure_z2=self.measure_z2,
        )

    @property
    def takes_joints(self) -> bool:
        """Whether the model's torques are added."""
        return self.feed_forward

    @property
    def uses_impact_consistent_rates(self) -> bool:
        """Whether z2 is measured: desired rates of a touchdown are held beyond it."""
        return self.measure_z2

    def policy_state(self, z: ZeroState) -> ZeroState:
        """All of z, or z1 with z2 = 0. Returns: [2]."""
        return z if self.measure_z2 else z * jnp.array([1.0, 0.0])

    def desired(self, robot: DrivenMechanism, outputs: Outputs, reading: MeasuredState) -> Desired:
        """Desired outputs and rates at the measured z. Returns: `Desired`."""
        if self.feed_forward:
            return accelerated(robot, outputs, reading)
        y, dy = jax.jvp(outputs, (reading.z,), (reading.dz,))
        return Desired(y, dy, jnp.zeros_like(y), jnp.zeros_like(y))

    @override
    def torque(self, robot: DrivenMechanism, reading: MeasuredState, desired: Desired) -> Actuated:
        if not (self.stiffness and self.damping):
            raise InputError(
                "Pd: expected gains, found none: fit them to a robot's joints by `with_gains_for`"
            )
        error, rate = errors(reading, desired)
        torque = -jnp.array(self.stiffness) * error - jnp.array(self.damping) * rate
        if not self.feed_forward:
            return torque
        return torque + inverse_dynamics(robot, reading, desired.slope, desired.drift)


def fitted_bandwidth(joints: JointResponse) -> float:
    """W of the gains that suit a robot. Returns: `BANDWIDTH` to `MOST` [rad/s]."""
    return float(np.clip(SLOWEST / joints.slowest_mode, BANDWIDTH, MOST))


def _each(gains: Sequence[float] | Actuated, count: int) -> tuple[float, ...]:
    return tuple(float(gain) for gain in np.broadcast_to(np.asarray(gains), count))


def _gain_text(gains: tuple[float, ...]) -> str:
    """Return gains by joint, stance leg first; one number if they are alike."""
    every = set(gains)
    return "/".join(f"{gain:.4g}" for gain in (every if len(every) == 1 else gains))


PAPER = Pd(stiffness=(578.0,), damping=(16.2,), feed_forward=False, measure_z2=False)
"""The paper's deployment: its gains, and a policy that gets z2 = 0."""
