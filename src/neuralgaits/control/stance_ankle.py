"""The stance ankle of a robot with flat feet: its torque is an output of the policy, u_a(z)."""

from collections.abc import Callable

import jax
import jax.numpy as jnp

from neuralgaits._types import Actuated, Array, Float, Scalar, ZeroState
from neuralgaits.control.law import MeasuredState
from neuralgaits.control.measurement import of_all_motors
from neuralgaits.robots.feet import FlatFeet
from neuralgaits.robots.layout import MjcfLayout


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


def motors(
    layout: MjcfLayout,
    feet: FlatFeet | None,
    damping: Scalar,
    reading: MeasuredState,
    torque: Actuated,
) -> Float[Array, " motors"]:
    """Return the torques of all motors: that of a stance ankle, and those of the joints (N m).

    Args:
        layout: layout of the robot file.
        feet: flat feet; None for point feet.
        damping: viscous friction of the stance ankle [N m s/rad].
        reading: measured state, with the ankle's torque.
        torque: torques of the actuated joints [N m].
    """
    if feet is None or reading.ankle is None:
        return torque
    limit = feet.torque_limit
    ankle = damping * reading.dq[0] - reading.ankle
    return of_all_motors(layout, torque, jnp.clip(ankle, -limit, limit))
