"""Level 4: the rigid robot under exact linearisation walks for ever, joints off target included."""

from collections.abc import Iterator

from typing_extensions import override

from neuralgaits.certificate.chart import Chart, Corner
from neuralgaits.certificate.level import Level, Parameters
from neuralgaits.certificate.levels.full_order.conclude import conclude_full_order
from neuralgaits.certificate.levels.full_order.theorem import (
    FullOrderConstants,
    labelled_premises,
    refusal,
    series,
)
from neuralgaits.certificate.premises import Bounds, Boxes
from neuralgaits.records.certified import Conclusion


def refusal_of_full_order(parameters: Parameters, chart: Chart) -> str | None:
    """Explain why the theorems of full order do not cover a chart, or return None."""
    return refusal(chart, parameters[2].floor if 2 in parameters else 0.0)


class FullOrderLevel(Level):
    """Theorem of the full order under exact linearisation."""

    number = 4
    part = "full"
    parameters = FullOrderConstants
    full_order = True

    def constants(self, own: FullOrderConstants) -> dict[str, tuple[float, ...]]:
        """Return the Program's constants of the set."""
        return series(own)

    def premises(
        self, parameters: Parameters, boxes: Boxes
    ) -> Iterator[tuple[str, str, Corner, Corner]]:
        """Return the premises of the set at full order."""
        return labelled_premises(parameters[4])

    def conclude(self, parameters: Parameters, boxes: Boxes, bounds: Bounds) -> Conclusion:
        """Conclude that the set at full order is forward invariant."""
        return conclude_full_order(parameters[4], bounds)

    @override
    def refusal(self, parameters: Parameters, chart: Chart) -> str | None:
        return refusal_of_full_order(parameters, chart)
