"""The Program of a gait under its spec: traced once, read by every other interpreter."""

import contextlib
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import equinox as eqx
import jax.numpy as jnp
import numpy as np

from neuralgaits._types import Array, Float
from neuralgaits.barriers import AbstractCondition, Gait, GaitSpec, Pointwise, specs, user_code
from neuralgaits.barriers.description import describe_condition
from neuralgaits.barriers.functions import (
    foot_height,
    impulse,
    normal_force,
    output_mismatch,
    rate_mismatch,
)
from neuralgaits.barriers.regions import AnyGait
from neuralgaits.certificate.levels.chart import MOST_AXES, PLANE
from neuralgaits.errors import InputError, NeuralGaitsError, SpecError
from neuralgaits.gait import NO_RESIDUALS, Residuals, ZeroDynamics
from neuralgaits.gait.commands import Pair, all_pairs
from neuralgaits.programs import POINT, Program, evaluate
from neuralgaits.programs.tracing.tracer import trace
from neuralgaits.robots import PlanarBiped
from neuralgaits.robots.parameters import Model, member, model_of, nominal
from neuralgaits.runs import plain

if TYPE_CHECKING:
    from neuralgaits.analysis.run import Run

LEVELS = 33
"""Levels of the guard at which the impact is looked at."""


def trace_spec(
    spec: GaitSpec, robot: PlanarBiped, gait: AnyGait, residuals: Residuals = NO_RESIDUALS
) -> Program:
    """Margins of all conditions as a Program of the chart point u.

    Raises: SpecError naming the operation and line that cannot be traced.
    """
    model = model_of(robot, spec.parameters)

    def margins(u):
        step, zd = step_at(model, gait, u, residuals)
        return spec.margins(step, zd, u[:PLANE])

    return trace(margins, {"u": (spec.chart_size,)}, parameters=gait)


def step_at(
    model: Model, gait: AnyGait, u: Float[Array, " n"], residuals: Residuals = NO_RESIDUALS
) -> tuple[Gait, ZeroDynamics]:
    """Gait and zero dynamics of the step that a chart point belongs to, as one smooth formula.

    Where commands move both ends of a step, phases are told from that of the chart point. Axes
    behind those of commands are parameters of the robot, which the policy does not know.
    """
    end = PLANE + 2 * len(gait.commands)
    if isinstance(gait, Gait):
        step = gait
    else:
        pair = Pair(u[PLANE:end:2], u[PLANE + 1 : end : 2])
        step = gait.of_pair(nominal(model), pair, residuals.reset, exact=True, bounded=True)
        start, guard = step.span
        anchor = jnp.stack([u[0], start + u[0] * (guard - start)])
        step = eqx.tree_at(
            lambda g: g.policy.anchor, step, anchor, is_leaf=lambda leaf: leaf is None
        )
    return step, ZeroDynamics(member(model, u[end:]), step.policy, *residuals)


def why_not_provable(gait: AnyGait) -> str | None:
    """None if the policy is smooth, else what is wrong with it."""
    network = getattr(gait.policy, "network", None)
    if network is None or network.activation != "relu":
        return None
    return "the policy's activation is ReLU, whose derivative jumps: use tanh or softplus"


def why_not_robust(run: "Run") -> str | None:
    """None if a run can be proved for a box of robots, else what stands against it."""
    if run.learned is not None:
        return "one whose dynamics carry a learned residual, which is of one robot"
    if getattr(run.trained.policy, "z2_dependence", True):
        # On the robot z2 would be computed from masses that nobody knows.
        return "a policy of z1 and z2, and z2 depends on masses that the robot does not know"
    return None


def refuse_many_axes(spec: GaitSpec) -> None:
    """Raises: InputError if a spec has more axes than a proof can have."""
    if spec.chart_size > MOST_AXES:
        raise InputError(
            f"expected at most {MOST_AXES - PLANE} parameters and axes of commands in all, found "
            f"{spec.chart_size - PLANE}: this robot has that many; leave one of --parameters out"
        )


def refuse_untraceable(
    spec: GaitSpec, robot: PlanarBiped, gait: AnyGait, file: Path | None = None
) -> None:
    """Trace the conditions, a ReLU network replaced by a smooth one.

    Args:
        spec: of a user.
        robot: that it is evaluated for.
        gait: that it is evaluated on.
        file: that defines the spec, if any.

    Raises: SpecError naming the operation and line of a condition that cannot be traced, or what
        is wrong with one that raises.
    """
    if why_not_provable(gait) is not None:
        network = gait.policy.network  # pyright: ignore[reportAttributeAccessIssue]
        smooth = type(network)(network.weights, network.biases, "tanh")
        gait = eqx.tree_at(lambda g: g.policy.network, gait, smooth)
    try:
        with user_code.blamed():
            trace_spec(spec, robot, gait)
    except NeuralGaitsError:
        raise
    except Exception as error:
        name = _culprit(spec, robot, gait)
        if name is None:
            raise
        raise user_code.miswritten(name, error, file) from error


def _culprit(spec: GaitSpec, robot: PlanarBiped, gait: AnyGait) -> str | None:
    """A condition of the user's own that raises; None if only those of this package do.

    Package code evaluates a number where a function should be, or a bound of the wrong shape: no
    line of the user's is run then, yet it is the user's condition.
    """

    def raises(condition: AbstractCondition) -> bool:
        try:
            trace_spec(replace(spec, conditions=(condition,), weights={}), robot, gait)
        except Exception:
            return True
        return False

    known = _known(robot)
    own = [one for one in spec.conditions if plain(describe_condition(one)) not in known]
    suspect = next(filter(raises, own), None)
    if suspect is None:
        return None
    # What conditions rest on: if that cannot be evaluated, it is not for this one's sake.
    basis = [Pointwise("basis", suspect.region, 1.0, one) for one in (normal_force, impulse)]
    return None if any(map(raises, basis)) else suspect.name


def _known(robot: PlanarBiped) -> list[Any]:
    """The conditions of the built-in specs that there are for a robot, as data."""
    known = []
    for name in specs.DESCRIPTIONS:
        with contextlib.suppress(SpecError):
            known += [plain(describe_condition(one)) for one in specs.load(name, robot).conditions]
    return known


def after_impact(
    robot: PlanarBiped, gait: AnyGait, residuals: Residuals = NO_RESIDUALS
) -> dict[str, float] | None:
    """What the real impact leaves of the outputs, the worst over the end of the tube.

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
    guard = np.stack([np.ones(LEVELS), np.linspace(0.0, 1.0, LEVELS)], axis=1)
    pairs = all_pairs(gait.commands, 2)
    guard = np.concatenate([np.hstack([guard, np.tile(v, (LEVELS, 1))]) for v in pairs])
    values = evaluate(program, {"u": guard}, POINT)
    return {name: float(np.max(np.abs(value))) for name, value in values.items()}
