"""A first guess of a gait: a linear inverted pendulum that places its feet."""

from typing import NamedTuple

import jax.numpy as jnp
import numpy as np

from neuralgaits._types import Float
from neuralgaits.systems.walker3d.spatial_policy import INPUT_SCALE, Pendulum, StepNumbers
from neuralgaits.systems.walker3d.spatial_walker import SpatialWalker


class FirstGuess(NamedTuple):
    """Where the search for a gait starts.

    Attributes:
        numbers: of its steps.
        centre: of the invariants. [3]
        pendulum: whose invariants they are.
        start: (y, L_y, n) where a step starts. [3]
    """

    numbers: StepNumbers
    centre: Float[np.ndarray, "3"]
    pendulum: Pendulum
    start: Float[np.ndarray, "3"]


def section_scale(robot: SpatialWalker, pendulum: Pendulum) -> Float[np.ndarray, "3"]:
    """Return deviations of (y, L_y, n) where a step starts that count alike.

    They are 1 cm, a tenth of the momentum forward and a tenth of the one aside for the robot that
    is shipped, and go with mass and height.
    """
    momentum = pendulum.mass * pendulum.height**2 * pendulum.rate
    return np.array([0.0625 * robot.hip_width, 0.023 * momentum, 0.0076 * momentum])


def first_guess(
    robot: SpatialWalker, speed: float, duration: float, side: float, lateral: float
) -> FirstGuess:
    """Return a gait that a pendulum of the robot's size would walk.

    The lateral state (Y, nu) of a pendulum goes to (Y+, -nu) at a touchdown, Y+ being where the
    foot is placed from the middle. A placement k1 (Y + nu) + k2 (Y - nu) makes the product of the
    two lateral multipliers -(k1 + k2). Inverted, it says where the other foot was.

    Args:
        robot: the model.
        speed: see `OrbitAims`.
        duration: see there.
        side: see there.
        lateral: see there.
    """
    leg = robot.thigh.length + robot.shin.length
    height = 0.92 * leg
    masses = robot.torso_mass, 2.0 * robot.thigh.mass, 2.0 * robot.shin.mass
    levels = (
        height + robot.torso_centre[1],
        height - robot.thigh.centre,
        0.5 * height,
    )
    centre = sum(m * h for m, h in zip(masses, levels, strict=True)) / robot.mass
    pendulum = Pendulum(robot.mass, centre, robot.gravity, 0.5 * robot.hip_width)
    rate, reach = pendulum.rate, 0.5 * speed * duration
    turn = 0.5 * rate * duration
    fast = reach / np.sinh(turn) * rate * np.cosh(turn)
    middle = side + pendulum.half_width
    impulse = pendulum.mass * centre
    start = np.array([side, impulse * fast, -impulse * rate * middle * np.tanh(turn)])
    centres = np.asarray(pendulum.invariants(jnp.array([-reach, *start])))
    difference = (1.0 - lateral) / np.tanh(2.0 * turn)
    growing = np.array([fast / rate - reach, fast / rate + reach])
    _, up, down = INPUT_SCALE
    landing = [0.5 * (lateral + difference), 0.5 * (lateral - difference)]
    before = [0.5 * (1.0 + difference) / lateral, 0.5 * (1.0 - difference) / lateral]

    def weights(gains: list[float], size: float) -> np.ndarray:
        other = fast / rate * 2.0 - size
        return np.array([side, 0.0, gains[0] * up / other, gains[1] * down / size])

    numbers = StepNumbers(
        ends=np.array([-reach, reach]),
        pitch=np.array([0.05, 0.0, 0.0, 0.0]),
        height=np.array([height, 0.0, 0.0, 0.0]),
        ahead=np.array([-0.1, -0.1, 0.0]),
        lift=np.array([0.1, -0.1, 0.05]),
        start=weights(before, growing[0]),
        landing=weights(landing, growing[1]),
        sway=np.zeros(2),
    )
    return FirstGuess(numbers, centres, pendulum, start)
