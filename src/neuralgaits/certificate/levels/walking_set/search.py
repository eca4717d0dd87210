"""Search for the set of level 2, and its premises as functions of a gait."""

from collections.abc import Mapping
from typing import Any

from neuralgaits.certificate.level import Parameters
from neuralgaits.certificate.level_target import LevelSearch, SearchTarget
from neuralgaits.certificate.levels.walking_set.find import find_set, least_of_inlet
from neuralgaits.certificate.levels.walking_set.margins import margins


def _find(of: SearchTarget, known: Parameters) -> tuple[Any, Mapping[str, float]] | str:
    del known
    found = find_set(of.spec, of.look, of.disturbance, of.floor)
    if isinstance(found, str):
        return found
    return found, least_of_inlet(of.spec, of.look, found)


SEARCH = LevelSearch(
    _find, lambda spec, gait, zd, known, u, xi: margins(spec, gait, zd, known[2], u)
)
