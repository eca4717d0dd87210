"""Robots as callers name them: the robot itself, a built-in name, or the path of its file."""

from pathlib import Path

from neuralgaits.robots.biped import PlanarBiped

RobotSource = PlanarBiped | str | Path
"""A loaded robot, the name of a built-in one, or the path of a robot file."""
