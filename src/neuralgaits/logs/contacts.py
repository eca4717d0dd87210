"""The stance leg from the contacts of both feet: the controller's rule, on a whole log."""

import numpy as np

from neuralgaits._types import Bool, Float, Int
from neuralgaits.control.touchdown import TouchdownThresholds

UNKNOWN = -1
"""Leg number of the rows before exactly one foot was on the ground."""


def stance_legs(
    leg_length: float,
    t: Float[np.ndarray, " k"],
    contact: Bool[np.ndarray, "k 2"],
    ahead: Float[np.ndarray, " k"],
) -> Int[np.ndarray, " k"]:
    """Find the stance leg in each row.

    A touchdown is a contact of the swing foot in two rows one after another, ahead of the stance
    foot, and not while the last touchdown is still settling: a switch that chatters, a row that
    glitches and a foot that scuffs end no step. See `control.touchdown.TouchdownThresholds`.

    Args:
        leg_length: leg length of the robot (m).
        t: times, increasing (s). [k]
        contact: contact of both feet, legs in the order of the robot file. [k, 2]
        ahead: foot of leg 1 ahead of that of leg 0 (m). [k]

    Returns: [k] 0 or 1; UNKNOWN before the first row in which exactly one foot is on the ground.
    """
    config = TouchdownThresholds()
    stays = contact.copy()
    stays[:-1] &= contact[1:]
    legs = np.full(len(t), UNKNOWN)
    single = np.flatnonzero(stays[:, 0] != stays[:, 1])
    if not single.size:
        return legs
    first = int(single[0])
    leg = int(stays[first, 1])
    far = config.advance_share * leg_length
    lands = np.column_stack([stays[:, 0] & (-ahead > far), stays[:, 1] & (ahead > far)])
    last = -np.inf
    begin = first
    # From touchdown to touchdown: most rows are none.
    while True:
        later = np.flatnonzero(lands[begin:, 1 - leg] & (t[begin:] - last >= config.lockout_s))
        if not later.size:
            legs[begin:] = leg
            return legs
        end = begin + int(later[0])
        legs[begin:end] = leg
        leg, last, begin = 1 - leg, t[end], end


def loaded(weight: float, force: Float[np.ndarray, " k"]) -> Bool[np.ndarray, " k"]:
    """Return whether a foot with this normal force is in stance or lands. [k].

    Args:
        weight: weight of the robot (N).
        force: normal force on the foot (N). [k]
    """
    return force > TouchdownThresholds().force_share * weight
