"""Margins of a gait's conditions at single states, at the nearest where a condition applies."""

import numpy as np

from neuralgaits._types import Float
from neuralgaits.analysis.point_evaluator import ENDS, PlaneChart, PointEvaluator
from neuralgaits.barriers.spec import GaitSpec
from neuralgaits.viewer.walker import Margins


class StateMargins:
    """Margins of all conditions of a spec.

    Attributes:
        evaluate: evaluator of their quantities; None until it is compiled.
    """

    def __init__(self, spec: GaitSpec, chart: PlaneChart):
        """Prepare for the conditions of a spec on a chart of its tube."""
        self.evaluate: PointEvaluator | None = None
        self._spec, self._chart = spec, chart

    def none(self, why: str) -> Margins:
        """Return no margins, and the reason."""
        count = len(self._spec.conditions)
        return Margins(np.full(count, np.nan), np.zeros(count, dtype=bool), why)

    def at(self, z: Float[np.ndarray, "2"]) -> Margins:
        """Return the margins at a state, or at the nearest states where conditions apply."""
        if self.evaluate is None:
            return self.none("they are still being computed")
        conditions, regions = self._spec.conditions, self._spec.regions
        with np.errstate(all="ignore"):
            here = np.concatenate(self._chart.chart(np.asarray(z)[None]))
            if not np.all(np.isfinite(here)):
                # The fences' series have no meaning there.
                return self.none("the robot's state is far outside of the region")
            nearest = [_nearest(here, regions[condition.region]) for condition in conditions]
            points = np.unique(np.array(nearest), axis=0)
            states = self._chart.z(points[:, 0], points[:, 1])
            # The state itself, not its image in the chart: it may lie outside of it.
            states[(points == here).all(axis=1)] = z
            quantities = self.evaluate(states)
            where = [int(np.flatnonzero((points == one).all(axis=1))[0]) for one in nearest]
            values = [
                float(np.min(quantities[f"margin/{condition.name}"][row]))
                for condition, row in zip(conditions, where, strict=True)
            ]
        within = bool(np.all((here >= -ENDS) & (here <= 1.0 + ENDS)))
        inside = [within and bool(np.all(one == here)) for one in nearest]
        return Margins(np.array(values), np.array(inside, dtype=bool))


def _nearest(here: np.ndarray, boxes) -> tuple[float, float]:
    """Return the nearest (phase, level) in a region's boxes; an axis that a box spans is kept."""

    def within(box) -> tuple[float, float]:
        place = []
        for value, low, high in zip(here, box.low, box.high, strict=True):
            spans = low <= 0.0 and high >= 1.0
            place.append(float(value) if spans else float(min(max(value, low), high)))
        return place[0], place[1]

    return min((within(box) for box in boxes), key=lambda at: float(np.sum((at - here) ** 2)))
