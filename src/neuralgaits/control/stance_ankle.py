"""The stance ankle of a robot with flat feet: its torque is an output of the policy, u_a(z)."""

from collections.abc import Callable

import jax
import jax.numpy as jnp

from neuralgaits._types import Actuated, Array, Float, Scalar, ZeroState
from neuralgaits.control.law import MeasuredState
from neuralgaits.control.measurement import of_all_motors
from neuralgaits.robots import PlanarBiped


def read(reading: MeasuredState, torque: Callable[[ZeroState], Scalar | None]) -> MeasuredState:
    """Return a reading with the ankle's torque, and with what it adds to the rate of z2.

    Args:
        reading: measured state, with the rate of z on a point foot.
        torque: the policy's torque of the ankle, positive forward, as a function of z [N m].
    """

    def ankle(z: ZeroState) -> Scalar:
        ankle_torque = torque(z)
        return jnp.zeros(()) if ankle_torque is None else ankle_torque

    dz = reading.dz + jnp.stack([jnp.zeros(()), ankle(reading.z)])
    now, rate = jax.jvp(ankle, (reading.z,), (dz,))
    return reading._replace(dz=dz, ankle=now, ankle_rate=rate)


def motors(robot: PlanarBiped, reading: MeasuredState, torque: Actuated) -> Float[Array, " motors"]:
    """Return the torques of all motors: that of a stance ankle, and those of the joints (N m)."""
    if reading.ankle is None:
        return torque
    ankle = robot.damping[0] * reading.dq[0] - reading.ankle
    limit = robot.flat_feet.torque_limit
    return of_all_motors(robot.layout, torque, jnp.clip(ankle, -limit, limit))
