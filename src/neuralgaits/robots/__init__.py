"""Robots: files, the loader that reads them, closed-form dynamics and impact."""

from neuralgaits.robots.biped import MjcfLayout, PlanarBiped
from neuralgaits.robots.impact import Impact
from neuralgaits.robots.loader import load_robot
from neuralgaits.robots.registry import built_in, describe

__all__ = ["Impact", "MjcfLayout", "PlanarBiped", "built_in", "describe", "load_robot"]
