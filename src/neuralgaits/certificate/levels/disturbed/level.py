"""Level 5: the same under torques that are not exact, or held between ticks."""

from collections.abc import Iterator

from typing_extensions import override

from neuralgaits.certificate.chart import Chart, Corner
from neuralgaits.certificate.level import Level, Parameters
from neuralgaits.certificate.levels.disturbed.conclude import conclude_disturbed
from neuralgaits.certificate.levels.disturbed.theorem import (
    DisturbedConstants,
    labelled_premises,
    series,
)
from neuralgaits.certificate.levels.full_order.level import refusal_of_full_order
from neuralgaits.certificate.premises import Bounds, Boxes
from neuralgaits.records.certified import Conclusion


class DisturbedLevel(Level):
    """Theorem of the full order under a disturbance of the torques."""

    number = 5
    part = "disturbed"
    parameters = DisturbedConstants
    rests_on = (4,)
    full_order = True

    def constants(self, own: DisturbedConstants) -> dict[str, tuple[float, ...]]:
        """Return the Program's constants of the disturbance."""
        return series(own)

    def premises(
        self, parameters: Parameters, boxes: Boxes
    ) -> Iterator[tuple[str, str, Corner, Corner]]:
        """Return the premises of the disturbance beside those of level 4."""
        return labelled_premises(parameters[4], parameters[5])

    def conclude(self, parameters: Parameters, boxes: Boxes, bounds: Bounds) -> Conclusion:
        """Conclude that the set of level 4 is forward invariant under the disturbance."""
        return conclude_disturbed(parameters[4], parameters[5], bounds)

    @override
    def refusal(self, parameters: Parameters, chart: Chart) -> str | None:
        return refusal_of_full_order(parameters, chart)
