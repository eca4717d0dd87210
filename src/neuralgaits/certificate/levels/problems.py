"""Problems of the search: margins of conditions and sets as one Program, and root boxes."""

from typing import Any

import jax.numpy as jnp
import numpy as np

from neuralgaits._types import Array, Float
from neuralgaits.barriers import Gait, GaitSpec
from neuralgaits.certificate.chart import PLANE, PLANE_ONLY, Chart, Corner
from neuralgaits.certificate.level_target import Margins, PremisePoint
from neuralgaits.certificate.levels.disturbed.theorem import REGION as DISTURBED_REGION
from neuralgaits.certificate.levels.full_order.model import size_of
from neuralgaits.certificate.levels.full_order.theorem import REGION as FULL_ORDER_REGION
from neuralgaits.certificate.levels.level_search import LEVEL_SEARCHES, LevelSets, one_step
from neuralgaits.certificate.levels.levels import LEVELS, labelled_premises, refusals
from neuralgaits.certificate.levels.walking_set.theorem import SET
from neuralgaits.certificate.search.branch_and_bound import Confirm
from neuralgaits.certificate.search.problem import Problem
from neuralgaits.certificate.traced import step_at
from neuralgaits.errors import SpecError
from neuralgaits.gait import NO_RESIDUALS, Residuals, ZeroDynamics
from neuralgaits.gait.policies.commanded_gait import AnyGait
from neuralgaits.gait.stepping_robot import SteppingRobot
from neuralgaits.gait.zero_coordinates import momentum_of, position_of
from neuralgaits.programs import Program
from neuralgaits.programs.prune import prune
from neuralgaits.programs.tracing.tracer import trace
from neuralgaits.records.certified import Counterexample
from neuralgaits.robots.mjcf.parameters import model_of

CLAIMED = 0.4
"""Claimed share of a margin whose size does not matter: fewer boxes to check."""
BOUND_SEPARATELY = {
    "full/contact": "forces",
    "full/torque": "forces",
    "disturbed/contact": "forces",
    "disturbed/torque": "forces",
    "disturbed/jerk": "jerk",
    "disturbed/decay": "decay",
    "disturbed/growth-slope": "growth slope",
    "disturbed/jerk-slope": "growth slope",
    "disturbed/jerk-push": "jerk push",
    "disturbed/kick": "kick",
    "disturbed/kick-slope": "kick slope",
    "disturbed/kick-push": "kick",
    "disturbed/state-moves": "state",
    "disturbed/state-error": "state",
    "disturbed/state-growth": "state growth",
    "disturbed/model-moves": "model moves",
    "disturbed/model-moves-slope": "model moves slope",
    "disturbed/model-pushes": "model pushes",
    "disturbed/model-feeds": "model feeds",
    "disturbed/model-errors": "model errors",
    "disturbed/model-slopes": "model slopes",
    "disturbed/model-curvature": "model curvature",
    "disturbed/model-contact": "model forces",
    "disturbed/model-kick-contact": "model forces",
    "disturbed/model-decrease": "model decrease",
    "disturbed/model-impact": "model impact",
    "disturbed/model-impact-slope": "model impact slope",
    "disturbed/model-impulses": "model impulses",
    "disturbed/model-impulse": "model impulse",
    "full/gain": "impact",
    "full/landing-slope": "impact",
    "full/reset-slope": "impact",
    "full/coupling": "coupling",
}
"""Outputs that share most of their operations, and many of those: they are bounded apart."""


def trace_certificate(
    spec: GaitSpec,
    robot: SteppingRobot,
    gait: AnyGait,
    sets: LevelSets,
    residuals: Residuals = NO_RESIDUALS,
) -> Program:
    """Trace the margins of the spec's conditions and the sets, as one Program of chart point u.

    It is a function of xi as well, anywhere in the unit ball, if a set is about outputs off zero.

    Raises: SpecError naming the operation and line that cannot be traced, or a level that does not
        cover such a gait.
    """
    for number, reason in refusals(
        sets.parameters, Chart.of(gait.commands, spec.parameters)
    ).items():
        raise SpecError(f"expected a gait that level {number} is about, found another: {reason}")
    model = model_of(robot, spec.parameters)

    def margins(u, xi=None):
        step, zd = step_at(model, gait, u, residuals)
        return spec.margins(step, zd, u[:PLANE]) | set_margins(spec, step, zd, sets, u, xi)

    inputs = {"u": (spec.chart_size,)}
    if sets.full_order:
        inputs["xi"] = (size_of(robot),)
    parameters = {"policy": gait.policy, "tube": gait.tube}
    return trace(margins, inputs, parameters=parameters | _set_constants(sets))


def _set_constants(sets: LevelSets) -> dict[str, dict[str, np.ndarray]]:
    """Return the parameters of the sets, by the names of the Program's constants."""
    parameters = sets.parameters
    return {
        level.part: {
            name: np.array(value)
            for name, value in level.constants(parameters[level.number]).items()
        }
        for level in LEVELS
        if level.number in parameters
    }


def set_margins(
    spec: GaitSpec,
    gait: Gait,
    zd: ZeroDynamics,
    sets: LevelSets,
    u: Float[Array, " n"],
    xi: Any = None,
) -> Margins:
    """Return margins of the sets at one chart point and one xi, by output name."""
    point, margins = PremisePoint(spec, gait, zd, sets.parameters, u, xi), {}
    for number in sets.parameters:
        margins |= LEVEL_SEARCHES[number].margins(point)
    return margins


def condition_boxes(spec: GaitSpec) -> list[tuple[str, Corner, Corner]]:
    """Return every box of every condition of the spec, by condition name."""
    return [
        (condition.name, box.low, box.high)
        for condition in spec.conditions
        for box in spec.regions[condition.region]
    ]


def condition_problems(
    spec: GaitSpec, program: Program, chart: Chart = PLANE_ONLY
) -> list[Problem]:
    """Return one problem for each box of each region; in more axes, one for each condition.

    In many axes there are many boxes, and the boxes of one condition do not help another.
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
                    coupled_axes=chart.coupled_axes,
                    **how,
                )
                for box in boxes
            ]
    return problems


def confirmer(spec: GaitSpec, gait: AnyGait, zd: ZeroDynamics, sets: LevelSets) -> Confirm:
    """Return a function that evaluates margins in Python, in float64, at a point with xi = 0."""
    conditions = {condition.name: condition for condition in spec.conditions}
    at = one_step(gait, zd, spec.parameters)
    xi = jnp.zeros(size_of(zd.robot))

    def confirm(name: str, u: np.ndarray) -> Counterexample | None:
        step, zd_of_step = at(jnp.asarray(u))
        z = step.z(u[:PLANE])
        if name in conditions:
            condition = conditions[name]
            margin = np.min(condition.margins(zd_of_step.point(z), step)) / condition.scale
        else:
            margin = np.min(set_margins(spec, step, zd_of_step, sets, jnp.asarray(u), xi)[name])
        if not margin < 0.0:
            return None
        state = (float(position_of(z)), float(momentum_of(z)))
        return Counterexample(tuple(map(float, u)), state, float(margin))

    return confirm


def premise_problems(
    spec: GaitSpec, sets: LevelSets, program: Program, chart: Chart = PLANE_ONLY
) -> list[Problem]:
    """Return root boxes of the levels above 1 with the outputs that must hold on each."""
    scales = {condition.name: float(condition.scale) for condition in spec.conditions}
    roots: dict[tuple[str, str, Corner, Corner], list[str]] = {}
    premises = labelled_premises(sets.parameters, condition_boxes(spec))
    for region, name, low, high in premises:
        kind = BOUND_SEPARATELY.get(name.split(" ")[0], "")
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
            coupled_axes=chart.coupled_axes,
            **(_sign_only(spec) if chart.parameters else _how_near(region)),
        )
        for (region, _, low, high), names in roots.items()
    ]


def _sign_only(spec: GaitSpec) -> dict[str, Any]:
    """Return options for many axes: prove the sign, and halve the robot's parameters last.

    A larger margin costs too many boxes there.
    """
    return {"claimed": CLAIMED, "tight": 0.0, "weak_axes": len(spec.parameters)}


def _how_near(label: str) -> dict[str, Any]:
    """Return how closely margins of premises are proved and claimed, in the plane."""
    claimed = Problem.claimed if label == SET else CLAIMED
    # Share of the smallest margin seen that is proved, by label. Level 4 reports its slack, and
    # each further box costs; for the others only the sign matters.
    shares = {SET: Problem.tight, FULL_ORDER_REGION: 0.25, DISTURBED_REGION: 0.0}
    return {"claimed": claimed, "tight": shares.get(label, 0.0)}
