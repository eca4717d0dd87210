"""The conditions of a run as queries for other provers: what `certify` searches at level 1."""

import jax.numpy as jnp

from neuralgaits._types import Array, Float
from neuralgaits.analysis.run import Run
from neuralgaits.certificate.chart import PLANE, Chart
from neuralgaits.certificate.run_certificate.scope import Scope
from neuralgaits.certificate.traced import step_at
from neuralgaits.export.condition_query import (
    ConditionQuery,
    QueryAxis,
    QueryBox,
    file_names,
    one_output,
)
from neuralgaits.gait.commands import Commands
from neuralgaits.programs import Program
from neuralgaits.programs.prune import prune
from neuralgaits.programs.tracing.tracer import trace
from neuralgaits.robots.mjcf.parameters import model_of

CHANGES = "commands/changes"
"""Output that is negative where commands change too much; no condition has a slash in its name."""


def queries_of(run: Run) -> tuple[ConditionQuery, ...]:
    """Return a query for each condition of a run's spec, for all its commands and robots.

    Raises: SpecError naming the operation and line that cannot be traced; InputError for a box of
        robots or floors that no proof covers.
    """
    # Level 1 has no floor of unknown height; its conditions are the same.
    level = 2 if "floor" in run.spec.ground else 1
    scope = Scope.of(run, level, None, None)
    spec, chart = scope.spec, scope.chart
    program, axes = _traced(run, scope), _axes(chart, spec.commands)
    files = file_names(condition.name for condition in spec.conditions)
    queries = []
    for condition in spec.conditions:
        names = (condition.name, *((CHANGES,) if chart.coupled_axes else ()))
        part = prune(program, names)
        value = next(o.value for o in part.outputs if o.name == condition.name)
        queries.append(
            ConditionQuery(
                name=condition.name,
                file=files[condition.name],
                region=condition.region,
                axes=axes,
                boxes=tuple(
                    QueryBox(*chart.whole(box.low, box.high))
                    for box in spec.regions[condition.region]
                ),
                scale=float(condition.scale),
                margins=part.sizes[value],
                program=one_output(part, names),
            )
        )
    return tuple(queries)


def _traced(run: Run, scope: Scope) -> Program:
    """Trace the margins of all conditions, and what is left of the commands' largest changes."""
    model = model_of(run.robot, scope.spec.parameters)
    gait, coupled = run.trained, scope.chart.coupled_axes

    def margins(u: Float[Array, " n"]) -> dict[str, Array]:
        step, zd = step_at(model, gait, u, run.residuals)
        margins_by_name = scope.spec.margins(step, zd, u[:PLANE])
        if not coupled:
            return margins_by_name
        changes = [(u[axes.second] - u[axes.first], axes.change) for axes in coupled]
        left = [most - sign * change for change, most in changes for sign in (1.0, -1.0)]
        return margins_by_name | {CHANGES: jnp.stack(left)}

    parameters = {"policy": gait.policy, "tube": gait.tube}
    return trace(margins, {"u": (scope.spec.chart_size,)}, parameters=parameters)


def _axes(chart: Chart, commands: Commands) -> tuple[QueryAxis, ...]:
    """Describe the axes of the chart: phase, level, commands, parameters of the robot."""
    plane = (
        QueryAxis("phase", "share of the step: 0 at its start, 1 at touchdown"),
        QueryAxis("level", "share of the tube: 0 at its lower fence, 1 at its upper one"),
    )
    command_axes = [
        QueryAxis(f"{command.name} {when}", f"[{command.unit}] {which}")
        for command in commands
        for when, which in (("before", "of the step before"), ("after", "of this step"))
    ]
    errors = [
        QueryAxis(axis.name, "difference from the robot file")
        for axis in chart.parameters[len(command_axes) :]
    ]
    return *plane, *command_axes, *errors
