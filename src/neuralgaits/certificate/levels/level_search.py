"""Sets of the levels above 1: what each level needs of a gait, found at points."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import partial

import jax.numpy as jnp
import numpy as np

from neuralgaits._types import Array, Float
from neuralgaits.barriers import Gait, GaitSpec
from neuralgaits.certificate.chart import PLANE, Chart
from neuralgaits.certificate.level import Parameters
from neuralgaits.certificate.level_target import (
    USUAL_CONTROL,
    ControlAssumption,
    Evaluator,
    SearchTarget,
)
from neuralgaits.certificate.levels.disturbed.search import DisturbedSearch
from neuralgaits.certificate.levels.full_order.search import FullOrderSearch
from neuralgaits.certificate.levels.levels import LEVELS
from neuralgaits.certificate.levels.orbit import return_map
from neuralgaits.certificate.levels.orbit.search import OrbitSearch
from neuralgaits.certificate.levels.walking_set.search import WalkingSetSearch
from neuralgaits.certificate.traced import step_at
from neuralgaits.gait import Residuals, ZeroDynamics
from neuralgaits.gait.policies.commanded_gait import AnyGait
from neuralgaits.programs import POINT, evaluate, fold
from neuralgaits.programs.tracing.tracer import trace
from neuralgaits.records.level_words import FULL_ORDER_LEVEL
from neuralgaits.robots.mjcf.parameters import ParameterAxis, model_of

Errors = tuple[ParameterAxis, ...]
"""Parameters of the robot, as in `GaitSpec.parameters`."""
LEVEL_SEARCHES = {
    2: WalkingSetSearch(),
    3: OrbitSearch(),
    4: FullOrderSearch(),
    5: DisturbedSearch(),
}
"""Search for each level's parameters, by its number."""


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
    control: ControlAssumption = USUAL_CONTROL,
) -> LevelSets:
    """Find the sets of all levels up to the given one.

    Args:
        spec: spec of a run.
        gait: gait of the run.
        zd: zero dynamics with robot and residuals; its policy counts only without commands.
        level: highest level.
        disturbance: see `SearchTarget`.
        floor: see `SearchTarget`.
        control: see `SearchTarget`.

    Raises: SpecError if nothing can be traced.
    """
    disturbed = level > FULL_ORDER_LEVEL
    make_evaluator = partial(evaluator_at, gait, zd, spec.parameters)
    target = SearchTarget(
        spec=spec,
        gait=gait,
        zd=zd,
        make_evaluator=make_evaluator,
        disturbance=disturbance,
        floor=floor,
        disturbed=disturbed,
        control=control,
    )
    parameters, reasons, least = {}, {}, {}
    chart = Chart.of(spec.commands, spec.parameters)
    for entry in LEVELS:
        if entry.number > level or not set(entry.rests_on) <= set(parameters):
            continue
        refusal = entry.refusal(parameters, chart)
        result = refusal or LEVEL_SEARCHES[entry.number].find(target, parameters)
        if isinstance(result, str):
            reasons[entry.number] = result
        else:
            parameters[entry.number], least_of_level = result
            least |= least_of_level
    return LevelSets(parameters, reasons, least)


def evaluator_at(gait: AnyGait, zd: ZeroDynamics, parameters: Errors = ()) -> Evaluator:
    """Return the function from chart points to quantities for finders. Raises: SpecError."""
    size = PLANE + 2 * len(gait.commands) + len(parameters)
    at = one_step(gait, zd, parameters)
    program = trace(lambda u: _quantities(*at(u), u[:PLANE]), {"u": (size,)}, parameters=gait)
    folded = fold(program, POINT)

    def evaluate_at(u: np.ndarray) -> dict[str, np.ndarray]:
        with np.errstate(all="ignore"):
            return evaluate(program, {"u": u}, POINT, folded)

    return evaluate_at


def one_step(
    gait: AnyGait, zd: ZeroDynamics, parameters: Errors = ()
) -> Callable[[Array], tuple[Gait, ZeroDynamics]]:
    """Return the gait and zero dynamics of the step that a chart point belongs to."""
    model = model_of(zd.robot, parameters)
    residuals = Residuals(zd.residual, zd.reset_residual)
    return lambda u: step_at(model, gait, u, residuals)


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
