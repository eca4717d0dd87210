"""Torques of the model that makes desired accelerations, with no linear solve.

With ddq_a = slope ddz1 + known and ddq_1 from c . ddq = ddz1, the unactuated row of the dynamics
is one scalar equation for ddz1; the actuated rows then give the torque. Source:
Westervelt et al. (2007), section 5.
"""

import jax
import jax.numpy as jnp

from neuralgaits._types import Actuated, Coordinates, Scalar, ZeroState
from neuralgaits.control.law import Desired, MeasuredState, Outputs
from neuralgaits.gait.coordinates import lift
from neuralgaits.robots import PlanarBiped
from neuralgaits.robots.dynamics import centre_of_mass_velocity

# Smallest |momentum per unit ddz1| that is divided by, in units of mass times leg length. A walk
# stays near 1; below this the robot falls in a posture where hip and momentum part company.
SMALLEST_DENOMINATOR = 0.03


def accelerated(robot: PlanarBiped, outputs: Outputs, reading: MeasuredState) -> Desired:
    """Return desired outputs, rates, and the terms of their accelerations, a `Desired`."""
    z, dz = reading.z, reading.dz
    (y, d1, d2), change = jax.linearize(lambda point: _with_slopes(outputs, point), z)
    _, d1_rate, d2_rate = change(dz)
    curvature = d1_rate * dz[0] + d2_rate * dz[1]
    speed = centre_of_mass_velocity(robot, reading.q, reading.dq)[0]
    ddz2 = robot.mass * robot.gravity * speed
    drift = curvature + d2 * ddz2
    return Desired(y, d1 * dz[0] + d2 * dz[1], d1, drift)


def impact_consistent_rates(
    robot: PlanarBiped, outputs: Outputs, reading: MeasuredState
) -> MeasuredState:
    """The state with the rates that meet the outputs at this momentum about the foot.

    At a touchdown joint rates, and dz1 with them, are those of an impact that is under way for
    some milliseconds yet. It has no moment about the new foot, so z2 already has its final value,
    and with the outputs' slopes it fixes the rates that a matched impact leaves.

    Returns: `MeasuredState`, its dq and dz1 replaced.
    """
    _, d1, d2 = _with_slopes(outputs, reading.z)
    dq, dz1 = _balanced(robot, reading, d1, d2 * reading.dz[1], reading.z[1])
    return reading._replace(dq=dq, dz=jnp.stack([dz1, reading.dz[1]]))


def inverse_dynamics(
    robot: PlanarBiped, reading: MeasuredState, slope: Actuated, known: Actuated
) -> Actuated:
    """Joint torques of ddq_a = slope ddz1 + known, without torque at the foot.

    Returns: [m] (N m).
    """
    ddq = consistent_acceleration(robot, reading, slope, known)
    balance = robot.mass_matrix(reading.q) @ ddq + robot.bias(reading.q, reading.dq)
    return balance[1:]


def consistent_acceleration(
    robot: PlanarBiped, reading: MeasuredState, slope: Actuated, known: Actuated
) -> Coordinates:
    """The acceleration with ddq_a = slope ddz1 + known that needs no torque at the foot.

    Returns: [n] (rad/s^2).
    """
    moment = robot.bias(reading.q, reading.dq)[0]
    return _balanced(robot, reading, slope, known, moment)[0]


def _balanced(
    robot: PlanarBiped, reading: MeasuredState, slope: Actuated, known: Actuated, moment: Scalar
) -> tuple[Coordinates, Scalar]:
    """Rates or accelerations x, x_a = slope x1 + known, with D x about the foot of -moment.

    Returns: x, [n], and x1, that of z1.
    """
    row = robot.mass_matrix(reading.q)[0]
    along = lift(robot, jnp.ones(()), slope)
    rest = lift(robot, jnp.zeros(()), known)
    denominator = row @ along
    smallest = SMALLEST_DENOMINATOR * robot.mass * jnp.sum(robot.hip)
    size = jnp.maximum(jnp.abs(denominator), smallest)
    of_z1 = -(moment + row @ rest) / jnp.where(denominator < 0.0, -size, size)
    return along * of_z1 + rest, of_z1


def _with_slopes(outputs: Outputs, z: ZeroState) -> tuple[Actuated, Actuated, Actuated]:
    """Desired outputs and both partial derivatives."""
    y, push = jax.linearize(outputs, z)
    along_z1, along_z2 = jnp.eye(2)
    return y, push(along_z1), push(along_z2)
