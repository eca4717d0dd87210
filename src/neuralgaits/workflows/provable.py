"""The Program of a gait under its spec: traced once, read by every other interpreter."""

import equinox as eqx
import numpy as np

from neuralgaits.barriers import Gait, GaitSpec
from neuralgaits.barriers.functions import foot_height, output_mismatch, rate_mismatch
from neuralgaits.errors import SpecError
from neuralgaits.gait import Residuals, ZeroDynamics
from neuralgaits.interpreters import POINT, Program, evaluate
from neuralgaits.interpreters.tracer import trace
from neuralgaits.robots import PlanarBiped

LEVELS = 33
"""Levels of the guard at which the impact is looked at."""


NO_RESIDUALS = Residuals()


def trace_spec(
    spec: GaitSpec, robot: PlanarBiped, gait: Gait, residuals: Residuals = NO_RESIDUALS
) -> Program:
    """Margins of all conditions as a Program of the chart point u.

    Raises: SpecError naming the operation and line that cannot be traced.
    """
    zd = ZeroDynamics(robot, gait.policy, *residuals)
    return trace(lambda u: spec.margins(gait, zd, u), {"u": (2,)}, parameters=gait)


def why_not_provable(gait: Gait) -> str | None:
    """None if the policy is smooth, else what is wrong with it."""
    network = getattr(gait.policy, "network", None)
    if network is None or network.activation != "relu":
        return None
    return "the policy's activation is ReLU, whose derivative jumps: use tanh or softplus"


def refuse_untraceable(spec: GaitSpec, robot: PlanarBiped, gait: Gait) -> None:
    """Trace the conditions, a ReLU network replaced by a smooth one.

    Raises: SpecError naming the operation and line of a condition that cannot be traced.
    """
    if why_not_provable(gait) is not None:
        network = gait.policy.network  # pyright: ignore[reportAttributeAccessIssue]
        smooth = type(network)(network.weights, network.biases, "tanh")
        gait = eqx.tree_at(lambda g: g.policy.network, gait, smooth)
    trace_spec(spec, robot, gait)


def after_impact(
    robot: PlanarBiped, gait: Gait, residuals: Residuals = NO_RESIDUALS
) -> dict[str, float] | None:
    """What the real impact leaves of the outputs, the worst over the end of the tube.

    Zero to rounding for a hybrid-invariant policy whose end points lie inside its bounds.

    Returns: output_rad, rate_rad_s, foot_height_m; None if the policy cannot be traced.
    """
    zd = ZeroDynamics(robot, gait.policy, *residuals)

    def errors(u):
        point = zd.point(gait.z(u))
        return {
            "output_rad": output_mismatch(point),
            "rate_rad_s": rate_mismatch(point),
            "foot_height_m": foot_height(point),
        }

    try:
        program = trace(errors, {"u": (2,)})
    except SpecError:
        return None
    guard = np.stack([np.ones(LEVELS), np.linspace(0.0, 1.0, LEVELS)], axis=1)
    values = evaluate(program, {"u": guard}, POINT)
    return {name: float(np.max(np.abs(value))) for name, value in values.items()}
