"""The sets of the levels above 1 of a gait: found at points, traced, laid out for the search."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, NamedTuple

import jax.numpy as jnp
import numpy as np
from numpy.polynomial.chebyshev import chebval

from neuralgaits._types import Array, Float
from neuralgaits.barriers import Gait, GaitSpec
from neuralgaits.barriers.regions import AnyGait
from neuralgaits.certificate.levels.chart import PLAIN, PLANE, Chart, Corner
from neuralgaits.certificate.levels.disturbed import margins as disturbed
from neuralgaits.certificate.levels.disturbed.find import find_disturbed
from neuralgaits.certificate.levels.disturbed.theorem import REGION as DISTURBED
from neuralgaits.certificate.levels.full_order import margins as full_order
from neuralgaits.certificate.levels.full_order.looks import looks_in, set_of
from neuralgaits.certificate.levels.full_order.theorem import REGION as FULL_ORDER
from neuralgaits.certificate.levels.ladder import LEVELS, labelled_premises
from neuralgaits.certificate.levels.level import Parameters
from neuralgaits.certificate.levels.orbit import margins as orbit_set
from neuralgaits.certificate.levels.orbit import return_map
from neuralgaits.certificate.levels.orbit.find import Fences, Look, find_contraction, find_orbit
from neuralgaits.certificate.levels.walking_set import margins as walking_set
from neuralgaits.certificate.levels.walking_set.find import (
    find_set,
    least_of_inlet,
    over_all,
)
from neuralgaits.certificate.levels.walking_set.theorem import SET
from neuralgaits.certificate.provable import step_at
from neuralgaits.certificate.search.branch_and_bound import Confirm
from neuralgaits.certificate.search.problem import Problem
from neuralgaits.errors import SpecError
from neuralgaits.gait import Residuals, ZeroDynamics
from neuralgaits.programs import POINT, Program, evaluate, fold
from neuralgaits.programs.prune import prune
from neuralgaits.programs.tracing.tracer import trace
from neuralgaits.records.certified import Counterexample
from neuralgaits.robots import PlanarBiped
from neuralgaits.robots.parameters import Axis, model_of

FULL_ORDER_LEVEL = 4
"""The level whose set the one above it is about."""
CLAIMED = 0.4
"""Share of the margin that is claimed where its size does not matter: fewer boxes to check."""
TIGHT = {SET: Problem.tight, FULL_ORDER: 0.25, DISTURBED: 0.0}
"""Share of the smallest margin seen that is proved, by label: level 4 tells slack, and each further
box costs; of the others the sign is all that matters."""
SIGN_ONLY: dict[str, Any] = {"claimed": CLAIMED, "tight": 0.0}
"""In many axes a larger margin costs too many boxes."""
NO_RESIDUALS = Residuals()
Errors = tuple[Axis, ...]
"""Parameters of the robot, of `GaitSpec.parameters`."""
Margins = dict[str, Float[Array, "..."]]


@dataclass(frozen=True)
class Subject:
    """A gait under its spec, of which sets are looked for.

    Attributes:
        spec, gait, zd: of a run.
        disturbance: bound on what may be added to dz at level 2 (m/s, N m).
        floor: bound on how much higher or lower than meant a foothold may lie [m].
        pushed: whether the set at full order is to stand a disturbance as well (level 5).
    """

    spec: GaitSpec
    gait: AnyGait
    zd: ZeroDynamics
    disturbance: tuple[float, float] = (0.0, 0.0)
    floor: float = 0.0
    pushed: bool = False

    @cached_property
    def look(self) -> Look:
        """What the finders of levels 2 and 3 look at."""
        return look_at(self.gait, self.zd, self.spec.parameters)


class Sought(NamedTuple):
    """What a level of `ladder.LEVELS` is to those who prove it.

    Attributes:
        find: of a subject and the parameters below: parameters, and what outputs that enclose
            constants must reach; or one sentence that says why there are none.
        margins: its premises as functions of all parameters, a chart point and xi of the unit ball.
    """

    find: Callable[[Subject, Parameters], tuple[Any, Mapping[str, float]] | str]
    margins: Callable[[GaitSpec, Gait, ZeroDynamics, Parameters, Array, Array], Margins]


def _find_walking(of: Subject, known: Parameters) -> tuple[Any, Mapping[str, float]] | str:
    del known
    found = find_set(of.spec, of.look, of.disturbance, of.floor)
    if isinstance(found, str):
        return found
    return found, least_of_inlet(of.spec, of.look, found)


def _find_orbit(of: Subject, known: Parameters) -> tuple[Any, Mapping[str, float]] | str:
    if of.spec.commands or of.spec.parameters or of.floor:
        return find_contraction(over_all(of.spec, of.look), known[2])
    assert isinstance(of.gait, Gait)
    return find_orbit(of.look, fences_of(of.gait), float(of.gait.tube.unit), known[2])


def _find_full_order(of: Subject, known: Parameters) -> tuple[Any, Mapping[str, float]] | str:
    del known
    if not isinstance(of.gait, Gait):
        return "it is about gaits without commands"
    if of.zd.residual is not None or of.zd.reset_residual is not None:
        return "it is about the rigid model, and the run's dynamics carry a residual"
    try:
        found = set_of(full_order.FullOrderModel(of.zd.robot, of.gait, of.spec), of.pushed)
    except SpecError as error:  # The levels below read less of the robot.
        return str(error)
    return found if isinstance(found, str) else (found, {})


def _find_disturbed(of: Subject, known: Parameters) -> tuple[Any, Mapping[str, float]] | str:
    assert isinstance(of.gait, Gait)
    model = full_order.FullOrderModel(of.zd.robot, of.gait, of.spec)
    found = find_disturbed(looks_in(model, known[4]), known[4])
    return found if isinstance(found, str) else (found, {})


def _full_order_margins(spec: GaitSpec, gait: Gait, zd: ZeroDynamics, known: Parameters, u, xi):
    model = full_order.FullOrderModel(zd.robot, gait, spec)
    return full_order.margins(model, known[4], u, xi)


def _disturbed_margins(spec: GaitSpec, gait: Gait, zd: ZeroDynamics, known: Parameters, u, xi):
    model = full_order.FullOrderModel(zd.robot, gait, spec)
    return disturbed.margins(model, known[4], known[5], u, xi)


SOUGHT = {
    2: Sought(
        _find_walking,
        lambda spec, gait, zd, known, u, xi: walking_set.margins(spec, gait, zd, known[2], u),
    ),
    3: Sought(
        _find_orbit,
        lambda spec, gait, zd, known, u, xi: orbit_set.margins(gait, zd, known[3], u),
    ),
    4: Sought(
        _find_full_order,
        _full_order_margins,
    ),
    5: Sought(_find_disturbed, _disturbed_margins),
}
"""By number."""


@dataclass(frozen=True)
class Sets:
    """What the levels above 1 are about.

    Attributes:
        parameters: of the levels whose sets were found.
        reasons: why one that was looked for was not found, by level.
        least: what outputs that enclose constants must reach, to be proved; 0 for the others.
    """

    parameters: Parameters = field(default_factory=dict)
    reasons: Mapping[int, str] = field(default_factory=dict)
    least: Mapping[str, float] = field(default_factory=dict)

    @property
    def full_order(self) -> bool:
        """Whether one of them is about outputs off zero."""
        return any(level.full_order for level in LEVELS if level.number in self.parameters)


def find_sets(
    spec: GaitSpec,
    gait: AnyGait,
    zd: ZeroDynamics,
    level: int,
    disturbance: tuple[float, float],
    floor: float = 0.0,
) -> Sets:
    """Look for the sets that a level speaks of.

    Args:
        spec: of a run.
        gait: of the run.
        zd: whose robot and residuals count; its policy only where there are no commands.
        level: up to which.
        disturbance: of `Subject`.
        floor: likewise.

    Raises: SpecError if nothing can be traced.
    """
    of = Subject(spec, gait, zd, disturbance, floor, pushed=level > FULL_ORDER_LEVEL)
    parameters, reasons, least = {}, {}, {}
    for entry in LEVELS:
        if entry.number > level or not set(entry.rests_on) <= set(parameters):
            continue
        found = SOUGHT[entry.number].find(of, parameters)
        if isinstance(found, str):
            reasons[entry.number] = found
        else:
            parameters[entry.number], more = found
            least |= more
    return Sets(parameters, reasons, least)


def look_at(gait: AnyGait, zd: ZeroDynamics, parameters: Errors = ()) -> Look:
    """What the finders look at, as a function of chart points. Raises: SpecError."""
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
    """Gait and zero dynamics of the step that a chart point belongs to."""
    model = model_of(zd.robot, parameters)
    residuals = Residuals(zd.residual, zd.reset_residual)
    return lambda u: step_at(model, gait, u, residuals)


def fences_of(gait: Gait) -> Fences:
    """The fences of a gait's tube as a function of phases."""
    series = [np.asarray(side) for side in (gait.tube.lower, gait.tube.upper)]

    def fences(phases: np.ndarray) -> np.ndarray:
        return np.stack([chebval(2.0 * phases - 1.0, side) for side in series], axis=1)

    return fences


def _quantities(gait: Gait, zd: ZeroDynamics, u: Float[Array, "2"]) -> dict[str, Array]:
    """Flow, swing foot, reset and how trajectories part, at one chart point."""
    point, landed = zd.point(gait.z(u)), return_map.landing(gait, zd, u)
    start, guard = gait.span
    fences = gait.tube.fences(0.0)
    return {
        "foot": point.foot_above_ground,
        "foot_rate": point.foot_lift_rate,
        "pace": point.dz[0] / (guard - start),
        "slope": return_map.slope(gait, point),
        "expansion": return_map.expansion(gait, zd, u),
        "after": jnp.stack([landed.phase, landed.zeta]),
        "stride": jnp.asarray(guard - start),
        "steepness": gait.tube.fence_slopes(u[0]) / (fences[1] - fences[0]),
        "gain": landed.gain,
        "moved_zeta": landed.moved_zeta,
        "moved_z1": landed.moved_z1,
    }


def trace_certificate(
    spec: GaitSpec,
    robot: PlanarBiped,
    gait: AnyGait,
    sets: Sets,
    residuals: Residuals = NO_RESIDUALS,
) -> Program:
    """Margins of the spec's conditions and of the sets, as one Program of the chart point u.

    And of xi, anywhere in the unit ball, if a set is about outputs off zero.

    Raises: SpecError naming the operation and line that cannot be traced.
    """
    model = model_of(robot, spec.parameters)

    def margins(u, xi=None):
        step, zd = step_at(model, gait, u, residuals)
        return spec.margins(step, zd, u[:PLANE]) | set_margins(spec, step, zd, sets, u, xi)

    inputs = {"u": (spec.chart_size,)}
    if sets.full_order:
        inputs["xi"] = (full_order.size_of(robot),)
    parameters = {"policy": gait.policy, "tube": gait.tube}
    return trace(margins, inputs, parameters=parameters | _named(sets))


def _named(sets: Sets) -> dict[str, dict[str, np.ndarray]]:
    """Parameters of the sets under the names that constants of the Program get."""
    known = sets.parameters
    return {
        level.part: {
            name: np.array(value) for name, value in level.constants(known[level.number]).items()
        }
        for level in LEVELS
        if level.number in known
    }


def set_margins(
    spec: GaitSpec, gait: Gait, zd: ZeroDynamics, sets: Sets, u: Float[Array, " n"], xi: Any = None
) -> Margins:
    """Margins of the sets at one chart point and one xi, by output name."""
    found = {}
    for number in sets.parameters:
        found |= SOUGHT[number].margins(spec, gait, zd, sets.parameters, u, xi)
    return found


def condition_boxes(spec: GaitSpec) -> list[tuple[str, Corner, Corner]]:
    """Every box of every condition of the spec, by condition name."""
    return [
        (condition.name, box.low, box.high)
        for condition in spec.conditions
        for box in spec.regions[condition.region]
    ]


def condition_problems(spec: GaitSpec, program: Program, chart: Chart = PLAIN) -> list[Problem]:
    """One for each box of each region that has conditions; in more axes, for each condition.

    In many axes boxes are many, and those that one condition needs are no help to another.
    """
    problems = []
    for region, boxes in spec.regions.items():
        conditions = [c for c in spec.conditions if c.region == region]
        apart = [[c] for c in conditions] if chart.parameters else [conditions]
        for group in filter(None, apart):
            names = tuple(condition.name for condition in group)
            scales = tuple(float(condition.scale) for condition in group)
            part, how = prune(program, names), (_sign_only(spec) if chart.parameters else {})
            problems += [
                Problem(
                    region,
                    *chart.whole(box.low, box.high),
                    names,
                    scales,
                    part,
                    near=chart.near,
                    **how,
                )
                for box in boxes
            ]
    return problems


def confirmer(spec: GaitSpec, gait: AnyGait, zd: ZeroDynamics, sets: Sets) -> Confirm:
    """Asks the margins' own Python functions, in float64, about one point, with outputs zero."""
    conditions = {condition.name: condition for condition in spec.conditions}
    at = one_step(gait, zd, spec.parameters)
    xi = jnp.zeros(full_order.size_of(zd.robot))

    def confirm(name: str, u: np.ndarray) -> Counterexample | None:
        step, moving = at(jnp.asarray(u))
        z = step.z(u[:PLANE])
        if name in conditions:
            condition = conditions[name]
            margin = np.min(condition.margins(step, moving, moving.point(z))) / condition.scale
        else:
            margin = np.min(set_margins(spec, step, moving, sets, jnp.asarray(u), xi)[name])
        if not margin < 0.0:
            return None
        state = (float(z[0]), float(z[1]))
        return Counterexample(tuple(map(float, u)), state, float(margin))

    return confirm


def premise_problems(
    spec: GaitSpec, sets: Sets, program: Program, chart: Chart = PLAIN
) -> list[Problem]:
    """Root boxes of the levels above 1 with what must hold on each."""
    scales = {condition.name: float(condition.scale) for condition in spec.conditions}
    roots: dict[tuple[str, str, Corner, Corner], list[str]] = {}
    found = labelled_premises(sets.parameters, condition_boxes(spec))
    for region, name, low, high in found:
        kind = full_order.APART.get(name.split(" ")[0], "")
        if chart.parameters:
            kind = name
        names = roots.setdefault((region, kind, low, high), [])
        if name not in names:
            names.append(name)
    return [
        Problem(
            region,
            *chart.whole(low, high),
            tuple(names),
            tuple(scales.get(name, 1.0) for name in names),
            prune(program, names),
            least=tuple(sets.least.get(name, 0.0) for name in names),
            near=chart.near,
            **(_sign_only(spec) if chart.parameters else _how_near(region)),
        )
        for (region, _, low, high), names in roots.items()
    ]


def _sign_only(spec: GaitSpec) -> dict[str, Any]:
    """In many axes: the sign is proved, and the robot's parameters are halved last."""
    return {**SIGN_ONLY, "late": len(spec.parameters)}


def _how_near(label: str) -> dict[str, Any]:
    """How near the margins of premises are found and claimed, in the plane."""
    claimed = Problem.claimed if label == SET else CLAIMED
    return {"claimed": claimed, "tight": TIGHT.get(label, 0.0)}
