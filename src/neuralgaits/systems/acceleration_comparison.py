"""A family's formulas beside MuJoCo: a file is of the family if both accelerate it alike.

A file can hold more than any list of refusals names: gravity compensation, a wall,
switched-off forces, polynomials of damping, friction in a motor. What moves the joints shows in
their accelerations, so these are compared all over the coordinates' ranges.
"""

import itertools
from collections.abc import Callable, Sequence
from typing import NamedTuple

import mujoco
import numpy as np

from neuralgaits._types import Float
from neuralgaits.systems.joint_map import JointMap

Accelerations = Callable[[np.ndarray, float], np.ndarray]
"""Function from a state and a force to the coordinates' accelerations."""


class ComparedRanges(NamedTuple):
    """States that are compared.

    Attributes:
        reach: largest value of each coordinate, on either side of 0. [k]
        rates: rates of the coordinates. [any, k]
        force_limit: largest force of the motor.
    """

    reach: Sequence[float]
    rates: Sequence[Sequence[float]]
    force_limit: float


def difference_from_mujoco(
    model: mujoco.MjModel, joints: JointMap, ranges: ComparedRanges, formulas: Accelerations
) -> tuple[float, Float[np.ndarray, " n"]] | None:
    """Compare the formulas' accelerations with MuJoCo's.

    What acts later than at once shows where MuJoCo goes on by itself for a while.

    Args:
        model: model of the file.
        joints: joints of the coordinates.
        ranges: states that are compared.
        formulas: accelerations by the family's formulas.

    Returns: None if they agree; else the share by which they differ, and the state where that is
        largest.
    """
    world, reach = mujoco.MjData(model), np.array(ranges.reach)
    worst = 0.0, np.zeros(2 * len(reach))

    def compared(state: np.ndarray, force: float) -> tuple[float, np.ndarray]:
        expected, measured = formulas(state, force), joints.accelerations(model, world)
        largest = max(1.0, np.max(np.abs(expected)))
        share = float(np.max(np.abs(measured - expected)) / largest)
        return (worst[0], worst[1]) if share <= worst[0] else (share, state)

    # Places, as shares of the coordinates' ranges.
    place_shares = (-0.98, -0.7, -0.35, 0.0, 0.35, 0.7, 0.98)
    places = itertools.product(place_shares, repeat=len(reach))
    force_shares = (-1.0, 0.4, 1.0)  # Forces, as shares of the motor's limit.
    for place, rates, share in itertools.product(places, ranges.rates, force_shares):
        state = np.concatenate([place * reach, rates])
        force = share * ranges.force_limit
        mujoco.mj_resetData(model, world)
        joints.write(model, world, state)
        joints.push(world, force)
        mujoco.mj_forward(model, world)
        worst = compared(state, force)
    # The last coordinate is let go at the upright and a tenth of its range away, for 60 steps.
    for share in (0.0, 0.1):
        mujoco.mj_resetData(model, world)
        start = np.zeros(2 * len(reach))
        start[len(reach) - 1] = share * reach[-1]
        joints.write(model, world, start)
        for _ in range(60):
            mujoco.mj_step(model, world)
            # Integrators of several stages leave the accelerations of the last one.
            mujoco.mj_forward(model, world)
            state = joints.read(model, world)
            if not np.all(np.abs(state[: len(reach)]) < 0.98 * reach):
                break
            worst = compared(state, 0.0)
    rounding = 1e-7  # As a share of the largest acceleration there.
    return None if worst[0] <= rounding else worst
