"""Search for the set of level 5, and its premises as functions of a gait."""

from neuralgaits.barriers import Gait
from neuralgaits.certificate.level import Parameters
from neuralgaits.certificate.level_target import (
    LevelSearch,
    Margins,
    PremisePoint,
    SearchResult,
    SearchTarget,
)
from neuralgaits.certificate.levels.disturbed.find import find_disturbed
from neuralgaits.certificate.levels.disturbed.margins import margins
from neuralgaits.certificate.levels.full_order.model import FullOrderModel
from neuralgaits.certificate.levels.full_order.sample_evaluators import evaluators_in_norm


class DisturbedSearch(LevelSearch):
    """Search of the set under a disturbance."""

    def find(self, target: SearchTarget, parameters: Parameters) -> SearchResult:
        """Find the largest disturbance and hold of the set of level 4."""
        assert isinstance(target.gait, Gait)
        full = parameters[4]
        model = FullOrderModel(target.zd.robot, target.gait, target.spec, full.bandwidth)
        evaluators = evaluators_in_norm(model, full, target.shared.get(4))
        constants = find_disturbed(evaluators, full, target.control, target.gains)
        return constants if isinstance(constants, str) else (constants, {})

    def margins(self, point: PremisePoint) -> Margins:
        """Return the margins of the premises of the set under a disturbance."""
        model = FullOrderModel(point.zd.robot, point.gait, point.spec)
        return margins(model, point.parameters[4], point.parameters[5], point.u, point.xi)
