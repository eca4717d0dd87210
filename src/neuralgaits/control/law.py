"""Interface of a control law: from the policy's desired outputs to joint torques."""

from abc import abstractmethod
from collections.abc import Callable
from typing import Any, NamedTuple

import equinox as eqx
import jax.numpy as jnp

from neuralgaits._types import Actuated, Array, Bool, Coordinates, Scalar, ZeroState
from neuralgaits.control.driven_mechanism import DrivenMechanism
from neuralgaits.control.saturation import saturate
from neuralgaits.gait.joint_inertia import JointResponse
from neuralgaits.gait.policies.commanded_gait import AnyGait


class MeasuredState(NamedTuple):
    """The measured state in the coordinates of the current stance leg."""

    q: Coordinates
    """Coordinates [rad]. [n]"""
    dq: Coordinates
    """Rates [rad/s]. [n]"""
    z: ZeroState
    """Zero dynamics state (m, kg m^2/s). [2]"""
    dz: ZeroState
    """Rate of z (m/s, N m). [2]"""
    ankle: Scalar | None = None
    """Torque of the stance ankle, positive forward [N m]; None without one."""
    ankle_rate: Scalar | None = None
    """Rate of that torque along dz [N m/s]; None without one."""


Outputs = Callable[[ZeroState], Actuated]
"""Desired outputs, m angles (rad), as a function of z: a policy and what its law lets it see."""


class Desired(NamedTuple):
    """Desired outputs and their derivatives, held between two evaluations of the policy.

    [m] is the shape, one number for each actuated joint.
    """

    y: Actuated
    """Desired outputs [rad]. [m]"""
    dy: Actuated
    """Desired output rates [rad/s]. [m]"""
    slope: Actuated
    """d y_d / d z1 [rad/m]; zero from laws that use no accelerations. [m]"""
    drift: Actuated
    """Desired accelerations at ddz1 = 0 [rad/s^2]; zero from laws that use no accelerations. [m]"""


class Demand(NamedTuple):
    """Torques that a law asks for, before limits, and what it made them of."""

    reading: MeasuredState
    desired: Desired
    torque: Actuated
    """Torques before limits [N m]. [m]"""
    limit: Actuated
    """Torque limit of every motor [N m]. [m]"""


class LimitedTorque(NamedTuple):
    """Torques within the limits, and which limits were active."""

    torque: Actuated
    """Torques within the limits [N m]. [m]"""
    saturated: Bool[Array, ""]
    """Whether any was clipped, or is at its limit."""
    relaxed: Bool[Array, "2"]
    """Whether outputs converge more slowly than the law requires, and whether it requires forces
    that the floor cannot give; always False for laws that check neither."""


class CompiledLaw(NamedTuple):
    """A law as `ng_law` of `export/c/controller.h` computes it."""

    words: str
    """Gains in words, for the comment at the top of an export."""
    stiffness: tuple[float, ...] = ()
    """Position gains by joint [N m/rad]; empty if the law has none. [m]"""
    damping: tuple[float, ...] = ()
    """Rate gains by joint [N m s/rad]; empty if the law has none. [m]"""
    model: bool = False
    """Whether the model's torques for the policy's accelerations are added."""
    bandwidth: float = 0.0
    """w of model or schedule [rad/s]."""
    measure_z2: bool = True
    """Whether the policy gets the measured z2."""
    schedule: Any = None
    """A `GainSchedule` (`control/gain_schedule.py`) in the model's place."""
    exported: bool = True
    """Whether exported controllers have it, too, and not compiled walks alone."""


class AbstractLaw(eqx.Module):
    """A law without memory of its own: everything it holds is a `Desired`."""

    hold_ticks: eqx.AbstractVar[int]
    """Control ticks between two evaluations of the policy."""

    def with_gains_for(self, joints: JointResponse) -> "AbstractLaw":
        """Return the law with gains that suit the joints' inertias, if it has gains."""
        return self

    def for_gait(self, joints: JointResponse, gait: AnyGait) -> "AbstractLaw":
        """Return the law with what it keeps of a gait, if it keeps anything.

        Args:
            joints: joints of the robot that torques are for.
            gait: policy and tube.

        Raises: SpecError for a gait that the law cannot have.
        """
        del joints, gait
        return self

    def in_c(self) -> CompiledLaw | None:
        """Return the law as compiled code has it; None for a law in JAX alone.

        A class that inherits it walks in JAX alone, too: its torques may be others.
        """
        return None

    def at_bandwidth(self, bandwidth: float) -> "AbstractLaw | None":
        """Return the law with another w, the double pole of small output errors.

        Args:
            bandwidth: w [rad/s].

        Returns: the law; None for one without such a pole.
        """
        del bandwidth
        return None

    @property
    def takes_joints(self) -> bool:
        """Whether torques that make up for friction of identified joints may be added to its own.

        So it is where they are the model's for desired accelerations.
        """
        return False

    @property
    def uses_impact_consistent_rates(self) -> bool:
        """Whether at a touchdown it goes by `impact_consistent_rates`, not by those measured."""
        return False

    def policy_state(self, z: ZeroState) -> ZeroState:
        """Return z as the policy gets it, from the measured and bounded z: all of it. [2]."""
        return z

    @abstractmethod
    def desired(self, robot: DrivenMechanism, outputs: Outputs, reading: MeasuredState) -> Desired:
        """Evaluate the policy at a reading. Returns: `Desired`."""

    @abstractmethod
    def torque(self, robot: DrivenMechanism, reading: MeasuredState, desired: Desired) -> Actuated:
        """Joint torques before saturation. Returns: [m] (N m)."""

    def apply_limits(self, robot: DrivenMechanism, demand: Demand) -> LimitedTorque:
        """Clip the torques that the law asks for. Returns: `LimitedTorque`."""
        clipped, saturated = saturate(demand.torque, demand.limit)
        return LimitedTorque(clipped, saturated, jnp.zeros(2, bool))


def compiled_law(law: AbstractLaw) -> CompiledLaw | None:
    """Return a law as compiled code has it; None for a subclass, whose torques may be others."""
    return law.in_c() if "in_c" in vars(type(law)) else None


def errors(reading: MeasuredState, desired: Desired) -> tuple[Actuated, Actuated]:
    """Output errors y = q_a - y_d and their rates. Returns: [m] (rad), [m] (rad/s)."""
    return reading.q[1:] - desired.y, reading.dq[1:] - desired.dy
