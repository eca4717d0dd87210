"""Poses of the biped: from the places of hips and feet, or from joint angles.

A pose knows no angles. Where the torso does not roll, the place of a foot below its hip and the
torso's forward axis give the leg: its plane holds both, and two circles meet at the knee. That
takes squares and square roots only, which bounds over boxes need (angles of three joints would
leave small differences of large terms).
"""

from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from neuralgaits._types import Array, Float
from neuralgaits.systems.walker3d.spatial_walker import SpatialWalker

LEFT = np.array([0.0, 1.0, 0.0])
MIRROR = np.array([1.0, -1.0, 1.0])
"""Reflection in the plane in which the robot walks."""


class Outputs(NamedTuple):
    """The six controlled outputs but the torso's roll, which is to be 0.

    Attributes:
        pitch: pitch of the torso, positive forward [rad].
        height: height of the hips above the stance foot [m].
        ahead, aside: place of the swing foot from its hip, forward and to the left [m].
        lift: height of the swing foot above the stance foot [m].
    """

    pitch: Float[Array, ""]
    height: Float[Array, ""]
    ahead: Float[Array, ""]
    aside: Float[Array, ""]
    lift: Float[Array, ""]


class SpatialPose(NamedTuple):
    """Places of the joints from the stance foot, and directions. Stance leg first: the right one.

    Attributes:
        torso: its forward, left and upward axis. [3, 3]
        hips, knees, feet: places of both legs' joints and feet [m]. [2, 3]
        normals: axes of hip pitch and knee of both legs, to the left. [2, 3]
    """

    torso: Float[Array, "3 3"]
    hips: Float[Array, "2 3"]
    knees: Float[Array, "2 3"]
    feet: Float[Array, "2 3"]
    normals: Float[Array, "2 3"]


class Links(NamedTuple):
    """Centres of mass [m] and axes (forward, left, up) of all links. [5, 3], [5, 3, 3]."""

    centres: Float[Array, "5 3"]
    frames: Float[Array, "5 3 3"]


def cross(a: Float[Array, "*rows 3"], b: Float[Array, "*rows 3"]) -> Float[Array, "*rows 3"]:
    """Return the vector product, by components: fewer operations than `jnp.cross`."""
    x, y, z = a[..., 0], a[..., 1], a[..., 2]
    u, v, w = b[..., 0], b[..., 1], b[..., 2]
    return jnp.stack([y * w - z * v, z * u - x * w, x * v - y * u], axis=-1)


def pose_of_outputs(
    robot: SpatialWalker, position: Float[Array, "2"], outputs: Outputs
) -> SpatialPose:
    """Return the pose of a torso that does not roll.

    Args:
        robot: the model.
        position: stance hip from the stance foot, forward and to the left [m].
        outputs: where torso, hips and swing foot are.
    """
    sine, cosine = jnp.sin(outputs.pitch), jnp.cos(outputs.pitch)
    zero = jnp.zeros_like(sine)
    forward, up = jnp.stack([cosine, zero, -sine]), jnp.stack([sine, zero, cosine])
    torso = jnp.stack([forward, jnp.asarray(LEFT, sine.dtype), up])
    hip = jnp.append(position, outputs.height)
    # Each leg from its foot to its hip.
    swing = -jnp.stack([outputs.ahead, outputs.aside, outputs.lift - outputs.height])
    other = hip + robot.hip_width * LEFT
    hips, feet = jnp.stack([hip, other]), jnp.stack([jnp.zeros(3, hip.dtype), other - swing])
    bends, normals = jax.vmap(lambda leg: _leg(robot, leg, forward))(jnp.stack([hip, swing]))
    return SpatialPose(torso, hips, feet + bends, feet, normals)


def _leg(
    robot: SpatialWalker, leg: Float[Array, "3"], forward: Float[Array, "3"]
) -> tuple[Float[Array, "3"], Float[Array, "3"]]:
    """Return the knee's place from the foot, and the normal of the leg's plane.

    Args:
        robot: the model.
        leg: hip from foot [m].
        forward: the torso's forward axis, about which the hip rolls.
    """
    thigh, shin = robot.thigh.length, robot.shin.length
    square, along = leg @ leg, leg @ forward
    across = jnp.sqrt(square - along * along)
    share = 0.5 + (shin * shin - thigh * thigh) / (2.0 * square)
    bend = jnp.sqrt(shin * shin / square - share * share) / across
    return share * leg + bend * (square * forward - along * leg), cross(leg, forward) / across


def pose_of_joints(robot: SpatialWalker, q: Float[Array, "8"]) -> SpatialPose:
    """Return the pose of joint angles, in the order of `JOINTS`; the torso may roll."""
    torso = _turned(_turned(jnp.eye(3, dtype=q.dtype), 0, q[0]), 1, q[1])

    def leg(side: Float[Array, ""], angles: Float[Array, "3"]) -> tuple[Array, ...]:
        rolled = _turned(torso, 0, angles[0])
        thigh = _turned(rolled, 1, angles[1])
        shin = _turned(thigh, 1, angles[2])
        hip = side * torso[1]
        knee = hip - robot.thigh.length * thigh[2]
        return hip, knee, knee - robot.shin.length * shin[2], rolled[1]

    sides = jnp.asarray(0.5 * robot.hip_width * np.array([-1.0, 1.0]), q.dtype)
    hips, knees, feet, normals = jax.vmap(leg)(sides, q[2:].reshape(2, 3))
    foot = feet[:1]
    return SpatialPose(torso, hips - foot, knees - foot, feet - foot, normals)


def _turned(frame: Float[Array, "3 3"], axis: int, angle: Float[Array, ""]) -> Float[Array, "3 3"]:
    """Return the axes of a frame that turns about its own forward (0) or left (1) axis."""
    sine, cosine = jnp.sin(angle), jnp.cos(angle)
    forward, left, up = frame
    if axis == 0:
        return jnp.stack([forward, cosine * left + sine * up, cosine * up - sine * left])
    return jnp.stack([cosine * forward - sine * up, left, cosine * up + sine * forward])


def joints_of_pose(robot: SpatialWalker, pose: SpatialPose) -> Float[Array, "8"]:
    """Return the joint angles of a pose, in the order of `JOINTS` [rad]."""
    sines, cosines = turns_of_pose(robot, pose)
    return jnp.arctan2(sines, cosines)


def turns_of_pose(
    robot: SpatialWalker, pose: SpatialPose
) -> tuple[Float[Array, "8"], Float[Array, "8"]]:
    """Return sines and cosines of the joint angles of a pose, in the order of `JOINTS`."""
    forward, left, up = pose.torso

    def leg(normal: Array, thigh: Array, shin: Array) -> tuple[Array, Array]:
        rolled = cross(forward, normal)
        sines = jnp.stack([normal @ up, thigh[2] @ forward, shin[2] @ thigh[0]])
        cosines = jnp.stack([normal @ left, thigh[2] @ rolled, shin[2] @ thigh[2]])
        return sines, cosines

    frames = links_of(robot, pose).frames
    sines, cosines = jax.vmap(leg)(pose.normals, frames[1::2], frames[2::2])
    return (
        jnp.concatenate([jnp.stack([left[2], up[0]]), sines.reshape(6)]),
        jnp.concatenate([jnp.stack([left[1], forward[0]]), cosines.reshape(6)]),
    )


def links_of(robot: SpatialWalker, pose: SpatialPose) -> Links:
    """Return centres of mass and axes of all links."""

    def of_leg(hip: Array, knee: Array, foot: Array, normal: Array) -> tuple[Array, Array]:
        thigh, shin = (hip - knee) / robot.thigh.length, (knee - foot) / robot.shin.length
        centres = jnp.stack([hip - robot.thigh.centre * thigh, knee - robot.shin.centre * shin])
        frames = [jnp.stack([cross(normal, up), normal, up]) for up in (thigh, shin)]
        return centres, jnp.stack(frames)

    ahead, above = robot.torso_centre
    middle = 0.5 * (pose.hips[0] + pose.hips[1])
    torso = middle + ahead * pose.torso[0] + above * pose.torso[2]
    centres, frames = jax.vmap(of_leg)(pose.hips, pose.knees, pose.feet, pose.normals)
    return Links(
        jnp.concatenate([torso[None], centres.reshape(4, 3)]),
        jnp.concatenate([pose.torso[None], frames.reshape(4, 3, 3)]),
    )


def mirrored(pose: SpatialPose) -> SpatialPose:
    """Return the reflected pose of the same robot, on its new stance foot.

    The legs swap, and so do left and right: places are reflected, axes of rotation in plane and
    normals to it keep their sense.
    """
    foot = pose.feet[1]

    def places(points: Float[Array, "2 3"]) -> Float[Array, "2 3"]:
        return (points[::-1] - foot[None]) * MIRROR[None]

    # The left axis is reflected and reversed, so that the frame stays right-handed.
    torso = pose.torso * MIRROR[None] * MIRROR[:, None]
    normals = -pose.normals[::-1] * MIRROR[None]
    return SpatialPose(torso, places(pose.hips), places(pose.knees), places(pose.feet), normals)
