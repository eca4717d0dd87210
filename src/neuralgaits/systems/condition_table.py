"""Chart, regions and conditions of a family's spec, as data. Needs no JAX."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from neuralgaits.certificate.chart import Chart, Corner
from neuralgaits.certificate.proof_file.array_tables import hexes
from neuralgaits.certificate.proof_file.reader import Claims

Regions = Mapping[str, tuple[tuple[Corner, Corner], ...]]
"""Boxes of a chart by the name of their region, each as its lowest and its highest corner."""


@dataclass(frozen=True)
class ConditionTable:
    """The conditions of a spec, each a margin that must not be negative on its region.

    Attributes:
        chart: axes of the states that all conditions are about.
        regions: boxes of the chart by name.
        conditions: name of the region of each condition; all have the scale 1.
    """

    chart: Chart
    regions: Regions
    conditions: Mapping[str, str]

    def model_entries(self) -> dict[str, Any]:
        """Return the entries "regions" and "conditions" of the model of a proof file."""
        return {
            "regions": {
                name: [{"low": hexes(low), "high": hexes(high)} for low, high in boxes]
                for name, boxes in self.regions.items()
            },
            "conditions": {
                name: {"kind": "Margin", "region": region, "scale": 1.0}
                for name, region in self.conditions.items()
            },
        }

    def is_that_of(self, claims: Claims) -> bool:
        """Return whether a proof file is about these conditions on these regions."""
        if claims.outline is None:
            return False
        regions = {name: one.region for name, one in claims.outline.conditions.items()}
        claimed = claims.outline.regions, regions, claims.chart
        return claimed == (self.regions, self.conditions, self.chart)

    def stated_bounds(self, claims: Claims) -> dict[str, float]:
        """Return the bound that a proof file states of each condition on its whole region.

        Conditions that are stated on a part of their region, or not at all, are left out.
        """
        bounds = {}
        for name, region in self.conditions.items():
            boxes = {
                (one.low, one.high): one.bounds[name]
                for one in claims.statements
                if name in one.conditions
            }
            if all(box in boxes for box in self.regions[region]):
                bounds[name] = min(boxes[box] for box in self.regions[region])
        return bounds
