"""Map a plant's arrays to a controller's quantities: sensors in, controls out.

Written for one episode, with the plant's addresses as constants, so it runs inside the tick.
"""

import jax.numpy as jnp
import numpy as np

from neuralgaits._types import Array, Float, Planar, Scalar
from neuralgaits.control.measurement import Measurement
from neuralgaits.robots.mjcf_state import Sensors, StateMap


def measure(
    sensors: Sensors, arm_slope: Planar, time: Scalar, normal: Float[Array, "2"]
) -> Measurement:
    """Return the measurements of a robot's sensors. Returns: `Measurement`.

    Args:
        sensors: sensors of the plant's state, without batch axes.
        arm_slope: derivative of the root-to-hip vector by pitch, from `MjcfLayout.hip_arm` (m). [2]
        time: time of the reading (s).
        normal: normal force on each foot (N).
    """
    return Measurement(
        time=time,
        pitch=sensors.pitch,
        dpitch=sensors.dpitch,
        angles=sensors.joints,
        rates=sensors.djoints,
        hip_velocity=sensors.base_velocity + sensors.dpitch * arm_slope,
        normal_force=normal,
    )


def controls(state_map: StateMap, torque: Float[Array, "2 k"]) -> Float[Array, " u"]:
    """Return actuator controls that put these torques on the joints. Returns: [nu]."""
    empty = jnp.zeros(state_map.nu, dtype=torque.dtype)
    return empty.at[state_map.actuators].set(torque / np.array(state_map.layout.gears))
