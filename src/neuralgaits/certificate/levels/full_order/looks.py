"""What the finder of the full-order theorem looks at (level 4), and the set that it settles for."""

from collections.abc import Callable, Mapping

import jax
import numpy as np

from neuralgaits.certificate.levels.full_order.conclude import inequalities, obstacle
from neuralgaits.certificate.levels.full_order.find import Look, Looks, find_full_order
from neuralgaits.certificate.levels.full_order.margins import FullOrderModel
from neuralgaits.certificate.levels.full_order.theorem import FullOrder
from neuralgaits.programs import POINT, evaluate, fold
from neuralgaits.programs.tracing.tracer import trace

SHARES = (0.6, 0.3, 0.1)
"""Shares of the largest radius seen at points that are tried, one after the other."""


def set_of(model: FullOrderModel) -> FullOrder | str:
    """The largest set tried whose constants fit together, or one sentence that says why none does.

    Raises: SpecError if a barrier of the spec or the policy cannot be traced.
    """
    looks, reason = looks_of(model), ""
    for share in SHARES:
        shape = find_full_order(looks, model.names, float(model.bandwidth), share)
        if isinstance(shape, str):
            return reason or shape
        broken = [obstacle(step) for step in inequalities(shape) if not step.holds]
        if not broken:
            return shape
        reason = reason or "; ".join(broken)
    return reason


def looks_of(model: FullOrderModel) -> Looks:
    """What the finder looks at. Raises: SpecError if it cannot be traced."""

    def step(u, xi):
        def moving(at):
            point = model.point(u, at)
            rest = {"rate": model.rates(point), "reading": model.readings(point)}
            return model.in_step(point) | rest

        found, slopes = moving(xi), jax.jacfwd(moving)(xi)
        found |= {f"{name}/slope": d for name, d in slopes.items()}
        return found | {"h": model.barriers(model.gait.z(u))}

    def guard(u, xi):
        slopes = model.guard_slopes(u, xi)
        found = model.at_impact(model.point(u, xi))
        found |= {f"{name}/slope": d for name, d in slopes.along.items()}
        found |= {"fall": slopes.fall, "foot/slope": slopes.foot}
        return found | {"drift": model.at_crossing(u)[1]}

    return Looks(_look(step, model), _look(guard, model), model.size)


def _look(function: Callable, model: FullOrderModel) -> Look:
    program = trace(function, {"u": (2,), "xi": (model.size,)})
    folded = fold(program, POINT)

    def look(u: np.ndarray, xi: np.ndarray) -> Mapping[str, np.ndarray]:
        with np.errstate(all="ignore"):
            return evaluate(program, {"u": u, "xi": xi}, POINT, folded)

    return look
