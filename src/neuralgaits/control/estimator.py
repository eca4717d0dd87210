"""Estimates of rates and of the hip's velocity, from joint angles, pitch and contact.

Joint rates come from a fading-memory filter of second degree on each joint angle (g-h-k filter,
all poles alike; Brookner 1998, Tracking and Kalman Filtering Made Easy, section 5.6.2), which has
no lag at constant acceleration. No motor acts on the stance leg's absolute angle: its rate follows
from the angular momentum about the place where the stance foot touches, whose own rate is the
moment of the weight, and the pitch only corrects the two (critically damped g-h filter). That
momentum is known across a touchdown, since a contact's impulse has no moment about itself; joint
rates jump there, so their filters are quicker for a few ticks.
"""

from typing import NamedTuple

import jax
import jax.numpy as jnp

from neuralgaits._types import Actuated, Array, Bool, Coordinates, Float, Planar, Scalar
from neuralgaits.control.estimator_poles import Estimator
from neuralgaits.control.measurement import (
    Measurement,
    SensedRobot,
    coordinates,
    pitch_rate,
    rolling_velocity,
    stance_joints,
    standing_hip_velocity,
)
from neuralgaits.control.momentum import momentum_about_contact
from neuralgaits.control.touchdown import StanceState


class EstimatorState(NamedTuple):
    """State that an estimator keeps from tick to tick."""

    estimate: Measurement
    """Estimate after the last reading."""
    accelerations: Float[Array, "2 k"]
    """Accelerations of the joints per leg [rad/s^2]."""
    started: Bool[Array, ""]
    """Whether there has been a reading."""


def start(robot: SensedRobot) -> EstimatorState:
    """Return the state before the first reading."""
    zero, joints = jnp.zeros(()), jnp.zeros((2, robot.n // 2))
    at_rest = Measurement(
        time=zero,
        pitch=zero,
        dpitch=zero,
        angles=joints,
        rates=joints,
        hip_velocity=jnp.zeros(2),
        normal_force=jnp.zeros(2),
    )
    return EstimatorState(at_rest, joints, jnp.zeros((), bool))


def estimate(
    estimator: Estimator,
    robot: SensedRobot,
    state: EstimatorState,
    reading: Measurement,
    standing: StanceState,
    period_s: float,
    ankle: Scalar | None = None,
) -> EstimatorState:
    """Update with a reading: all of the first one, then time, pitch, angles and force.

    A robot at rest has first rates of zero; a simulation that starts in mid-step gives its own.

    Args:
        estimator: poles of the filters.
        robot: the model.
        state: before.
        reading: reading of the sensors.
        standing: stance leg, and time since touchdown, before this tick.
        period_s: time between two readings (s).
        ankle: torque of a stance ankle since the last reading (N m); None on point feet.

    Returns: the new state; the controller uses its `estimate`.
    """
    last, leg = state.estimate, standing.leg
    # About the foot that stands now: what the old stance leg had before an impact, if it has
    # changed, and otherwise the momentum as it was left.
    q, dq = coordinates(robot, last, leg)
    momentum, momentum_rate = contact_momentum(robot, q, dq, last.hip_velocity)
    if ankle is not None:
        momentum_rate = momentum_rate + ankle
    usual, quick = estimator.joint_gains(period_s)
    gains = jnp.where(standing.since_touchdown < estimator.quick_s, quick, usual)
    rates = last.rates + period_s * state.accelerations
    angles = last.angles + period_s * (last.rates + 0.5 * period_s * state.accelerations)
    error = reading.angles - angles
    pitch = last.pitch + period_s * last.dpitch
    pitch_error = reading.pitch - pitch
    angle_gain, rate_gain = estimator.pitch_gains(period_s)
    now = reading._replace(
        pitch=pitch + angle_gain * pitch_error,
        angles=angles + gains[0] * error,
        rates=rates + gains[1] * error,
    )
    q, _ = coordinates(robot, now, leg)
    actuated = stance_joints(robot.layout, now.rates, leg)
    momentum = momentum + period_s * momentum_rate
    dq, hip = standing_rates(robot, q, actuated, momentum, rate_gain * pitch_error)
    now = now._replace(dpitch=pitch_rate(robot, dq, leg), hip_velocity=hip)
    after = EstimatorState(now, state.accelerations + gains[2] * error, jnp.ones((), bool))
    first = EstimatorState(reading, jnp.zeros_like(state.accelerations), jnp.ones((), bool))
    return jax.tree.map(lambda new, old: jnp.where(state.started, new, old), after, first)


def contact_momentum(
    robot: SensedRobot, q: Coordinates, dq: Coordinates, hip_velocity: Planar
) -> tuple[Scalar, Scalar]:
    """Compute the momentum about a stance foot's contact, and the moment of the weight about it.

    Args:
        robot: the model.
        q: coordinates (rad). [n]
        dq: their rates (rad/s). [n]
        hip_velocity: velocity of the hip in the world (m/s). [2]

    Returns: momentum (kg m^2/s), its rate (N m).
    """
    foot_velocity = hip_velocity - robot.hip_velocity(q, dq)
    momentum = momentum_about_contact(robot, q, dq, foot_velocity)
    return momentum, robot.momentum_rate(q)[0]


def standing_rates(
    robot: SensedRobot, q: Coordinates, actuated: Actuated, momentum: Scalar, extra: Scalar
) -> tuple[Coordinates, Planar]:
    """Compute the rates of a robot from its momentum while its stance foot does not slip.

    Args:
        robot: the model.
        q: coordinates [n] (rad).
        actuated: rates of the actuated joints [m] (rad/s).
        momentum: angular momentum about the stance foot's contact (kg m^2/s).
        extra: added to the rate of the first coordinate (rad/s).

    Returns: dq [n] (rad/s), and the hip's velocity [2] (m/s).
    """

    def momentum_at(dq: Coordinates) -> Scalar:
        centre = jnp.stack([rolling_velocity(robot, dq), jnp.zeros(())])
        return momentum_about_contact(robot, q, dq, centre)

    axes = jnp.eye(robot.n)
    others = jnp.concatenate([jnp.zeros(1), actuated])
    # Linear in dq.
    first = (momentum - momentum_at(others)) / momentum_at(axes[0]) + extra
    dq = others + first * axes[0]
    return dq, standing_hip_velocity(robot, q, dq)
