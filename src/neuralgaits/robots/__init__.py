"""Robots: files, the loader that reads them, closed-form dynamics and impact."""

from neuralgaits.robots.biped import PlanarBiped
from neuralgaits.robots.constants import BipedConstants
from neuralgaits.robots.layout import MjcfLayout
from neuralgaits.robots.mjcf.loader import load_robot
from neuralgaits.robots.registry import built_in, describe
from neuralgaits.robots.robot_source import RobotSource
from neuralgaits.robots.state_after_impact import Impact

__all__ = [
    "BipedConstants",
    "Impact",
    "MjcfLayout",
    "PlanarBiped",
    "RobotSource",
    "built_in",
    "describe",
    "load_robot",
]
