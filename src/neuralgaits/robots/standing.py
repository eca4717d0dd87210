"""Postures with both feet on the floor, for a robot that starts and stops.

Each is given by the distance of the feet, the height of the hip, and where the centre of mass is
between the feet. Newton's method finds the joint angles.
"""

from typing import NamedTuple

import numpy as np

from neuralgaits._types import Float
from neuralgaits.robots.biped import PlanarBiped


class Stand(NamedTuple):
    """A posture on two feet.

    Lengths are shares of the leg length.
    """

    spacing: float
    """Distance from the rear foot to the front foot."""
    height: float
    """Height of the hip."""
    ahead: float
    """Centre of mass ahead of the front foot, as a share of the distance of the feet."""
    lean: float = -0.1
    """Absolute angle of the torso, backwards positive [rad]."""


class StandingPostures(NamedTuple):
    """Postures of a robot that starts and stops, as coordinates q with the front leg in stance."""

    path: Float[np.ndarray, "K n"]
    """Postures from standing to where the first step begins [rad]."""
    wide: Float[np.ndarray, "2 n"]
    """Postures at the end of a walk, with the feet far apart: leaning back, and forward [rad]."""
    braking: Float[np.ndarray, " n"]
    """Posture at the touchdown before that, with the rear leg in stance [rad]."""

    @classmethod
    def none_of(cls, n: int) -> "StandingPostures":
        """Return zeros for a robot of n coordinates that has no such postures."""
        return cls(np.zeros((2, n)), np.zeros((2, n)), np.zeros(n))


def standing_postures(robot: PlanarBiped) -> StandingPostures | None:
    """Return the postures of a robot; None if its legs cannot take them at any height."""
    candidates = (_postures_at(robot, height) for height in (0.91, 0.89, 0.87, 0.85, 0.83))
    return next((postures for postures in candidates if postures is not None), None)


def _postures_at(robot: PlanarBiped, height: float) -> StandingPostures | None:
    """Return the postures with the hip at a height, as `Stand.height`; None if there are none."""
    path, sway = [], []
    guess = None
    # From standing to the first step, which begins with the centre of mass over the front foot.
    for ahead in np.linspace(-0.5, 0.0, 9):
        guess = posture(robot, Stand(spacing=0.40, height=height, ahead=float(ahead)), guess)
        if guess is None:
            return None
        path.append(guess)
    # Where the last step ends, and the two ends of how far the centre of mass goes afterwards.
    for ahead in (-0.6, -0.7, -0.3):
        guess = posture(robot, Stand(spacing=0.50, height=height, ahead=ahead), path[0])
        if guess is None:
            return None
        sway.append(guess)
    return StandingPostures(np.array(path), np.array(sway[1:]), robot.relabel @ sway[0])


def posture(
    robot: PlanarBiped, stand: Stand, guess: Float[np.ndarray, " n"] | None = None
) -> Float[np.ndarray, " n"] | None:
    """Return the coordinates of a posture with the front leg in stance; None if there is none.

    Args:
        robot: the biped.
        stand: the posture.
        guess: coordinates to start from; bent knees if None.
    """
    q = _bent(robot) if guess is None else np.array(guess)
    difference = 1e-6
    for _ in range(60):
        missed = _distance(robot, stand, q)
        if np.max(np.abs(missed)) < 1e-10:
            fits = np.all((q[1:] >= robot.joint_lower) & (q[1:] <= robot.joint_upper))
            return q if fits else None
        nearby = [_distance(robot, stand, q + row) for row in difference * np.eye(len(q))]
        slope = (np.array(nearby) - missed).T / difference
        # Legs of more links than two have further freedom: they stay near the guess.
        move = np.linalg.lstsq(slope, missed, rcond=None)[0]
        q = q - move * min(1.0, 0.3 / float(np.max(np.abs(move))))
    return None


def _distance(
    robot: PlanarBiped, stand: Stand, q: Float[np.ndarray, " n"]
) -> Float[np.ndarray, " n"]:
    """Return how far coordinates are from a posture: a number for each coordinate."""
    theta = robot.link_angles @ q
    length = robot.leg_length
    foot, hip = _point(robot.foot, theta), _point(robot.hip, theta)
    spacing = stand.spacing * length
    parts = [
        foot[0] + spacing,
        foot[1],
        hip[1] - stand.height * length,
        centre_of_mass(robot, q)[0] - stand.ahead * spacing,
    ]
    if robot.torso is not None:
        parts.append(theta[robot.torso] - stand.lean)
    if robot.feet is not None:
        parts.append(theta[-1])
    return np.array(parts, dtype=np.float64)


def centre_of_mass(robot: PlanarBiped, q: Float[np.ndarray, " n"]) -> Float[np.ndarray, "2"]:
    """Return the centre of mass from the stance foot, as `robots.dynamics` has it (m)."""
    theta = robot.link_angles @ q
    if robot.mass_moment_phase is not None:
        theta = theta + robot.mass_moment_phase
    return _point(np.asarray(robot.mass_moment), theta) / float(robot.mass)


def _point(
    coefficients: Float[np.ndarray, " n"], theta: Float[np.ndarray, " n"]
) -> Float[np.ndarray, "2"]:
    return np.array([-(coefficients @ np.sin(theta)), coefficients @ np.cos(theta)])


def _bent(robot: PlanarBiped) -> Float[np.ndarray, " n"]:
    """Return coordinates of a robot with bent knees, the middle of each joint's range at most."""
    middle = 0.5 * (robot.joint_lower + robot.joint_upper)
    knee = 0.5  # Flexion of the knees that Newton's method starts from [rad].
    return np.concatenate([[0.0], np.clip(middle, -knee, knee)])


def pendulum_rate(robot: PlanarBiped) -> float:
    """Return the rate of an inverted pendulum as long as the leg (rad/s)."""
    return float(np.sqrt(robot.gravity / robot.leg_length))


def first_momentum(robot: PlanarBiped) -> float:
    """Return the momentum beyond just tipping over, with which a first step begins (kg m^2/s)."""
    # Momentum beyond that which just tips over the foot, with which a first step begins, in units
    # of a point mass on the leg that turns at the pendulum's rate.
    share = 0.09
    return share * float(robot.mass) * robot.leg_length**2 * pendulum_rate(robot)
