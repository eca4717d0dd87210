"""Trace the Program of a gait under its spec once, for every other interpreter."""

from dataclasses import replace

import jax.numpy as jnp
import numpy as np

from neuralgaits._types import Array, Float
from neuralgaits.barriers import Gait, GaitSpec
from neuralgaits.barriers.functions import (
    foot_height,
    output_mismatch,
    rate_mismatch,
)
from neuralgaits.certificate.chart import PLANE
from neuralgaits.errors import SpecError
from neuralgaits.gait import NO_RESIDUALS, Residuals, ZeroDynamics
from neuralgaits.gait.believed_robot import robot_of_step
from neuralgaits.gait.commands import Pair, all_pairs
from neuralgaits.gait.policies.commanded_gait import AnyGait
from neuralgaits.gait.stepping_robot import SteppingRobot
from neuralgaits.programs import POINT, Program, evaluate
from neuralgaits.programs.tracing.tracer import trace
from neuralgaits.robots.mjcf.parameters import RobotFamily, model_of, nominal_robot


def trace_spec(
    spec: GaitSpec, robot: SteppingRobot, gait: AnyGait, residuals: Residuals = NO_RESIDUALS
) -> Program:
    """Trace margins of all conditions as a Program of the chart point u.

    Raises: SpecError naming the operation and line that cannot be traced.
    """
    model = model_of(robot, spec.parameters)

    def margins(u):
        step, zd = step_at(model, gait, u, residuals)
        return spec.margins(step, zd, u[:PLANE])

    return trace(margins, {"u": (spec.chart_size,)}, parameters=gait)


def step_at(
    model: SteppingRobot | RobotFamily,
    gait: AnyGait,
    u: Float[Array, " n"],
    residuals: Residuals = NO_RESIDUALS,
) -> tuple[Gait, ZeroDynamics]:
    """Return gait and zero dynamics of a chart point's step, as one smooth formula.

    Where commands move both ends of a step, phases are relative to the chart point's. Axes behind
    those of commands are parameters of the robot, which the policy does not know.
    """
    end = PLANE + 2 * len(gait.commands)
    if isinstance(gait, Gait):
        step = gait
    else:
        pair = Pair(u[PLANE:end:2], u[PLANE + 1 : end : 2])
        step = gait.of_pair(nominal_robot(model), pair, residuals.reset, exact=True, bounded=True)
        start, guard = step.span
        anchor = jnp.stack([u[0], start + u[0] * (guard - start)])
        step = replace(step, policy=replace(step.policy, anchor=anchor))
    return step, ZeroDynamics(robot_of_step(model, step, u[end:]), step.policy, *residuals)


def after_impact(
    robot: SteppingRobot, gait: AnyGait, residuals: Residuals = NO_RESIDUALS
) -> dict[str, float] | None:
    """Return the outputs' errors after the exact impact, the worst over the end of the tube.

    Zero to rounding for a hybrid-invariant policy whose end points lie inside its bounds.

    Returns: output_rad, rate_rad_s, foot_height_m; None if the policy cannot be traced.
    """

    def errors(u):
        step, zd = step_at(robot, gait, u, residuals)
        point = zd.point(step.z(u[:PLANE]))
        return {
            "output_rad": output_mismatch(point),
            "rate_rad_s": rate_mismatch(point),
            "foot_height_m": foot_height(point),
        }

    try:
        program = trace(errors, {"u": (PLANE + 2 * len(gait.commands),)})
    except SpecError:
        return None
    guard_levels = 33  # Number of levels of the guard at which the impact is evaluated.
    guard = np.stack([np.ones(guard_levels), np.linspace(0.0, 1.0, guard_levels)], axis=1)
    pairs = all_pairs(gait.commands, 2)
    guard = np.concatenate([np.hstack([guard, np.tile(v, (guard_levels, 1))]) for v in pairs])
    # Commands at which the robot has no such posture give NaN, which the caller judges.
    with np.errstate(invalid="ignore"):
        values = evaluate(program, {"u": guard}, POINT)
    return {name: float(np.max(np.abs(value))) for name, value in values.items()}
