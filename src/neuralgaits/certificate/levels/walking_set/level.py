"""Level 2: every trajectory of the zero dynamics in the walking set walks for ever."""

from collections.abc import Iterator

from neuralgaits.certificate.chart import Corner
from neuralgaits.certificate.level import Level, Parameters
from neuralgaits.certificate.levels.walking_set.conclude import walking
from neuralgaits.certificate.levels.walking_set.theorem import (
    WalkingSetConstants,
    labelled_premises,
)
from neuralgaits.certificate.premises import Bounds, Boxes
from neuralgaits.records.certified import Conclusion


class WalkingSetLevel(Level):
    """Level 2: every trajectory of the zero dynamics in the walking set walks for ever."""

    number = 2
    part = "walking"
    parameters = WalkingSetConstants

    def premises(
        self, parameters: Parameters, boxes: Boxes
    ) -> Iterator[tuple[str, str, Corner, Corner]]:
        """Return the premises of the walking set."""
        return labelled_premises(parameters[2], boxes)

    def conclude(self, parameters: Parameters, boxes: Boxes, bounds: Bounds) -> Conclusion:
        """Conclude that the walking set is forward invariant."""
        return walking(parameters[2], boxes, bounds)
