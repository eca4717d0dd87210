"""The full-order theorem of a gait (level 4): constants found at points, premises proved."""

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import jax
import numpy as np
from threadpoolctl import threadpool_limits

from neuralgaits.certificate.levels.chart import PLAIN
from neuralgaits.certificate.levels.full_order.conclude import LEVEL, conclude_full_order
from neuralgaits.certificate.levels.full_order.find import Look, Looks, find_full_order
from neuralgaits.certificate.levels.full_order.margins import FullOrderModel, margins
from neuralgaits.certificate.levels.full_order.theorem import FullOrder, premises, series
from neuralgaits.certificate.levels.premises import proved_bounds
from neuralgaits.certificate.proof_file.writer import Statement, prove
from neuralgaits.certificate.search.branch_and_bound import Confirm
from neuralgaits.certificate.search.problem import Problem
from neuralgaits.certificate.search.schedule import Progress, box_count, explore
from neuralgaits.programs import POINT, Program, evaluate, fold
from neuralgaits.programs.prune import prune
from neuralgaits.programs.tracing.tracer import trace
from neuralgaits.records.certified import Conclusion, Counterexample

BUDGET_S = 240.0
"""Seconds that all attempts together may take."""
SHARES = (0.6, 0.3, 0.1)
"""Shares of the largest radius seen at points that are tried, one after the other."""
TIGHT = 0.25
"""Share of the smallest margin seen that is proved: slack is told, and each further box costs."""
CLAIMED = 0.4
"""Share of a premise's margin that is claimed: its size matters little, its boxes are checked."""
REGION = "full order"

_TOGETHER = {
    "full/contact": "forces",
    "full/torque": "forces",
    "full/gain": "impact",
    "full/landing-slope": "impact",
    "full/reset-slope": "impact",
    "full/coupling": "coupling",
}
"""Outputs that share most of their operations, and many of those: they are bounded apart."""


@dataclass(frozen=True)
class FullOrderResult:
    """What was proved at full order.

    Attributes:
        conclusion: verdict, statement in words, all constants by name; if it is undecided, the
            obstacles and their size.
        shape: the set with its constants; None if none was found.
        program: whose outputs the statements are about; a function of u and xi.
        statements: the premises.
        boxes: how many boxes were bounded.
        wall_s: seconds taken.
    """

    conclusion: Conclusion
    shape: FullOrder | None
    program: Program | None
    statements: tuple[Statement, ...]
    boxes: int
    wall_s: float


def full_order(
    model: FullOrderModel,
    *,
    budget: float = BUDGET_S,
    progress: Progress | None = None,
) -> FullOrderResult:
    """Prove the paper's Theorem 5 for a gait, with computed constants and across impacts.

    Args:
        model: robot, gait and spec at full order, w a number.
        budget: seconds for all attempts.
        progress: called with (proved share, boxes) now and then.

    Raises: SpecError if a barrier of the spec or the policy cannot be traced.
    """
    began = time.perf_counter()
    looks, best = looks_of(model), None
    for number, share in enumerate(SHARES):
        shape = find_full_order(looks, model.names, float(model.bandwidth), share)
        if isinstance(shape, str):
            found = _nothing(shape, began)
        else:
            spent = time.perf_counter() - began
            turn = max(budget - spent, 0.0) * (0.5 if number + 1 < len(SHARES) else 1.0)
            found = prove_full_order(model, shape, time.monotonic() + turn, progress)
        best = found if best is None or found.conclusion.verdict == "proved" else best
        if best.conclusion.verdict == "proved" or found.shape is None:
            break
    assert best is not None
    seconds = time.perf_counter() - began
    return FullOrderResult(
        best.conclusion, best.shape, best.program, best.statements, best.boxes, seconds
    )


def _nothing(reason: str, began: float) -> FullOrderResult:
    """Undecided, with no set to speak of."""
    conclusion = Conclusion(LEVEL, "undecided", reason, (), {})
    return FullOrderResult(conclusion, None, None, (), 0, time.perf_counter() - began)


def prove_full_order(
    model: FullOrderModel,
    shape: FullOrder,
    deadline: float,
    progress: Progress | None = None,
) -> FullOrderResult:
    """Prove the premises of a set with given constants, and draw the conclusion."""
    began = time.perf_counter()
    program = trace_full_order(model, shape)
    problems = premise_problems(shape, program)
    with threadpool_limits(1):
        states = explore(
            problems,
            [None] * len(problems),
            _confirmer(program, model),
            deadline=deadline,
            progress=progress,
        )
    pairs = zip(problems, states, strict=True)
    statements = tuple(statement for pair in pairs for statement in prove(*pair))
    conclusion = conclude_full_order(shape, proved_bounds(statements))
    if conclusion.reason is not None and time.monotonic() >= deadline:
        conclusion = replace(conclusion, reason=f"time was up; {conclusion.reason}")
    seconds = time.perf_counter() - began
    return FullOrderResult(conclusion, shape, program, statements, box_count(states), seconds)


def trace_full_order(model: FullOrderModel, shape: FullOrder) -> Program:
    """All margins of the theorem as a Program of u and xi."""
    gait = model.gait
    numbers = {name: np.array(values) for name, values in series(shape).items()}
    return trace(
        lambda u, xi: margins(model, shape, u, xi),
        {"u": (2,), "xi": (model.size,)},
        parameters={"policy": gait.policy, "tube": gait.tube, "full": numbers},
    )


def premise_problems(shape: FullOrder, program: Program) -> list[Problem]:
    """Root boxes with what must hold on each."""
    roots: dict[tuple, list[str]] = {}
    for output, low, high, _ in premises(shape):
        kind = _TOGETHER.get(output.split(" ")[0], "")
        roots.setdefault((kind, low, high), []).append(output)
    return [
        Problem(
            REGION,
            *PLAIN.whole(low, high),
            tuple(names),
            (1.0,) * len(names),
            prune(program, names),
            claimed=CLAIMED,
            tight=TIGHT,
        )
        for (_, low, high), names in roots.items()
    ]


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


def _confirmer(program: Program, model: FullOrderModel) -> Confirm:
    """Asks the Program at eta = 0: a premise that fails there fails."""

    def confirm(name: str, u: np.ndarray) -> Counterexample | None:
        inputs = {"u": u[None], "xi": np.zeros((1, model.size))}
        with np.errstate(all="ignore"):
            margin = float(np.min(evaluate(prune(program, [name]), inputs, POINT)[name]))
        if not margin < 0.0:
            return None
        z1, z2 = np.asarray(model.gait.z(u))
        return Counterexample((float(u[0]), float(u[1])), (float(z1), float(z2)), margin)

    return confirm
