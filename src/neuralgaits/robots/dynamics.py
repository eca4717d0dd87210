"""Closed-form dynamics of a planar link tree pinned at its stance foot.

With centres of mass sum_k a_ik e(theta_k), kinetic energy is a double sum of
|C_kl| cos(theta_k - theta_l + phase_kl) over link rates, so mass matrix and Coriolis terms are
one cosine and one sine of the same angle table. No linear solve, no symbolic generation.
Source: docs/notation.md; any text on planar manipulators in absolute angles.
"""

from collections.abc import Callable

import jax.numpy as jnp

from neuralgaits._types import Actuated, Array, Coordinates, Float, Planar, Scalar
from neuralgaits.robots.constants import BipedConstants
from neuralgaits.robots.linear import solve
from neuralgaits.robots.robot_file import flat_feet_of


def relative_angles(robot: BipedConstants, theta: Coordinates) -> Float[Array, "n n"]:
    """Angle table theta_k - theta_l + phase_kl. Returns: [n, n] (rad)."""
    table = theta[:, None] - theta[None, :]
    return table if robot.coupling_phase is None else table + robot.coupling_phase


def moment_angles(robot: BipedConstants, theta: Coordinates) -> Coordinates:
    """Direction of each link's share of the centre of mass. Returns: [n] (rad)."""
    phase = robot.mass_moment_phase
    return theta if phase is None else theta + phase


def coupling_cosines(robot: BipedConstants, theta: Coordinates) -> Float[Array, "n n"]:
    """|C_kl| cos(theta_k - theta_l + phase_kl). Returns: [n, n] (kg m^2)."""
    table = relative_angles(robot, theta)
    table_of_cosines = robot.coupling * jnp.cos(table)
    if robot.coupling_across is None:
        return table_of_cosines
    return table_of_cosines - robot.coupling_across * jnp.sin(table)


def coupling_sines(robot: BipedConstants, theta: Coordinates) -> Float[Array, "n n"]:
    """|C_kl| sin(theta_k - theta_l + phase_kl). Returns: [n, n] (kg m^2)."""
    table = relative_angles(robot, theta)
    table_of_sines = robot.coupling * jnp.sin(table)
    if robot.coupling_across is None:
        return table_of_sines
    return table_of_sines + robot.coupling_across * jnp.cos(table)


def link_mass_matrix(robot: BipedConstants, theta: Coordinates) -> Float[Array, "n n"]:
    """Mass matrix in absolute link angles, without rotors. Returns: [n, n] (kg m^2)."""
    return coupling_cosines(robot, theta) + jnp.diag(robot.inertia)


def mass_matrix(robot: BipedConstants, q: Coordinates) -> Float[Array, "n n"]:
    """Mass matrix in generalised coordinates. Returns: [n, n] (kg m^2)."""
    turn = robot.link_angles
    links = link_mass_matrix(robot, turn @ q)
    return turn.T @ links @ turn + jnp.diag(robot.armature)


def link_bias(robot: BipedConstants, theta: Coordinates, dtheta: Coordinates) -> Coordinates:
    """Centrifugal and gravity terms per absolute link angle. Returns: [n] (N m)."""
    centrifugal = coupling_sines(robot, theta) @ (dtheta * dtheta)
    angles = moment_angles(robot, theta)
    weight = robot.gravity * robot.mass_moment * jnp.sin(angles)
    if robot.moment_across is not None:
        weight = weight + robot.gravity * robot.moment_across * jnp.cos(angles)
    return centrifugal - weight


def bias(robot: BipedConstants, q: Coordinates, dq: Coordinates) -> Coordinates:
    """Coriolis, gravity and damping terms. Returns: [n] (N m)."""
    turn = robot.link_angles
    return turn.T @ link_bias(robot, turn @ q, turn @ dq) + robot.damping * dq


def acceleration(
    robot: BipedConstants,
    q: Coordinates,
    dq: Coordinates,
    torque: Actuated,
    ankle: Scalar | float = 0.0,
) -> Coordinates:
    """Forward dynamics D ddq = (-ankle, torque) - H. Returns: [n] (rad/s^2)."""
    force = jnp.concatenate([-jnp.full(1, ankle, dtype=torque.dtype), torque])
    return solve(mass_matrix(robot, q), force - bias(robot, q, dq))


def angular_momentum(robot: BipedConstants, q: Coordinates, dq: Coordinates) -> Scalar:
    """Angular momentum about the pinned stance foot, positive forward.

    Angles grow backwards, hence its sign.

    Returns: scalar z2 (kg m^2/s). Rotors turn with the joints and add nothing, but for that of a
    stance ankle, which turns against a foot at rest.
    """
    turn = robot.link_angles
    momentum = -jnp.sum(link_mass_matrix(robot, turn @ q) @ (turn @ dq))
    return momentum if robot.feet is None else momentum - robot.armature[0] * dq[0]


def _of_moment(robot: BipedConstants, point: Callable[[Coordinates], Planar]) -> Planar:
    """A point, or its rate, whose coefficients are the first moments, a turned part included."""
    force = point(robot.mass_moment)
    if robot.moment_across is None:
        return force
    across = point(robot.moment_across)
    return force + jnp.stack([-across[1], across[0]])


def _point(coefficients: Coordinates, theta: Coordinates) -> Planar:
    return jnp.stack([-(coefficients @ jnp.sin(theta)), coefficients @ jnp.cos(theta)])


def _point_velocity(coefficients: Coordinates, theta: Coordinates, dtheta: Coordinates) -> Planar:
    weighted = coefficients * dtheta
    return -jnp.stack([weighted @ jnp.cos(theta), weighted @ jnp.sin(theta)])


def _point_acceleration(
    coefficients: Coordinates, theta: Coordinates, dtheta: Coordinates, ddtheta: Coordinates
) -> Planar:
    along = coefficients * ddtheta
    spun = coefficients * dtheta * dtheta
    sine, cosine = jnp.sin(theta), jnp.cos(theta)
    return jnp.stack([spun @ sine - along @ cosine, -(along @ sine) - spun @ cosine])


def swing_foot(robot: BipedConstants, q: Coordinates) -> Planar:
    """Swing-foot position from the stance foot, (x, z). Returns: [2] (m)."""
    return _point(robot.foot, robot.link_angles @ q)


def foot_angle_rate(robot: BipedConstants, dq: Coordinates) -> Scalar:
    """Rate of a flat swing foot's absolute angle. Returns: scalar (rad/s)."""
    return robot.link_angles[-1] @ dq


def sole_ends(robot: BipedConstants, q: Coordinates) -> Float[Array, "2 2"]:
    """Heel and toe of a flat swing foot, from the place under the stance ankle.

    Returns: [2, 2], (x, z) of the heel and of the toe (m). Raises: InputError on point feet.
    """
    return swing_foot(robot, q)[None] + _on_foot(robot, robot.link_angles[-1] @ q)


def sole_velocities(robot: BipedConstants, q: Coordinates, dq: Coordinates) -> Float[Array, "2 2"]:
    """Velocities of heel and toe of a flat swing foot. Returns: [2, 2], (x, z) of each (m/s)."""
    angle, turning = robot.link_angles[-1] @ q, foot_angle_rate(robot, dq)
    x, z = _on_foot(robot, angle).T
    of_turning = turning * jnp.stack([flat_feet_of(robot).height - z, x], axis=1)
    return swing_foot_velocity(robot, q, dq)[None] + of_turning


def _on_foot(robot: BipedConstants, angle: Scalar) -> Float[Array, "2 2"]:
    """Heel and toe from the place that is as far below the ankle as the ground is. [2, 2] (m)."""
    feet, (sine, cosine) = flat_feet_of(robot), (jnp.sin(angle), jnp.cos(angle))
    along = jnp.stack([-feet.heel, feet.toe])
    x = along * cosine + feet.height * sine
    z = along * sine + feet.height * (1.0 - cosine)
    return jnp.stack([x, z], axis=1)


def swing_foot_velocity(robot: BipedConstants, q: Coordinates, dq: Coordinates) -> Planar:
    """Swing-foot velocity, (x, z). Returns: [2] (m/s)."""
    turn = robot.link_angles
    return _point_velocity(robot.foot, turn @ q, turn @ dq)


def hip_position(robot: BipedConstants, q: Coordinates) -> Planar:
    """Hip position from the stance foot, (x, z). Returns: [2] (m)."""
    return _point(robot.hip, robot.link_angles @ q)


def hip_velocity(robot: BipedConstants, q: Coordinates, dq: Coordinates) -> Planar:
    """Hip velocity, (x, z). Returns: [2] (m/s)."""
    turn = robot.link_angles
    return _point_velocity(robot.hip, turn @ q, turn @ dq)


def centre_of_mass(robot: BipedConstants, q: Coordinates) -> Planar:
    """Centre of mass from the stance foot, (x, z). Returns: [2] (m)."""
    angles = moment_angles(robot, robot.link_angles @ q)
    return _of_moment(robot, lambda moment: _point(moment, angles)) / robot.mass


def centre_of_mass_velocity(robot: BipedConstants, q: Coordinates, dq: Coordinates) -> Planar:
    """Centre-of-mass velocity, (x, z). Returns: [2] (m/s)."""
    turn = robot.link_angles
    angles, dtheta = moment_angles(robot, turn @ q), turn @ dq
    return _of_moment(robot, lambda b: _point_velocity(b, angles, dtheta)) / robot.mass


def ground_reaction_force(
    robot: BipedConstants, q: Coordinates, dq: Coordinates, ddq: Coordinates
) -> Planar:
    """Ground force on the stance foot: the total mass times (acceleration + gravity).

    Returns: [2] (tangential, normal) (N). A flat stance foot's own weight is part of it.
    """
    turn = robot.link_angles
    angles, dtheta, ddtheta = moment_angles(robot, turn @ q), turn @ dq, turn @ ddq
    force = _of_moment(robot, lambda b: _point_acceleration(b, angles, dtheta, ddtheta))
    weight = robot.mass * robot.gravity
    if robot.feet is not None:
        weight = weight + robot.feet.mass * robot.gravity
    return force + jnp.stack([jnp.zeros_like(force[0]), weight])
