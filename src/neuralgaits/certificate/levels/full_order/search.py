"""Search for the set of level 4, and its premises as functions of a gait."""

from dataclasses import replace

from neuralgaits.barriers import Gait
from neuralgaits.certificate.level import Parameters
from neuralgaits.certificate.level_target import (
    LevelSearch,
    Margins,
    PremisePoint,
    SearchResult,
    SearchTarget,
)
from neuralgaits.certificate.levels.full_order.margins import margins
from neuralgaits.certificate.levels.full_order.model import FullOrderModel
from neuralgaits.certificate.levels.full_order.sample_evaluators import EXACT, evaluators_of, set_of
from neuralgaits.errors import SpecError
from neuralgaits.gait.output_laws import ScheduledLaw


class FullOrderSearch(LevelSearch):
    """Search of the set at full order."""

    def find(self, target: SearchTarget, parameters: Parameters) -> SearchResult:
        """Find the set of the theorem."""
        assert isinstance(target.gait, Gait)
        if target.zd.residual is not None or target.zd.reset_residual is not None:
            return "it is about the rigid model, and the run's dynamics carry a residual"
        control = target.control
        try:
            model = FullOrderModel(target.zd.robot, target.gait, target.spec)
            if control.bandwidth is not None:
                model = replace(model, bandwidth=control.bandwidth)
            law = EXACT if target.gains is None else ScheduledLaw(target.gains, target.gait)
            target.shared[4] = evaluators = evaluators_of(model, law)
            constants = set_of(
                model,
                target.disturbed,
                control.bandwidth is not None,
                control=control,
                evaluators=evaluators,
            )
        except SpecError as error:  # The levels below read less of the robot.
            return str(error)
        return constants if isinstance(constants, str) else (constants, {})

    def margins(self, point: PremisePoint) -> Margins:
        """Return the margins of the premises of the set at full order."""
        model = FullOrderModel(point.zd.robot, point.gait, point.spec)
        return margins(model, point.parameters[4], point.u, point.xi)
