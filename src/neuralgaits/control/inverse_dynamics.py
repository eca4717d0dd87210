"""Model torques that produce the desired accelerations, without a linear solve.

With ddq_a = slope ddz1 + fixed and ddq_1 from c . ddq = ddz1, the unactuated row of the dynamics
is one scalar equation for ddz1; the actuated rows then give the torque. So no decoupling matrix
is inverted. Source: Westervelt et al. (2007), section 5.
"""

import jax
import jax.numpy as jnp

from neuralgaits._types import Actuated, Coordinates, Scalar, ZeroState
from neuralgaits.control.driven_mechanism import DrivenMechanism
from neuralgaits.control.law import Desired, MeasuredState, Outputs
from neuralgaits.gait.policy import OutputJet
from neuralgaits.gait.zero_coordinates import ZeroCoordinates, combined, momentum_of

# Smallest |momentum per unit dz1| that is divided by, in units of mass times leg length. A walk
# stays near 1; below this the robot is falling, in a posture where the momentum no longer
# determines the hip's speed.
SMALLEST_DENOMINATOR = 0.03


def accelerated(robot: DrivenMechanism, outputs: Outputs, reading: MeasuredState) -> Desired:
    """Return desired outputs, rates, and the terms of their accelerations, a `Desired`."""
    z, dz = reading.z, reading.dz
    jet, change = jax.linearize(lambda point: _jet(outputs, point), z)
    ddz2 = robot.momentum_rate_rate(reading.q, reading.dq)
    if reading.ankle_rate is not None:
        ddz2 = ddz2 + reading.ankle_rate
    by_positions, by_momenta = jet.jacobian[:, 0], jet.jacobian[:, 1:]
    drift = change(dz).rate(dz) + combined(by_momenta, ddz2)
    return Desired(jet.y, jet.rate(dz), by_positions, drift)


def impact_consistent_rates(
    robot: DrivenMechanism, outputs: Outputs, reading: MeasuredState
) -> MeasuredState:
    """Return the state with the rates that meet the outputs at this momentum about the foot.

    At a touchdown the measured joint rates, and dz1 with them, are those during an impact, which
    takes some milliseconds more. The impact has no moment about the new foot, so z2 already has
    its final value. It and the outputs' slopes determine the rates after a matched impact.

    Returns: `MeasuredState`, its dq and dz1 replaced.
    """
    slope, by_momentum = _jet(outputs, reading.z).jacobian.T
    momentum_rate, momentum = momentum_of(reading.dz), momentum_of(reading.z)
    dq, dz1 = _balance(robot, reading, slope, by_momentum * momentum_rate, momentum)
    return reading._replace(dq=dq, dz=jnp.stack([dz1, momentum_rate]))


def inverse_dynamics(
    robot: DrivenMechanism, reading: MeasuredState, slope: Actuated, fixed: Actuated
) -> Actuated:
    """Return the joint torques that produce ddq_a = slope ddz1 + fixed.

    The only torque at the foot is an ankle's, if there is one.

    Returns: [m] (N m).
    """
    ddq = consistent_acceleration(robot, reading, slope, fixed)
    balance = robot.mass_matrix(reading.q) @ ddq + robot.bias(reading.q, reading.dq)
    return balance[1:]


def consistent_acceleration(
    robot: DrivenMechanism, reading: MeasuredState, slope: Actuated, fixed: Actuated
) -> Coordinates:
    """Return the acceleration with ddq_a = slope ddz1 + fixed.

    The only torque at the foot is an ankle's, if there is one.

    Returns: [n] (rad/s^2).
    """
    moment = robot.bias(reading.q, reading.dq)[0]
    if reading.ankle is not None:
        # The motor makes up for the joint's own friction.
        moment = moment - robot.damping[0] * reading.dq[0] + reading.ankle
    return _balance(robot, reading, slope, fixed, moment)[0]


def _balance(
    robot: DrivenMechanism, reading: MeasuredState, slope: Actuated, fixed: Actuated, moment: Scalar
) -> tuple[Coordinates, Scalar]:
    """Solve for x, rates or accelerations: x_a = slope x1 + fixed, and row 1 of D x is -moment.

    Returns: x, [n], and x1, the rate or acceleration of z1.
    """
    row = robot.mass_matrix(reading.q)[0]
    coordinates = ZeroCoordinates(robot)
    along = coordinates.along(slope[:, None])[:, 0]
    rest = coordinates.still(fixed)
    denominator = row @ along
    smallest = SMALLEST_DENOMINATOR * robot.moment_scale()
    size = jnp.maximum(jnp.abs(denominator), smallest)
    of_z1 = -(moment + row @ rest) / jnp.where(denominator < 0.0, -size, size)
    return along * of_z1 + rest, of_z1


def _jet(outputs: Outputs, z: ZeroState) -> OutputJet:
    """Desired outputs and their partial derivatives."""
    value, derivative = jax.linearize(outputs, z)
    return OutputJet(value, jnp.stack([derivative(axis) for axis in jnp.eye(len(z))], axis=1))
