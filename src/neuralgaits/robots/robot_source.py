"""Robots as callers name them: the robot itself, a built-in name, or the path of its file."""

from pathlib import Path

from neuralgaits._printable import shown
from neuralgaits.errors import InputError
from neuralgaits.robots.biped import PlanarBiped

RobotSource = PlanarBiped | str | Path
"""A loaded robot, the name of a built-in one, or the path of a robot file."""


def planar_biped(robot: object) -> PlanarBiped:
    """Return the robot as the planar biped that it is. Raises: InputError for anything else."""
    if not isinstance(robot, PlanarBiped):
        raise InputError(
            f"robot: expected a PlanarBiped, found {shown(robot)}: load one, as in "
            'load_robot("amber3m")'
        )
    return robot
