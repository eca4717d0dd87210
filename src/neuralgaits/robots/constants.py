"""The constants of a planar biped, derived once from its robot file.

All link angles are *up-angles* in absolute coordinates, counter-clockwise positive: the
angle of the line from a link's lower joint to its upper joint, zero when upright, so a
link of length l spans l * (-sin theta, cos theta). A swing leg hangs from the hip, so its
links enter positions with a minus sign. Forward is +x.

Generalised coordinates q = (stance lowest link, stance joints upwards, stance hip, swing
hip, swing joints downwards); every joint angle is (upper link) - (lower link). Then
theta = T q, and all kinematics are sums of constants times e(theta) = (-sin, cos).

A robot with flat feet is pinned at its stance ankle. Its stance foot is level and no link, so the
first coordinate is the ankle's; its last link is the swing foot, and "foot" below is the ankle.
"""

import equinox as eqx
import numpy as np

from neuralgaits._types import Array, Float
from neuralgaits.robots.feet import FlatFeet
from neuralgaits.robots.layout import MjcfLayout


class BipedConstants(eqx.Module):
    """The numbers of a planar biped with two equal legs, on point feet or on flat ones.

    Every array is a float64 NumPy leaf: the numbers of the robot file, never rounded.

    Attributes:
        link_angles: T, absolute link angles from coordinates, theta = T q. [n, n]
        inertia: link inertias about their centres of mass [kg m^2]. [n]
        coupling: |C|, with C_kl = sum_i m_i conj(a_ik) a_il and a_ik the (complex) coefficient
            of e(theta_k) in the centre of mass of link i; signed where C is real
            [kg m^2]. [n, n]
        coupling_phase: angle added to theta_k - theta_l; None when every centre of mass
            lies on its link's line [rad]. [n, n]
        mass_moment: |b|, first moments: com = sum_k b_k e(theta_k) / mass; signed where real
            [kg m]. [n]
        mass_moment_phase: angle added to theta_k for b; None like coupling_phase. [n]
        armature: reflected rotor inertia on each coordinate, 0 for the first on point feet
            [kg m^2]. [n]
        damping: viscous joint friction on each coordinate [N m s/rad]. [n]
        foot: swing-foot coefficients, p = sum_k foot_k e(theta_k) [m]. [n]
        hip: hip coefficients [m]. [n]
        relabel: R, q+ = R q and rates alike: the legs swap roles. [n, n]
        hip_gradient: c, z1 = c . q is the linearised hip position [m/rad]. [n]
        mass: total mass of all links [kg]; gravity [m/s^2].
        torque_limit, joint_lower, joint_upper: limits of the actuated joints [N m], [rad]. [m]
        friction: sliding friction coefficient of the feet.
        foot_radius: radius of a point foot's sphere, or height of a flat foot's ankle [m].
        name: name of the robot; link_names; joint_names of the n coordinates.
        torso: index of the torso link, or None.
        layout: where the coordinates live in the robot file.
        coupling_across: Im C, where `coupling` is Re C and `coupling_phase` None: of a robot whose
            masses are traced values, see `parameters`; else None [kg m^2]. [n, n]
        moment_across: Im b [kg m]. [n]
        feet: flat feet on ankles with motors; None for point feet.
    """

    link_angles: Float[np.ndarray, "n n"]
    inertia: Float[Array, " n"]
    coupling: Float[Array, "n n"]
    coupling_phase: Float[np.ndarray, "n n"] | None
    mass_moment: Float[Array, " n"]
    mass_moment_phase: Float[np.ndarray, " n"] | None
    armature: Float[Array, " n"]
    damping: Float[np.ndarray, " n"]
    foot: Float[np.ndarray, " n"]
    hip: Float[np.ndarray, " n"]
    relabel: Float[np.ndarray, "n n"]
    hip_gradient: Float[np.ndarray, " n"]
    mass: Float[Array, ""]
    gravity: Float[np.ndarray, ""]
    torque_limit: Float[np.ndarray, " m"]
    joint_lower: Float[np.ndarray, " m"]
    joint_upper: Float[np.ndarray, " m"]
    friction: Float[np.ndarray, ""]
    foot_radius: Float[np.ndarray, ""]
    name: str = eqx.field(static=True)
    link_names: tuple[str, ...] = eqx.field(static=True)
    joint_names: tuple[str, ...] = eqx.field(static=True)
    torso: int | None = eqx.field(static=True)
    layout: MjcfLayout = eqx.field(static=True, repr=False)
    coupling_across: Float[Array, "n n"] | None = None
    moment_across: Float[Array, " n"] | None = None
    feet: FlatFeet | None = None

    @property
    def n(self) -> int:
        """Number of generalised coordinates, which is the number of links."""
        return len(self.link_names)

    @property
    def leg_length(self) -> float:
        """Length of the straight leg from foot, or from the ankle of a flat one, to hip [m]."""
        return float(np.sum(self.hip))
