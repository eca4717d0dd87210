"""Regions of the spec `balancing`, as boxes of the chart of the set. Needs no JAX."""

from neuralgaits.certificate.chart import Axis, Chart

AXES = ("radius", "quarter turn", "half turn", "full turn")
"""Names of the chart's axes, each from 0 to 1: the radius, and three angles that cover half of the
directions. The flow is odd, so that margins at a state and at its opposite are equal."""
CHART = Chart(state=tuple(Axis(name, 0.0, 1.0) for name in AXES))
CORE = 0.125
"""Radius below which conditions are about rates along the radius: they vanish at the centre."""
REGIONS = {
    "set": (((0.0, 0.0, 0.0, 0.0), (1.0, 1.0, 1.0, 1.0)),),
    "core": (((0.0, 0.0, 0.0, 0.0), (CORE, 1.0, 1.0, 1.0)),),
    "ring": (((CORE, 0.0, 0.0, 0.0), (1.0, 1.0, 1.0, 1.0)),),
    "face": (((1.0, 0.0, 0.0, 0.0), (1.0, 1.0, 1.0, 1.0)),),
}
"""Boxes of the chart by name; `face` is the set's only one, where the flow must point inward."""
CONDITIONS = {
    "inward": "face",
    "descent": "ring",
    "settling": "core",
    "force": "set",
    "rail": "set",
    "upright": "set",
}
"""Region of each condition; all have the scale 1."""
