"""Functions that the finder of level 4 evaluates, and the choice of the set."""

from collections.abc import Callable, Mapping
from functools import cache, partial

import jax
import jax.numpy as jnp
import numpy as np

from neuralgaits._types import Array
from neuralgaits.certificate.chart import PLANE, Corner
from neuralgaits.certificate.level_target import USUAL_CONTROL, ControlAssumption, grid
from neuralgaits.certificate.levels.full_order.find import find_full_order
from neuralgaits.certificate.levels.full_order.inequalities import inequalities, obstacle
from neuralgaits.certificate.levels.full_order.margins import margins
from neuralgaits.certificate.levels.full_order.measured_state import (
    state_movements,
    weighted_error_slopes,
)
from neuralgaits.certificate.levels.full_order.model import FullOrderModel
from neuralgaits.certificate.levels.full_order.model_samples import sampled_effects, sampled_impacts
from neuralgaits.certificate.levels.full_order.norm import find_plan, find_widest
from neuralgaits.certificate.levels.full_order.norm_plans import Plan
from neuralgaits.certificate.levels.full_order.samples import (
    GaitSamples,
    SampleEvaluator,
    SampleEvaluators,
    WithPushSlopes,
    WithSlopes,
    model_samples,
    sensed_errors,
)
from neuralgaits.certificate.levels.full_order.theorem import (
    FullOrderConstants,
    premises,
    weighting,
)
from neuralgaits.certificate.search.problem import Problem
from neuralgaits.gait.output_laws import ExactLinearisation, OutputLaw
from neuralgaits.programs import POINT, Program, evaluate, fold
from neuralgaits.programs.prune import prune, reading
from neuralgaits.programs.tracing.tracer import trace

EXACT = ExactLinearisation()
SMALL = 1.0 / 200.0
"""Half width of boxes on which premises are tried before any search, in sides of the root."""


def set_of(
    model: FullOrderModel,
    pushed: bool = False,
    widest: bool = False,
    *,
    control: ControlAssumption = USUAL_CONTROL,
    evaluators: SampleEvaluators | None = None,
) -> FullOrderConstants | str:
    """Return the largest set tried whose constants fit together, or a sentence with the reason.

    Args:
        model: model of the gait.
        pushed: try sets for a disturbance first (level 5), in a norm of their own and with a floor.
        widest: try the largest set first, in a norm of its own, and accept more boxes.
        control: assumptions about the controller, for which pushed sets have room.
        evaluators: `evaluators_of` the model, made here if they are not given.

    Raises: SpecError if a barrier of the spec or the policy cannot be traced.
    """
    evaluators = evaluators or evaluators_of(model)
    reason = ""
    w = float(model.bandwidth)
    samples = sample_gait(evaluators, control) if pushed or widest else None
    half_width = SMALL
    plan_shares = (0.8, 0.6, 0.5, 0.4, 0.3, 0.2)  # Shares of the plan that are tried in turn.
    if widest:
        half_width = 1.0 / 800.0  # The size of the widest set costs more boxes.
        plan_shares = tuple(np.round(np.arange(1.0, 0.14, -0.025), 3).tolist())
    plan = None
    if samples is not None:
        plan = find_plan(samples, w, control.error) if pushed else find_widest(samples, w)
    if plan is not None and plan.hold > 0.0 and plan.planned.exact:
        # Bounds are close to what points show there; under another law they are wider.
        plan_shares = (1.0, 0.95, 0.9, *plan_shares)
    tries: list[tuple[float, Plan | None]] = []
    tries += [(1.0, plan.smaller(share)) for share in plan_shares] if plan else []
    # Shares of the largest radius seen at points.
    tries += [(share, None) for share in (0.6, 0.3, 0.1)]
    for share, planned in tries:
        if planned is not None and planned.radius == 0.0:
            continue
        constants = find_full_order(evaluators, model.names, w, share, planned)
        if isinstance(constants, str):
            if planned is None:
                return reason or constants
            continue
        broken = [obstacle(step) for step in inequalities(constants) if not step.holds]
        if not broken and (planned is None or bounded(model, constants, half_width)):
            return constants
        if planned is not None:
            continue
        reason = reason or "; ".join(broken)
    return reason


def evaluators_in_norm(
    model: FullOrderModel, constants: FullOrderConstants, evaluators: SampleEvaluators | None = None
) -> SampleEvaluators:
    """Return the functions to evaluate in the norm of a set.

    Args:
        model: model of the gait, in no norm.
        constants: set of the gait.
        evaluators: `evaluators_of` the model, made here if they are not given.
    """
    plain, joints = evaluators or evaluators_of(model), model.size // 2
    return plain.in_norm(np.array(weighting(constants.weights, joints)))


def bounded(model: FullOrderModel, constants: FullOrderConstants, small: float = SMALL) -> bool:
    """Return whether premises hold on small boxes.

    Outputs are never cut, so smaller boxes gain little.

    Args:
        model: model of the gait.
        constants: set of the gait.
        small: half width of the boxes, in sides of the root.
    """
    program = trace(
        lambda u, xi: margins(model, constants, u, xi), {"u": (PLANE,), "xi": (model.size,)}
    )
    roots: dict[tuple[Corner, Corner], list[str]] = {}
    off_zero = reading(program, "xi")
    for output, low, high, _ in premises(constants):
        if output in off_zero:
            roots.setdefault((low, high), []).append(output)
    for (low, high), names in roots.items():
        ends = np.array(low), np.array(high)
        half = small * (ends[1] - ends[0])
        share = grid(np.linspace(0.0, 1.0, 25), np.linspace(0.0, 1.0, 3))
        at = ends[0] + half + (ends[1] - ends[0] - 2.0 * half) * share
        scales = (1.0,) * len(names)
        problem = Problem("", low, high, tuple(names), scales, prune(program, names))
        if not (problem.bounds(at - half, at + half)[0] >= 0.0).all():
            return False
    return True


def evaluators_of(model: FullOrderModel, law: OutputLaw = EXACT) -> SampleEvaluators:
    """Return the functions that the finder evaluates.

    Each is traced when it is first called: level 4 alone asks for no pushes, level 5 for no guard
    any more. Calls raise SpecError if it cannot be.
    """
    size = model.size
    m = size // 2

    def step(u, xi):
        def moving(at):
            point = model.point(u, at)
            more = {"rate": model.rates(point), "reading": model.readings(point)}
            return model.in_step(point) | more

        quantities = _with_slopes(moving(xi), jax.jacfwd(moving)(xi))
        return quantities | {"h": model.barriers(model.gait.z(u))}

    def guard(u, xi):
        slopes = model.guard_slopes(u, xi)
        quantities = _with_slopes(model.at_impact(model.point(u, xi)), slopes.along)
        quantities |= {"fall": slopes.fall, "foot/slope": slopes.foot}
        return quantities | {"drift": model.at_crossing(u)[1]}

    def kick(u, xi):
        def error(xi, push):
            return law.after_impact(model.point(u, xi), u, push)

        none = jnp.zeros(m)
        slopes = jax.jacfwd(error)(xi, none), jax.jacfwd(error, 1)(xi, none)
        return {"kick": error(xi, none), "kick/slope": slopes[0], "kick/push": slopes[1]}

    off = _evaluator(partial(_pushed, model, law), size + m)
    errors = _evaluator(partial(_sensed, model), size)
    return SampleEvaluators(
        _evaluator(step, size),
        _evaluator(guard, size),
        size,
        lambda u: off(u, np.zeros((len(u), size + m))),
        _evaluator(kick, size),
        lambda u: errors(u, np.zeros((len(u), size))),
        _evaluator(partial(sampled_effects, model), size),
        _evaluator(partial(sampled_impacts, model), size),
    )


def _pushed(model: FullOrderModel, law: OutputLaw, u, xi) -> dict[str, Array]:
    """Return what errors of torques change, by name; the last elements of xi are an error."""
    m = model.size // 2
    at, push = xi[:-m], xi[-m:]

    def forces(push):
        quantities = model.in_step(model.point(u, at, push))
        return {"contact": quantities["contact"], "torque": quantities["torque"]}

    def growth(xi, push):
        return law.growth(model.point(u, xi), u, push)

    def of_law(xi):
        return law.error(model.point(u, xi), u)

    values = {f"{name}/push": d for name, d in jax.jacfwd(forces)(push).items()}
    values |= {"law": of_law(at), "law/slope": jax.jacfwd(of_law)(at)}
    slopes = jax.jacfwd(growth)(at, push), jax.jacfwd(growth, 1)(at, push)
    pushed = slopes[1] - 2.0 * model.bandwidth * jnp.eye(m)
    return values | {"jerk": growth(at, push), "jerk/slope": slopes[0], "jerk/push": pushed}


def _sensed(model: FullOrderModel, u, xi) -> dict[str, Array]:
    """Return what errors of a measured state change, by name."""
    point, none = model.point(u, xi), jnp.zeros(model.size // 2)
    errors = partial(weighted_error_slopes, model, point)
    values = {"error": errors(none), "growth": jax.jacfwd(errors)(none)}
    return values | state_movements(model, point)._asdict()


def _with_slopes(values: Mapping[str, Array], slopes: Mapping[str, Array]) -> dict[str, Array]:
    """Return values with their slopes beside them, by name."""
    return {**values, **{f"{name}/slope": slope for name, slope in slopes.items()}}


def sample_gait(
    evaluators: SampleEvaluators, control: ControlAssumption = USUAL_CONTROL
) -> GaitSamples | None:
    """Evaluate the points that a search for a norm needs; None if the gait has no set at all."""
    levels = np.linspace(0.0, 1.0, 5)
    u = grid(np.linspace(0.0, 1.0, 31), levels)
    impact = grid(np.array([1.0]), levels)
    assert evaluators.pushed is not None
    step, off = evaluators.step(u, np.zeros((len(u), evaluators.size))), evaluators.pushed(u)
    guard = evaluators.guard(impact, np.zeros((len(impact), evaluators.size)))
    if step["pace"].min() <= 0.0 or step["inertia"].min() <= 0.0:
        return None
    phase = u[:, 0]
    risen = 0.06  # Phase until which the foot is assumed to rise; then it is assumed to be up.
    apart = {"foot-rate": phase <= risen, "foot": (phase > risen) & (phase < 0.995)}
    names = ("contact", "torque", *apart)
    value = [np.where(apart[n][:, None], step[n], np.inf) if n in apart else step[n] for n in names]
    pushes = [off[f"{n}/push"] for n in names[:2]]
    pushes.append(np.zeros((len(u), 2, evaluators.size // 2)))
    joints = evaluators.size // 2
    # d torque / d acceleration, in units of the limits: the second half of the torque's slacks.
    inertia = off["torque/push"][:, joints:].mean(axis=0)
    inertia = 0.5 * (inertia + inertia.T)
    if not np.linalg.eigvalsh(inertia).min() > 0.0:
        inertia = np.eye(joints)
    in_xi = np.concatenate([step[f"{n}/slope"] for n in names], axis=1)
    in_push = np.concatenate(pushes, axis=1)
    return GaitSamples(
        slack=WithPushSlopes(
            np.concatenate(value, axis=1), in_xi + in_push @ off["law/slope"], in_push
        ),
        rate=WithSlopes(step["rate"], step["rate/slope"]),
        h=step["h"],
        reading=step["reading/slope"],
        jerk=WithPushSlopes(off["jerk"], off["jerk/slope"], off["jerk/push"]),
        law=WithSlopes(off["law"], off["law/slope"]),
        after=guard["after/slope"],
        reset=guard["reset/slope"],
        inlet=guard["reset"].min(axis=0),
        phase=phase,
        pace=float(step["pace"].max()),
        inertia=inertia,
        kick=_kicks(evaluators, levels) if control.free_clock else None,
        sensed=sensed_errors(evaluators, u, control.state_error),
        model=model_samples(evaluators, u, impact, control.model_box),
    )


def _kicks(evaluators: SampleEvaluators, levels: np.ndarray) -> WithPushSlopes:
    """Return errors right after impacts around phase 1, and their slopes in a push."""
    assert evaluators.kick is not None
    around = grid(np.array([0.995, 1.0, 1.005]), levels)
    impacts = evaluators.kick(around, np.zeros((len(around), evaluators.size)))
    return WithPushSlopes(impacts["kick"], impacts["kick/slope"], impacts["kick/push"])


def _evaluator(function: Callable, size: int) -> SampleEvaluator:
    @cache
    def traced() -> tuple[Program, Mapping[int, np.ndarray]]:
        program = trace(function, {"u": (2,), "xi": (size,)})
        return program, fold(program, POINT)

    def evaluate_at(u: np.ndarray, xi: np.ndarray) -> Mapping[str, np.ndarray]:
        program, folded = traced()
        with np.errstate(all="ignore"):
            return evaluate(program, {"u": u, "xi": xi}, POINT, folded)

    return evaluate_at
