"""Regions of an ellipsoid's chart, and the conditions that each family has there. Needs no JAX."""

from neuralgaits.certificate.chart import Axis, Chart
from neuralgaits.systems.condition_table import ConditionTable

AXES = ("radius", "quarter turn", "half turn", "full turn")
"""Names of the chart's axes, each from 0 to 1: the radius, and three angles that cover half of the
directions. The flow is odd, so that margins at a state and at its opposite are equal."""
CORE = 0.125
"""Radius below which conditions are about rates along the radius: they vanish at the centre."""
RADII = {"set": (0.0, 1.0), "core": (0.0, CORE), "ring": (CORE, 1.0), "face": (1.0, 1.0)}
"""Radii of each region; `face` is the set's only one, where the flow must point inward."""
RADIAL = {"inward": "face", "descent": "ring", "settling": "core"}
"""Region of each condition about the radius."""


def ellipsoid_table(*limits: str) -> ConditionTable:
    """Return the conditions of a family: those about the radius, and its limits in the whole set.

    Args:
        limits: names of the conditions about limits.
    """
    chart = Chart(state=tuple(Axis(name, 0.0, 1.0) for name in AXES))
    regions = {
        name: (((low, 0.0, 0.0, 0.0), (high, 1.0, 1.0, 1.0)),)
        for name, (low, high) in RADII.items()
    }
    return ConditionTable(chart, regions, RADIAL | dict.fromkeys(limits, "set"))
