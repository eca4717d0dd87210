"""Control laws of the biped: PD with the gait's own torques, and exact linearisation.

Both take the state of the zero dynamics as it is measured: positions from the joints, momenta from
the velocities of all links, the torso's included, which a touchdown does not make jump. States are
those of a robot on its right foot; `spatial_plant` reflects them.
"""

from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from neuralgaits._types import Array, Float
from neuralgaits.systems.walker3d.spatial_dynamics import SpatialState, flow, loads
from neuralgaits.systems.walker3d.spatial_motion import (
    UP,
    LinkMotion,
    angular_momentum,
    generalised,
    jacobians_of,
    mass_matrix,
    motion_of_rates,
)
from neuralgaits.systems.walker3d.spatial_policy import SpatialPolicy
from neuralgaits.systems.walker3d.spatial_pose import (
    joints_of_pose,
    links_of,
    pose_of_joints,
    pose_of_outputs,
    turns_of_pose,
)
from neuralgaits.systems.walker3d.spatial_walker import SpatialWalker

STIFFNESS = 45.0
"""Rate of the joints' errors under both laws [1/s]."""
DAMPING = 1.0
"""Damping ratio of the joints' errors under both laws."""
PdGains = tuple[Float[np.ndarray, "6"], Float[np.ndarray, "6"]]
"""Stiffness [N m/rad] and damping [N m s/rad] of the six joints, stance leg first."""


class Measured(NamedTuple):
    """Readings of the sensors of a robot on its right foot.

    Attributes:
        joints, rates: angles and rates in the order of `JOINTS` [rad], [rad/s]. [8], [8]
        velocity: velocity of the middle of the hips [m/s]. [3]
    """

    joints: Float[Array, "8"]
    rates: Float[Array, "8"]
    velocity: Float[Array, "3"]


class TorqueDemand(NamedTuple):
    """Torques that a law asks of the motors, and where the robot is.

    Attributes:
        torques: stance leg first [N m]. [6]
        errors: errors of the six joints [rad]. [6]
        z: state of the zero dynamics. [4]
        swing: height of the swing foot above the stance foot [m].
    """

    torques: Float[Array, "6"]
    errors: Float[Array, "6"]
    z: SpatialState
    swing: Float[Array, ""]


def desired_joints(
    robot: SpatialWalker, policy: SpatialPolicy, z: SpatialState
) -> Float[Array, "8"]:
    """Return the joint angles of a state under exact outputs, late ones included [rad]."""
    return joints_of_pose(robot, pose_of_outputs(robot, z[:2], policy.beyond(z)))


def measured_state(robot: SpatialWalker, reading: Measured) -> SpatialState:
    """Return the state of the zero dynamics of a measured state of the robot."""
    pose = pose_of_joints(robot, reading.joints)
    links = links_of(robot, pose)
    motion = motion_of_rates(robot, links, jacobians_of(links, pose), reading.rates)
    # The middle of the hips moves so on a foot at rest; the rest is the foot's own velocity.
    middle = jax.jvp(lambda q: hips_of(robot, q)[1], (reading.joints,), (reading.rates,))[1]
    linear = motion.linear + (reading.velocity - middle)[None]
    about = angular_momentum(robot, links, motion._replace(linear=linear))
    return jnp.concatenate([pose.hips[0, :2], jnp.stack([about[1], -about[0]])])


def exact_reading(robot: SpatialWalker, policy: SpatialPolicy, z: SpatialState) -> Measured:
    """Return what is measured on the zero dynamics, on a foot at rest."""
    now = flow(robot, policy, z)
    joints = joints_of_pose(robot, now.pose)
    velocity = jax.jvp(lambda q: hips_of(robot, q)[1], (joints,), (now.joints,))[1]
    return Measured(joints, now.joints, velocity)


def hips_of(robot: SpatialWalker, q: Float[Array, "8"]) -> tuple[Array, Array]:
    """Return the places of stance hip and middle of the hips from the stance foot [m]."""
    hips = pose_of_joints(robot, q).hips
    return hips[0], 0.5 * (hips[0] + hips[1])


def joint_gains(
    robot: SpatialWalker, policy: SpatialPolicy, start: Float[np.ndarray, "3"]
) -> PdGains:
    """Return gains for the inertia that each joint moves half-way through a step.

    That is the inertia with all other joints free, the torso's included: with the torso held, a
    stance joint would seem to move the whole robot.
    """
    middle = jnp.append(0.5 * (policy.ends[0] + policy.ends[1]), jnp.asarray(start))
    pose = pose_of_outputs(robot, middle[:2], policy(middle))
    links = links_of(robot, pose)
    mass = np.asarray(mass_matrix(robot, links, jacobians_of(links, pose)))
    inertia = 1.0 / np.diag(np.linalg.inv(mass))[2:]
    return inertia * STIFFNESS**2, 2.0 * DAMPING * STIFFNESS * inertia


def pd_law(
    robot: SpatialWalker,
    policy: SpatialPolicy,
    gains: PdGains,
    reading: Measured,
) -> TorqueDemand:
    """Return the torques of the gait at the measured z, with PD around its joints and rates."""
    z = measured_state(robot, reading)
    now, needed = loads(robot, policy.beyond, z)
    errors = angle_errors(reading.joints, *turns_of_pose(robot, now.pose))[2:]
    slips = (reading.rates - now.joints)[2:]
    torques = needed.torques - gains[0] * errors - gains[1] * slips
    return TorqueDemand(torques, errors, z, pose_of_joints(robot, reading.joints).feet[1, 2])


def angle_errors(
    angles: Float[Array, " k"], sines: Float[Array, " k"], cosines: Float[Array, " k"]
) -> Float[Array, " k"]:
    """Return by how much angles exceed those of these sines and cosines, up to 1.5 rad either way.

    Exported C has no inverse functions. Each iteration e + sin(error - e), from sin(error) on,
    leaves less than the third power of the distance to the error.
    """
    sine = jnp.sin(angles) * cosines - jnp.cos(angles) * sines
    cosine = jnp.cos(angles) * cosines + jnp.sin(angles) * sines
    error = sine
    for _ in range(3):
        error = error + sine * jnp.cos(error) - cosine * jnp.sin(error)
    return error


class Linearisation(NamedTuple):
    """Linear equations for the joint accelerations, and the torques that these take.

    Attributes:
        rows, right: rows @ accelerations = right. [8, 8], [8]
        mass, bias: torques = (mass @ accelerations + bias)[2:]. [8, 8], [8]
        errors, z, swing: see `TorqueDemand`.
    """

    rows: Float[Array, "*batch 8 8"]
    right: Float[Array, "*batch 8"]
    mass: Float[Array, "*batch 8 8"]
    bias: Float[Array, "*batch 8"]
    errors: Float[Array, "*batch 6"]
    z: Float[Array, "*batch 4"]
    swing: Float[Array, "*batch"]

    def solved(self) -> TorqueDemand:
        """Solve for the torques; outside of compiled code, where LAPACK does no harm."""
        right = np.asarray(self.right)[..., None]
        accelerations = np.linalg.solve(np.asarray(self.rows), right)
        torques = (np.asarray(self.mass) @ accelerations)[..., 2:, 0] + np.asarray(self.bias)[
            ..., 2:
        ]
        return TorqueDemand(torques, self.errors, self.z, self.swing)


def linearisation(robot: SpatialWalker, policy: SpatialPolicy, reading: Measured) -> Linearisation:
    """Return the equations in which the joints' errors obey e'' = -2 d w e' - w^2 e."""
    q, dq = reading.joints, reading.rates

    def moving(angles: Array) -> tuple[LinkMotion, Array, Array]:
        """Return motion, the hip's velocity, and the momenta's rates, of these rates."""
        pose = pose_of_joints(robot, angles)
        links = links_of(robot, pose)
        motion = motion_of_rates(robot, links, jacobians_of(links, pose), dq)
        hip = jax.jvp(lambda a: hips_of(robot, a)[0], (angles,), (dq,))[1]
        weight = jnp.sum(robot.masses[:, None] * links.centres, axis=0)
        return motion, hip[:2], robot.gravity * weight[:2]

    (_, velocity, pulled), (drift, bend, pulled_rate) = jax.jvp(moving, (q,), (dq,))
    pose = pose_of_joints(robot, q)
    links = links_of(robot, pose)
    jacobians = jacobians_of(links, pose)
    mass = mass_matrix(robot, links, jacobians)
    bias = generalised(robot, jacobians, drift.linear + (robot.gravity * UP)[None], drift.spin)
    z = measured_state(robot, reading)
    dz = jnp.concatenate([velocity, pulled])

    def outputs(state: Array) -> tuple[Array, Array]:
        return jax.jvp(lambda s: desired_joints(robot, policy, s)[2:], (state,), (dz,))

    (desired, rate), (_, curve) = jax.jvp(outputs, (z,), (dz,))
    slopes = jax.vmap(
        lambda one: jax.jvp(lambda s: desired_joints(robot, policy, s)[2:], (z,), (one,))[1],
        out_axes=1,
    )(jnp.eye(4, dtype=q.dtype))
    hip_rows = jax.vmap(
        lambda one: jax.jvp(lambda a: hips_of(robot, a)[0], (q,), (one,))[1][:2], out_axes=1
    )(jnp.eye(8, dtype=q.dtype))
    errors, slips = q[2:] - desired, dq[2:] - rate
    rows = jnp.eye(8, dtype=q.dtype)[2:] - slopes[:, :2] @ hip_rows
    goal = curve + slopes[:, :2] @ bend + slopes[:, 2:] @ pulled_rate
    goal = goal - 2.0 * DAMPING * STIFFNESS * slips - STIFFNESS**2 * errors
    return Linearisation(
        jnp.concatenate([mass[:2], rows]),
        jnp.concatenate([-bias[:2], goal]),
        mass,
        bias,
        errors,
        z,
        pose.feet[1, 2],
    )
