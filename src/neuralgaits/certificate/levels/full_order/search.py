"""Search for the set of level 4, and its premises as functions of a gait."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from neuralgaits.barriers import Gait, GaitSpec
from neuralgaits.certificate.level import Parameters
from neuralgaits.certificate.level_target import LevelSearch, SearchTarget
from neuralgaits.certificate.levels.full_order.margins import margins
from neuralgaits.certificate.levels.full_order.model import FullOrderModel
from neuralgaits.certificate.levels.full_order.sample_evaluators import EXACT, looks_of, set_of
from neuralgaits.errors import SpecError
from neuralgaits.gait import ZeroDynamics
from neuralgaits.gait.output_laws import ScheduledLaw


def _find(of: SearchTarget, known: Parameters) -> tuple[Any, Mapping[str, float]] | str:
    del known
    assert isinstance(of.gait, Gait)
    if of.zd.residual is not None or of.zd.reset_residual is not None:
        return "it is about the rigid model, and the run's dynamics carry a residual"
    try:
        model = FullOrderModel(of.zd.robot, of.gait, of.spec)
        given = of.control.bandwidth
        if given is not None:
            model = replace(model, bandwidth=given)
        law = EXACT if of.gains is None else ScheduledLaw(of.gains, of.gait)
        of.left[4] = looks = looks_of(model, law)
        free = of.control.free_clock
        found = set_of(model, of.pushed, given is not None, free_clock=free, looks=looks)
    except SpecError as error:  # The levels below read less of the robot.
        return str(error)
    return found if isinstance(found, str) else (found, {})


def _margins(spec: GaitSpec, gait: Gait, zd: ZeroDynamics, known: Parameters, u, xi):
    return margins(FullOrderModel(zd.robot, gait, spec), known[4], u, xi)


SEARCH = LevelSearch(_find, _margins)
