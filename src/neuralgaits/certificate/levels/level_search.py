"""Sets of the levels above 1: what each level needs of a gait, found at points."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any, NamedTuple

import jax.numpy as jnp
import numpy as np
from numpy.polynomial.chebyshev import chebval

from neuralgaits._types import Array, Float
from neuralgaits.barriers import Gait, GaitSpec
from neuralgaits.certificate.chart import PLANE, Chart
from neuralgaits.certificate.levels.disturbed import margins as disturbed
from neuralgaits.certificate.levels.disturbed.find import find_disturbed
from neuralgaits.certificate.levels.full_order import margins as full_order
from neuralgaits.certificate.levels.full_order.model import FullOrderModel
from neuralgaits.certificate.levels.full_order.sample_evaluators import looks_in, set_of
from neuralgaits.certificate.levels.level import Parameters
from neuralgaits.certificate.levels.levels import LEVELS
from neuralgaits.certificate.levels.orbit import margins as orbit_set
from neuralgaits.certificate.levels.orbit import return_map
from neuralgaits.certificate.levels.orbit.find import (
    Fences,
    find_contraction,
    find_orbit,
)
from neuralgaits.certificate.levels.walking_set import margins as walking_set
from neuralgaits.certificate.levels.walking_set.find import (
    Evaluator,
    find_set,
    least_of_inlet,
    over_all,
)
from neuralgaits.certificate.traced import step_at
from neuralgaits.errors import SpecError
from neuralgaits.gait import Residuals, ZeroDynamics
from neuralgaits.gait.policies.commanded_gait import AnyGait
from neuralgaits.programs import POINT, evaluate, fold
from neuralgaits.programs.tracing.tracer import trace
from neuralgaits.records.levels import FULL_ORDER_LEVEL
from neuralgaits.robots.mjcf.parameters import ParameterAxis, model_of

Errors = tuple[ParameterAxis, ...]
"""Parameters of the robot, as in `GaitSpec.parameters`."""
Margins = dict[str, Float[Array, "..."]]


@dataclass(frozen=True)
class SearchTarget:
    """A gait under its spec, of which sets are looked for.

    Attributes:
        spec, gait, zd: of a run.
        disturbance: bound on what may be added to dz at level 2 (m/s, N m).
        floor: bound on how much higher or lower than meant a foothold may lie [m].
        pushed: whether the set at full order is to stand a disturbance as well (level 5).
        bandwidth: double pole of the outputs at full order, for which the largest set is looked
            for [rad/s]; None for the usual one, and the usual set.
    """

    spec: GaitSpec
    gait: AnyGait
    zd: ZeroDynamics
    disturbance: tuple[float, float] = (0.0, 0.0)
    floor: float = 0.0
    pushed: bool = False
    bandwidth: float | None = None

    @cached_property
    def look(self) -> Evaluator:
        """Return the function that the finders of levels 2 and 3 evaluate."""
        return look_at(self.gait, self.zd, self.spec.parameters)


class LevelSearch(NamedTuple):
    """Search for the set of a level of `levels.LEVELS`, and its premises.

    Attributes:
        find: of a subject and the parameters below: parameters, and what outputs that enclose
            constants must reach; or one sentence that says why there are none.
        margins: its premises as functions of all parameters, a chart point and xi of the unit ball.
    """

    find: Callable[[SearchTarget, Parameters], tuple[Any, Mapping[str, float]] | str]
    margins: Callable[[GaitSpec, Gait, ZeroDynamics, Parameters, Array, Array], Margins]


def _find_walking(of: SearchTarget, known: Parameters) -> tuple[Any, Mapping[str, float]] | str:
    del known
    found = find_set(of.spec, of.look, of.disturbance, of.floor)
    if isinstance(found, str):
        return found
    return found, least_of_inlet(of.spec, of.look, found)


def _find_orbit(of: SearchTarget, known: Parameters) -> tuple[Any, Mapping[str, float]] | str:
    if of.spec.commands or of.spec.parameters or of.floor:
        return find_contraction(over_all(of.spec, of.look), known[2])
    assert isinstance(of.gait, Gait)
    return find_orbit(of.look, fences_of(of.gait), float(of.gait.tube.unit), known[2])


def _find_full_order(of: SearchTarget, known: Parameters) -> tuple[Any, Mapping[str, float]] | str:
    del known
    assert isinstance(of.gait, Gait)
    if of.zd.residual is not None or of.zd.reset_residual is not None:
        return "it is about the rigid model, and the run's dynamics carry a residual"
    try:
        model = FullOrderModel(of.zd.robot, of.gait, of.spec)
        if of.bandwidth is not None:
            model = replace(model, bandwidth=of.bandwidth)
        found = set_of(model, of.pushed, of.bandwidth is not None)
    except SpecError as error:  # The levels below read less of the robot.
        return str(error)
    return found if isinstance(found, str) else (found, {})


def _find_disturbed(of: SearchTarget, known: Parameters) -> tuple[Any, Mapping[str, float]] | str:
    assert isinstance(of.gait, Gait)
    model = FullOrderModel(of.zd.robot, of.gait, of.spec, known[4].bandwidth)
    found = find_disturbed(looks_in(model, known[4]), known[4])
    return found if isinstance(found, str) else (found, {})


def _full_order_margins(spec: GaitSpec, gait: Gait, zd: ZeroDynamics, known: Parameters, u, xi):
    model = FullOrderModel(zd.robot, gait, spec)
    return full_order.margins(model, known[4], u, xi)


def _disturbed_margins(spec: GaitSpec, gait: Gait, zd: ZeroDynamics, known: Parameters, u, xi):
    model = FullOrderModel(zd.robot, gait, spec)
    return disturbed.margins(model, known[4], known[5], u, xi)


LEVEL_SEARCHES = {
    2: LevelSearch(
        _find_walking,
        lambda spec, gait, zd, known, u, xi: walking_set.margins(spec, gait, zd, known[2], u),
    ),
    3: LevelSearch(
        _find_orbit,
        lambda spec, gait, zd, known, u, xi: orbit_set.margins(gait, zd, known[3], u),
    ),
    4: LevelSearch(
        _find_full_order,
        _full_order_margins,
    ),
    5: LevelSearch(_find_disturbed, _disturbed_margins),
}
"""By number."""


@dataclass(frozen=True)
class LevelSets:
    """Parameters of the sets of the levels above 1.

    Attributes:
        parameters: parameters of the levels whose sets exist.
        reasons: why a set could not be found, by level.
        least: lower bounds to be proved of outputs that enclose constants; 0 for the others.
    """

    parameters: Parameters = field(default_factory=dict)
    reasons: Mapping[int, str] = field(default_factory=dict)
    least: Mapping[str, float] = field(default_factory=dict)

    @property
    def full_order(self) -> bool:
        """Return whether one of the sets is about outputs off zero."""
        return any(level.full_order for level in LEVELS if level.number in self.parameters)


def find_sets(
    spec: GaitSpec,
    gait: AnyGait,
    zd: ZeroDynamics,
    level: int,
    disturbance: tuple[float, float],
    floor: float = 0.0,
    bandwidth: float | None = None,
) -> LevelSets:
    """Find the sets of all levels up to the given one.

    Args:
        spec: spec of a run.
        gait: gait of the run.
        zd: zero dynamics with robot and residuals; its policy counts only without commands.
        level: highest level.
        disturbance: see `SearchTarget`.
        floor: see `SearchTarget`.
        bandwidth: see `SearchTarget`.

    Raises: SpecError if nothing can be traced.
    """
    pushed = level > FULL_ORDER_LEVEL
    of = SearchTarget(spec, gait, zd, disturbance, floor, pushed, bandwidth)
    parameters, reasons, least = {}, {}, {}
    chart = Chart.of(spec.commands, spec.parameters)
    for entry in LEVELS:
        if entry.number > level or not set(entry.rests_on) <= set(parameters):
            continue
        refusal = entry.refusal(parameters, chart)
        found = refusal or LEVEL_SEARCHES[entry.number].find(of, parameters)
        if isinstance(found, str):
            reasons[entry.number] = found
        else:
            parameters[entry.number], more = found
            least |= more
    return LevelSets(parameters, reasons, least)


def look_at(gait: AnyGait, zd: ZeroDynamics, parameters: Errors = ()) -> Evaluator:
    """Return the function from chart points to quantities for finders. Raises: SpecError."""
    size = PLANE + 2 * len(gait.commands) + len(parameters)
    at = one_step(gait, zd, parameters)
    program = trace(lambda u: _quantities(*at(u), u[:PLANE]), {"u": (size,)}, parameters=gait)
    folded = fold(program, POINT)

    def look(u: np.ndarray) -> dict[str, np.ndarray]:
        with np.errstate(all="ignore"):
            return evaluate(program, {"u": u}, POINT, folded)

    return look


def one_step(
    gait: AnyGait, zd: ZeroDynamics, parameters: Errors = ()
) -> Callable[[Array], tuple[Gait, ZeroDynamics]]:
    """Return the gait and zero dynamics of the step that a chart point belongs to."""
    model = model_of(zd.robot, parameters)
    residuals = Residuals(zd.residual, zd.reset_residual)
    return lambda u: step_at(model, gait, u, residuals)


def fences_of(gait: Gait) -> Fences:
    """Return the fences of a gait's tube as a function of phases."""
    series = [np.asarray(side) for side in (gait.tube.lower, gait.tube.upper)]

    def fences(phases: np.ndarray) -> np.ndarray:
        return np.stack([chebval(2.0 * phases - 1.0, side) for side in series], axis=1)

    return fences


def _quantities(gait: Gait, zd: ZeroDynamics, u: Float[Array, "2"]) -> dict[str, Array]:
    """Return flow, swing foot, reset and rate of parting, at one chart point."""
    point, landed = zd.point(gait.z(u)), return_map.landing(gait, zd, u)
    fences = gait.tube.fences(0.0)
    return {
        "foot": point.foot_above_ground,
        "foot_rate": point.foot_lift_rate,
        "pace": gait.pace(point.dz),
        "slope": return_map.slope(gait, point),
        "expansion": return_map.expansion(gait, zd, u),
        "after": jnp.stack([landed.phase, landed.zeta]),
        "stride": jnp.asarray(gait.stride),
        "steepness": gait.tube.fence_slopes(u[0]) / (fences[1] - fences[0]),
        "gain": landed.gain,
        "moved_zeta": landed.moved_zeta,
        "moved_z1": landed.moved_z1,
    }
