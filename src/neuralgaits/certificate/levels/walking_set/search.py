"""Search for the set of level 2, and its premises as functions of a gait."""

from collections.abc import Mapping
from typing import Any

from neuralgaits.barriers import Gait, GaitSpec
from neuralgaits.certificate.level import Parameters
from neuralgaits.certificate.level_target import LevelSearch, SearchTarget
from neuralgaits.certificate.levels.walking_set.find import find_set, least_of_inlet
from neuralgaits.certificate.levels.walking_set.margins import margins
from neuralgaits.errors import SpecError
from neuralgaits.gait import ZeroDynamics

FLAT_ON_OTHER_FLOORS = (
    "floors of unknown height are about point feet: a flat foot is level where the floor is meant "
    "to be, and would meet another one with heel or toe first"
)
"""Why there is no walking set of flat feet on such floors."""


def _find(of: SearchTarget, known: Parameters) -> tuple[Any, Mapping[str, float]] | str:
    del known
    if of.floor and of.zd.robot.feet is not None:
        return FLAT_ON_OTHER_FLOORS
    found = find_set(of.spec, of.look, of.disturbance, of.floor)
    if isinstance(found, str):
        return found
    return found, least_of_inlet(of.spec, of.look, found)


def _margins(spec: GaitSpec, gait: Gait, zd: ZeroDynamics, known: Parameters, u, xi):
    del xi
    if known[2].floor and zd.robot.feet is not None:
        raise SpecError(FLAT_ON_OTHER_FLOORS)
    return margins(spec, gait, zd, known[2], u)


SEARCH = LevelSearch(_find, _margins)
