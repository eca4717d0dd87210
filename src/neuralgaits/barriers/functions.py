"""Physical quantities of one point of the zero dynamics, from which conditions are built.

Every function takes the point data and returns a scalar, or one entry a joint. Bounds are given
by the caller: see `at_least` and `at_most`. No abs, max or clip: two inequalities instead.
"""

import jax.numpy as jnp

from neuralgaits._types import Actuated, Array, Float, Planar, Scalar
from neuralgaits.barriers import feet_quantities, quantities
from neuralgaits.barriers.quantity_words import quantity
from neuralgaits.errors import SpecError
from neuralgaits.gait import Point
from neuralgaits.gait.zero_coordinates import momentum_of, position_of

# Those with numbers of their own are classes in `quantities.py` and `feet_quantities.py`.
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
ankle_reserve = feet_quantities.AnkleReserve
pressure_reserve = feet_quantities.PressureReserve
impulse_reserve = feet_quantities.ImpulseReserve
sole_above_arc = feet_quantities.SoleAboveArc
sole_vertical_velocity = feet_quantities.sole_vertical_velocity
old_sole_lift = feet_quantities.old_sole_lift
stance_ankle = feet_quantities.stance_ankle


@quantity("lean of the torso, backwards positive", "rad", gist="an upright torso")
def torso_angle(p: Point) -> Scalar:
    """Absolute torso angle, positive backwards [rad]."""
    if p.robot.torso is None:
        raise SpecError(f"torso_angle: robot {p.robot.name!r} has no torso; leave it out")
    return p.theta[p.robot.torso]


@quantity("angle of every joint", "rad")
def joint_angles(p: Point) -> Actuated:
    """Return the angles of the actuated joints [rad]. [m]."""
    return p.q[1:]


@quantity("rate of every joint", "rad/s", gist="joints that are not too fast")
def joint_rates(p: Point) -> Actuated:
    """Return the rates of the actuated joints [rad/s]. [m]."""
    return p.dq[1:]


@quantity("torque of every joint", "N m")
def torques(p: Point) -> Actuated:
    """Joint torques on the zero dynamics [N m]. [m]."""
    return p.torque


@quantity("force of the ground under the standing foot", "N", gist="ground that only pushes")
def normal_force(p: Point) -> Scalar:
    """Normal ground force on the stance foot [N]."""
    return p.contact_force[1]


@quantity("height of the swinging foot", "m")
def foot_height(p: Point) -> Scalar:
    """Swing-foot height above the line between the step's footholds [m]."""
    return p.foot_above_ground


@quantity("swinging foot ahead of the standing one", "m", gist="steps that are long enough")
def foot_forward(p: Point) -> Scalar:
    """Swing-foot position ahead of the stance foot; the step length at impact [m]."""
    return p.foot[0]


@quantity("vertical velocity of the swinging foot", "m/s")
def foot_vertical_velocity(p: Point) -> Scalar:
    """Rate of the swing foot's height above the line between the step's footholds [m/s]."""
    return p.foot_lift_rate


@quantity("height of the hip", "m")
def hip_height(p: Point) -> Scalar:
    """Hip height above the stance foot [m]."""
    return p.robot.hip_position(p.q)[1]


@quantity("hip ahead of the standing foot", "m")
def hip_forward(p: Point) -> Scalar:
    """Hip position ahead of the stance foot [m]."""
    return p.robot.hip_position(p.q)[0]


@quantity("forward speed of the hip", "m/s")
def hip_speed(p: Point) -> Scalar:
    """Forward velocity of the hip [m/s]."""
    return p.robot.hip_velocity(p.q, p.dq)[0]


@quantity("forward speed of the hip, linearised", "m/s", gist="a hip that always moves forward")
def forward_rate(p: Point) -> Scalar:
    """Rate of the linearised hip position dz1 [m/s]."""
    return position_of(p.dz)


@quantity("transversal inertia", "kg m")
def transversal_inertia(p: Point) -> Scalar:
    """-J . s, positive where the zero dynamics are well defined [kg m]."""
    return -p.transversal_inertia


@quantity("z1", "m")
def hip_state(p: Point) -> Scalar:
    """z1 [m], for bounds on z."""
    return position_of(p.z)


@quantity("z2", "kg m²/s")
def momentum(p: Point) -> Scalar:
    """z2 [kg m^2/s], for bounds on z."""
    return momentum_of(p.z)


@quantity("z1 after touchdown plus z1 before", "m")
def reset_hip_sum(p: Point) -> Scalar:
    """z1 after the reset plus z1 before: 0 for a symmetric step [m]. Paper Table 1."""
    return position_of(p.z_after) + position_of(p.z)


@quantity("z1 after touchdown", "m")
def reset_hip(p: Point) -> Scalar:
    """Return z1 after the reset [m]."""
    return position_of(p.z_after)


@quantity(
    "how far joints are off just after touchdown",
    "rad",
    gist="joints that match across a touchdown",
)
def output_mismatch(p: Point) -> Actuated:
    """Outputs after the impact, y+ = R q_a - y_d(Delta(z)) [rad]. [m]. Paper: symmetry."""
    return (p.robot.relabel @ p.q)[1:] - p.after.outputs.y


@quantity(
    "minus the squared joint error after touchdown",
    "rad²",
    gist="joints that match across a touchdown",
)
def squared_mismatch(p: Point) -> Scalar:
    """Minus the squared output mismatch [rad^2]: as a barrier it makes the mismatch decay."""
    error = output_mismatch(p)
    return -(error @ error)


@quantity("how far joint rates are off just after touchdown", "rad/s")
def rate_mismatch(p: Point) -> Actuated:
    """Output rates after the real impact, dq_a+ - dy_d(z+) [rad/s]. [m].

    z moves at its real rate, not at the rate that the re-zeroed outputs would give.
    """
    after, desired = p.impact, p.after.outputs
    return desired.rate_errors(after.dq[1:], p.coordinates.rate(after.q, after.dq))


@quantity("how far the whole state is off after touchdown", "rad, rad/s")
def state_mismatch(p: Point) -> Float[Array, " two_n"]:
    """Full state after impact minus the zero dynamics state above z+ (rad, rad/s). [2n]."""
    return jnp.concatenate([p.impact.q - p.after.q, p.impact.dq - p.after.dq])


@quantity("impulse of the impact", "N s")
def impulse(p: Point) -> Planar:
    """Impulse on the new stance foot, (tangential, normal) [N s]. [2]."""
    return p.impact.impulse


@quantity("upward impulse of the impact", "N s")
def normal_impulse(p: Point) -> Scalar:
    """Normal impulse of the impact [N s]."""
    return p.contact_impulse[1]


@quantity("upward velocity of the old standing foot after touchdown", "m/s")
def old_foot_lift(p: Point) -> Scalar:
    """Velocity of the old stance foot off the ground just after the impact [m/s]."""
    velocity = p.robot.swing_foot_velocity(p.impact.q, p.impact.dq)
    return velocity[1] - p.landing_rise * velocity[0]
