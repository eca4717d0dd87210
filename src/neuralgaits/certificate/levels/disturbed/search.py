"""Search for the set of level 5, and its premises as functions of a gait."""

from typing import Any

from neuralgaits._types import Array
from neuralgaits.barriers import Gait, GaitSpec
from neuralgaits.certificate.level import Parameters
from neuralgaits.certificate.level_target import LevelSearch, Margins, SearchResult, SearchTarget
from neuralgaits.certificate.levels.disturbed.find import find_disturbed
from neuralgaits.certificate.levels.disturbed.margins import margins
from neuralgaits.certificate.levels.full_order.model import FullOrderModel
from neuralgaits.certificate.levels.full_order.sample_evaluators import evaluators_in_norm
from neuralgaits.gait import ZeroDynamics


class DisturbedSearch(LevelSearch):
    """Search of the set under a disturbance."""

    def find(self, target: SearchTarget, parameters: Parameters) -> SearchResult:
        """Find the largest disturbance and hold of the set of level 4."""
        assert isinstance(target.gait, Gait)
        full = parameters[4]
        model = FullOrderModel(target.zd.robot, target.gait, target.spec, full.bandwidth)
        evaluators = evaluators_in_norm(model, full, target.shared.get(4))
        free, gains = target.control.free_clock, target.gains
        constants = find_disturbed(evaluators, full, free_clock=free, gains=gains)
        return constants if isinstance(constants, str) else (constants, {})

    def margins(
        self,
        spec: GaitSpec,
        gait: Gait,
        zd: ZeroDynamics,
        parameters: Parameters,
        u: Array,
        xi: Any,
    ) -> Margins:
        """Return the margins of the premises of the set under a disturbance."""
        model = FullOrderModel(zd.robot, gait, spec)
        return margins(model, parameters[4], parameters[5], u, xi)
