"""Level 3: one periodic orbit attracts the walking set, or walks under the same commands meet."""

from collections.abc import Iterator

from neuralgaits.certificate.chart import Corner
from neuralgaits.certificate.level import Level, Parameters
from neuralgaits.certificate.levels.orbit.conclude import attraction
from neuralgaits.certificate.levels.orbit.theorem import OrbitConstants, labelled_premises
from neuralgaits.certificate.premises import Bounds, Boxes
from neuralgaits.records.certified import Conclusion


class OrbitLevel(Level):
    """Level 3: one periodic orbit attracts every trajectory of the walking set."""

    number = 3
    part = "orbit"
    parameters = OrbitConstants
    rests_on = (2,)

    def premises(
        self, parameters: Parameters, boxes: Boxes
    ) -> Iterator[tuple[str, str, Corner, Corner]]:
        """Return the premises of the orbit beside those of the walking set."""
        return labelled_premises(parameters[2], parameters[3])

    def conclude(self, parameters: Parameters, boxes: Boxes, bounds: Bounds) -> Conclusion:
        """Conclude that walks of the walking set converge."""
        return attraction(parameters[2], parameters[3], bounds)
