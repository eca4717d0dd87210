"""Search for the set of level 2, and its premises as functions of a gait."""

from neuralgaits.certificate.level import Parameters
from neuralgaits.certificate.level_target import (
    LevelSearch,
    Margins,
    PremisePoint,
    SearchResult,
    SearchTarget,
)
from neuralgaits.certificate.levels.walking_set.find import find_set, least_of_inlet
from neuralgaits.certificate.levels.walking_set.margins import margins
from neuralgaits.errors import SpecError

FLAT_ON_OTHER_FLOORS = (
    "floors of unknown height are about point feet: a flat foot is level where the floor is meant "
    "to be, and would meet another one with heel or toe first"
)
"""Why there is no walking set of flat feet on such floors."""


class WalkingSetSearch(LevelSearch):
    """Search for the strips and the floor that the walking set needs beside its conditions."""

    def find(self, target: SearchTarget, parameters: Parameters) -> SearchResult:
        """Find the walking set, and how far inside its inlet landings must be."""
        if target.floor and target.zd.robot.feet is not None:
            return FLAT_ON_OTHER_FLOORS
        constants = find_set(target.spec, target.evaluate, target.disturbance, target.floor)
        if isinstance(constants, str):
            return constants
        return constants, least_of_inlet(target.spec, target.evaluate, constants)

    def margins(self, point: PremisePoint) -> Margins:
        """Return the margins of the premises of the walking set."""
        constants = point.parameters[2]
        if constants.floor and point.zd.robot.feet is not None:
            raise SpecError(FLAT_ON_OTHER_FLOORS)
        return margins(point.spec, point.gait, point.zd, constants, point.u)
