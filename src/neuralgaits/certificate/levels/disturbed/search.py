"""Search for the set of level 5, and its premises as functions of a gait."""

from collections.abc import Mapping
from typing import Any

from neuralgaits.barriers import Gait, GaitSpec
from neuralgaits.certificate.level import Parameters
from neuralgaits.certificate.level_target import LevelSearch, SearchTarget
from neuralgaits.certificate.levels.disturbed.find import find_disturbed
from neuralgaits.certificate.levels.disturbed.margins import margins
from neuralgaits.certificate.levels.full_order.model import FullOrderModel
from neuralgaits.certificate.levels.full_order.sample_evaluators import looks_in
from neuralgaits.gait import ZeroDynamics


def _find(of: SearchTarget, known: Parameters) -> tuple[Any, Mapping[str, float]] | str:
    assert isinstance(of.gait, Gait)
    model = FullOrderModel(of.zd.robot, of.gait, of.spec, known[4].bandwidth)
    looks = looks_in(model, known[4], of.left.get(4))
    free, gains = of.control.free_clock, of.gains
    found = find_disturbed(looks, known[4], free_clock=free, gains=gains)
    return found if isinstance(found, str) else (found, {})


def _margins(spec: GaitSpec, gait: Gait, zd: ZeroDynamics, known: Parameters, u, xi):
    return margins(FullOrderModel(zd.robot, gait, spec), known[4], known[5], u, xi)


SEARCH = LevelSearch(_find, _margins)
