"""Search for the set of level 3, and its premises as functions of a gait."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.polynomial.chebyshev import chebval

from neuralgaits.barriers import Gait
from neuralgaits.certificate.level import Parameters
from neuralgaits.certificate.level_target import LevelSearch, SearchTarget
from neuralgaits.certificate.levels.orbit.find import Fences, find_contraction, find_orbit
from neuralgaits.certificate.levels.orbit.margins import margins
from neuralgaits.certificate.levels.walking_set.find import over_all


def _find(of: SearchTarget, known: Parameters) -> tuple[Any, Mapping[str, float]] | str:
    if of.spec.commands or of.spec.parameters or of.floor:
        return find_contraction(over_all(of.spec, of.look), known[2])
    assert isinstance(of.gait, Gait)
    return find_orbit(of.look, fences_of(of.gait), float(of.gait.tube.unit), known[2])


def fences_of(gait: Gait) -> Fences:
    """Return the fences of a gait's tube as a function of phases."""
    series = [np.asarray(side) for side in (gait.tube.lower, gait.tube.upper)]

    def fences(phases: np.ndarray) -> np.ndarray:
        return np.stack([chebval(2.0 * phases - 1.0, side) for side in series], axis=1)

    return fences


SEARCH = LevelSearch(_find, lambda spec, gait, zd, known, u, xi: margins(gait, zd, known[3], u))
