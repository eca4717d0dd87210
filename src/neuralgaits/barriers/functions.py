"""Physical quantities of one point of the zero dynamics, from which conditions are built.

Every function takes the point data and returns a scalar, or one entry a joint. Bounds are given
by the caller: see `at_least` and `at_most`. No abs, max or clip: two inequalities instead.
"""

import jax.numpy as jnp

from neuralgaits._types import Actuated, Array, Float, Planar, Scalar
from neuralgaits.barriers import quantities
from neuralgaits.errors import SpecError
from neuralgaits.gait import Point
from neuralgaits.robots.dynamics import (
    hip_position,
    hip_velocity,
    swing_foot_velocity,
)

at_least = quantities.AtLeast
at_most = quantities.AtMost
after_reset = quantities.AfterReset
friction_forward = quantities.FrictionForward
friction_backward = quantities.FrictionBackward
impulse_cone_forward = quantities.ImpulseConeForward
impulse_cone_backward = quantities.ImpulseConeBackward
torque_reserve = quantities.TorqueReserve
knee_bend = quantities.KneeBend
foot_above_arc = quantities.FootAboveArc
foot_on_circle = quantities.FootOnCircle
parabolic_clearance = quantities.ParabolicClearance
orbital_energy = quantities.OrbitalEnergy


def torso_angle(p: Point) -> Scalar:
    """Absolute torso angle, positive backwards [rad]."""
    if p.robot.torso is None:
        raise SpecError(f"torso_angle: robot {p.robot.name!r} has no torso; leave it out")
    return p.theta[p.robot.torso]


def joint_angles(p: Point) -> Actuated:
    """Return the angles of the actuated joints [rad]. [m]."""
    return p.q[1:]


def joint_rates(p: Point) -> Actuated:
    """Return the rates of the actuated joints [rad/s]. [m]."""
    return p.dq[1:]


def torques(p: Point) -> Actuated:
    """Joint torques on the zero dynamics [N m]. [m]."""
    return p.torque


def normal_force(p: Point) -> Scalar:
    """Normal ground force on the stance foot [N]."""
    return p.contact_force[1]


def foot_height(p: Point) -> Scalar:
    """Swing-foot height above the line between the step's footholds [m]."""
    return p.foot_above_ground


def foot_forward(p: Point) -> Scalar:
    """Swing-foot position ahead of the stance foot; the step length at impact [m]."""
    return p.foot[0]


def foot_vertical_velocity(p: Point) -> Scalar:
    """Rate of the swing foot's height above the line between the step's footholds [m/s]."""
    return p.foot_lift_rate


def hip_height(p: Point) -> Scalar:
    """Hip height above the stance foot [m]."""
    return hip_position(p.robot, p.q)[1]


def hip_forward(p: Point) -> Scalar:
    """Hip position ahead of the stance foot [m]."""
    return hip_position(p.robot, p.q)[0]


def hip_speed(p: Point) -> Scalar:
    """Forward velocity of the hip [m/s]."""
    return hip_velocity(p.robot, p.q, p.dq)[0]


def forward_rate(p: Point) -> Scalar:
    """Rate of the linearised hip position dz1 [m/s]."""
    return p.dz[0]


def transversal_inertia(p: Point) -> Scalar:
    """-J . s, positive where the zero dynamics are well defined [kg m]."""
    return -p.transversal_inertia


def hip_state(p: Point) -> Scalar:
    """z1 [m], for bounds on z."""
    return p.z[0]


def momentum(p: Point) -> Scalar:
    """z2 [kg m^2/s], for bounds on z."""
    return p.z[1]


def reset_hip_sum(p: Point) -> Scalar:
    """z1 after the reset plus z1 before: 0 for a symmetric step [m]. Paper Table 1."""
    return p.z_after[0] + p.z[0]


def reset_hip(p: Point) -> Scalar:
    """Return z1 after the reset [m]."""
    return p.z_after[0]


def output_mismatch(p: Point) -> Actuated:
    """Outputs after the impact, y+ = R q_a - y_d(Delta(z)) [rad]. [m]. Paper: symmetry."""
    return (p.robot.relabel @ p.q)[1:] - p.after.outputs.y


def squared_mismatch(p: Point) -> Scalar:
    """Minus the squared output mismatch [rad^2]: as a barrier it makes the mismatch decay."""
    error = output_mismatch(p)
    return -(error @ error)


def rate_mismatch(p: Point) -> Actuated:
    """Output rates after the real impact, dq_a+ - dy_d(z+) [rad/s]. [m].

    z1 moves at the real rate c . dq+, not at the rate the re-zeroed outputs would give.
    """
    after, desired = p.impact, p.after.outputs
    dz1 = p.robot.hip_gradient @ after.dq
    dz2 = p.robot.mass * p.robot.gravity * p.robot.centre_of_mass(after.q)[0]
    return after.dq[1:] - desired.d1 * dz1 - desired.d2 * dz2


def state_mismatch(p: Point) -> Float[Array, " two_n"]:
    """Full state after impact minus the zero dynamics state above z+ (rad, rad/s). [2n]."""
    return jnp.concatenate([p.impact.q - p.after.q, p.impact.dq - p.after.dq])


def impulse(p: Point) -> Planar:
    """Impulse on the new stance foot, (tangential, normal) [N s]. [2]."""
    return p.impact.impulse


def normal_impulse(p: Point) -> Scalar:
    """Normal impulse of the impact [N s]."""
    return p.contact_impulse[1]


def old_foot_lift(p: Point) -> Scalar:
    """Velocity of the old stance foot off the ground just after the impact [m/s]."""
    velocity = swing_foot_velocity(p.robot, p.impact.q, p.impact.dq)
    return velocity[1] - p.landing_rise * velocity[0]
