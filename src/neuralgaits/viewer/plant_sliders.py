"""Sliders of the live page for what a plant is, and for what a gait is told."""

import math
from collections.abc import Mapping

import numpy as np

from neuralgaits.analysis.run import Run
from neuralgaits.gait.commands import LEAN, SLOPE, Command
from neuralgaits.viewer.slider import Slider

MILLIMETRE = 1e-3
"""[m]."""


def plant_sliders(run: Run, *, on_floor: bool) -> Mapping[str, Slider]:
    """Return the settings of the plant that can be changed, well beyond what gaits tolerate.

    Args:
        run: run of the gait.
        on_floor: whether it walks on a floor, which can be turned.
    """
    robot = run.robot
    friction, torque = float(robot.friction), float(np.max(robot.torque_limit))
    tilt = "uphill positive; the floor turns about the stance foot"
    slide = "sliding coefficient between feet and floor"
    heavy = "factor on all masses and inertias; the controller is not told"
    weak = "limit of every joint; the controller knows it"
    ahead = "centre of mass ahead of the file's; the controller is not told"
    values = {
        "slope_deg": Slider("slope [deg]", -6.0, 6.0, 0.0, 0.5, tilt),
        "friction": Slider("friction", 0.05, max(1.2, friction), friction, 0.01, slide),
        "mass_scale": Slider("mass ×", 0.5, 2.0, 1.0, 0.01, heavy),
        "torque_limit": Slider("torque [N m]", 0.1 * torque, torque, torque, 0.5, weak),
    }
    if robot.torso is not None:
        values["torso_shift_m"] = Slider(
            "torso's weight ahead [mm]", -50.0, 50.0, 0.0, 1.0, ahead, MILLIMETRE
        )
    if not on_floor:
        del values["slope_deg"]
    return values


def command_slider(command: Command) -> Slider:
    """Return the slider of a command: slopes in degrees, leans in millimetres."""
    units = {SLOPE: ("deg", math.radians(1.0)), LEAN: ("mm", MILLIMETRE)}
    word, unit = units.get(command.name, (command.unit, 1.0))
    low, high = command.low / unit, command.high / unit
    return Slider(f"{command.name} [{word}]", low, high, 0.5 * (low + high), unit=unit)
