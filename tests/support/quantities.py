"""Quantities that have settings, by name."""

import numpy as np

from neuralgaits.barriers import functions as f

WITH_SETTINGS = {
    "friction_forward": f.friction_forward(0.4),
    "friction_backward": f.friction_backward(0.4),
    "foot_on_circle": f.foot_on_circle((0.05, -0.65), 0.7),
    "parabolic_clearance": f.parabolic_clearance(0.02, 0.17, 0.001),
    "orbital_energy": f.orbital_energy(0.9, 0.3),
    "impulse_cone_forward": f.impulse_cone_forward(0.5),
    "impulse_cone_backward": f.impulse_cone_backward(0.5),
    "at_least": f.at_least(f.hip_height, 0.7),
    "at_most": f.at_most(f.joint_angles, np.array([1.0, 2.0, 3.0, 4.0])),
    "after_reset": f.after_reset(f.torso_angle),
    "torque_lower": f.torque_reserve("lower", 0.8),
    "torque_upper": f.torque_reserve("upper", 0.8),
    "knee_bend": f.knee_bend((0, 3), (1.0, -1.0), 0.05),
    "foot_above_arc": f.foot_above_arc(0.02),
}
