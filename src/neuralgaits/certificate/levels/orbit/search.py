"""Search for the set of level 3, and its premises as functions of a gait."""

import numpy as np
from numpy.polynomial.chebyshev import chebval

from neuralgaits.barriers import Gait
from neuralgaits.certificate.level import Parameters
from neuralgaits.certificate.level_target import (
    LevelSearch,
    Margins,
    PremisePoint,
    SearchResult,
    SearchTarget,
)
from neuralgaits.certificate.levels.orbit.find import (
    ChartFlow,
    Fences,
    find_contraction,
    find_orbit,
)
from neuralgaits.certificate.levels.orbit.margins import margins
from neuralgaits.certificate.levels.walking_set.find import over_all


class OrbitSearch(LevelSearch):
    """Search for a bracket of the orbit and the constants of its contraction."""

    def find(self, target: SearchTarget, parameters: Parameters) -> SearchResult:
        """Find the orbit, or the contraction of all gaits."""
        spec, evaluate = target.spec, target.evaluate
        if spec.commands or spec.parameters or target.floor:
            return find_contraction(over_all(spec, evaluate), parameters[2])
        assert isinstance(target.gait, Gait)
        flow = ChartFlow(evaluate, fences_of(target.gait), float(target.gait.tube.unit))
        return find_orbit(flow, parameters[2])

    def margins(self, point: PremisePoint) -> Margins:
        """Return the margins of the premises of the orbit."""
        return margins(point.gait, point.zd, point.parameters[3], point.u)


def fences_of(gait: Gait) -> Fences:
    """Return the fences of a gait's tube as a function of phases."""
    series = [np.asarray(side) for side in (gait.tube.lower, gait.tube.upper)]

    def fences(phases: np.ndarray) -> np.ndarray:
        return np.stack([chebval(2.0 * phases - 1.0, side) for side in series], axis=1)

    return fences
