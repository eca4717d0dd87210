"""Prove a cart-pole's run: its conditions on their regions, and what follows."""

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import partial

import jax.numpy as jnp
import numpy as np

from neuralgaits.certificate.levels.conditions.verdicts import verdict_on
from neuralgaits.certificate.proof_file.proof_from_run import proof_of
from neuralgaits.certificate.proof_file.writer import prove
from neuralgaits.certificate.run_certificate.certificate_files import (
    hashes_with,
    refuse_unwritable_certificate,
    write_certificate,
)
from neuralgaits.certificate.run_certificate.earlier import put_hidden_aside
from neuralgaits.certificate.search.branch_and_bound import Search
from neuralgaits.certificate.search.problem import Problem
from neuralgaits.certificate.search.root_turns import box_count, explore
from neuralgaits.programs import Program
from neuralgaits.programs.prune import prune
from neuralgaits.programs.tracing.tracer import trace
from neuralgaits.records.certified import PROOF, CertificateRecord, ConditionVerdict, Counterexample
from neuralgaits.runs.plain import to_json
from neuralgaits.systems.cartpole.balancing import margins
from neuralgaits.systems.cartpole.cartpole_run import CartPoleRun
from neuralgaits.systems.cartpole.cartpole_theorem import conclude
from neuralgaits.systems.cartpole.ellipsoid import direction
from neuralgaits.systems.cartpole.proof_model import model_data
from neuralgaits.systems.cartpole.state_regions import AXES, CHART, CONDITIONS, REGIONS
from neuralgaits.systems.cartpole.stated import stated_bounds

CLAIMED = 0.4
"""Claimed share of a margin: four axes need many boxes, and only the sign matters."""
HIGHEST = 3

Progress = Callable[[float, int], None]
"""Function of the proved share of all regions, and the number of boxes."""


def certify_cartpole(
    run: CartPoleRun,
    *,
    level: int = HIGHEST,
    budget: float | None = None,
    progress: Progress | None = None,
) -> CertificateRecord:
    """Prove the conditions of a run, and levels 2 and 3; write proof and summary.

    Args:
        run: the run.
        level: highest level.
        budget: seconds; None for no limit.
        progress: called now and then.

    Returns: the summary. Proof and summary are in the run's folder.
    """
    start_time = time.perf_counter()
    refuse_unwritable_certificate(run.path)
    program = trace_conditions(run)
    problems = condition_problems(program)
    deadline = time.monotonic() + (np.inf if budget is None else budget)
    states = explore(
        problems,
        [None] * len(problems),
        partial(_counterexample, run),
        deadline=deadline,
        progress=progress,
    )
    by_name = dict(zip(CONDITIONS, zip(problems, states, strict=True), strict=True))
    statements = tuple(one for pair in by_name.values() for one in prove(*pair))
    bounds = {name: one.bounds[name] for one in statements for name in one.conditions}
    verdicts = {name: verdict_on(name, [pair], bounds.get(name)) for name, pair in by_name.items()}
    files = {}
    if statements:
        model = model_data(run, program)
        files[PROOF] = proof_of(run.folder, program, statements, model, CHART).content()
    found = _summary(run, verdicts, bounds, files, level, start_time, states)
    before = _level_of(stated_bounds(run, program) or {}, run.config.rate)
    # A condition that is broken somewhere is stated by no true proof.
    if before > found.proved_level and found.verdict != "refuted":
        # A search that came to less, or was asked for less, leaves the proof that is there.
        kept = f"the proof of level {before} from before stays"
        reason = "; ".join(filter(None, (found.reason, kept)))
        return replace(found, reason=reason, proof=str(run.path / PROOF))
    put_hidden_aside(run.path)
    write_certificate(run.path, files, to_json(found).encode())
    return found


def trace_conditions(run: CartPoleRun) -> Program:
    """Return the margins of a run's conditions as a Program of the chart's point."""
    robot, controller, rate = run.robot, run.controller, run.config.rate
    return trace(
        lambda u: margins(robot, controller, rate, u), {"u": (len(AXES),)}, parameters=controller
    )


def condition_problems(program: Program) -> list[Problem]:
    """Return a problem for each condition: boxes of one do not help another."""
    return [
        Problem(
            region,
            *REGIONS[region][0],
            (name,),
            (1.0,),
            prune(program, [name]),
            claimed=CLAIMED,
            tight=0.0,
        )
        for name, region in CONDITIONS.items()
    ]


def _counterexample(run: CartPoleRun, name: str, u: np.ndarray) -> Counterexample | None:
    """Evaluate a condition's own function at a point of the chart."""
    point = jnp.asarray(u)
    value = float(jnp.min(margins(run.robot, run.controller, run.config.rate, point)[name]))
    if not value < 0.0:
        return None
    x, theta = run.controller.ball.state(point[0], direction(point[1:]))[:2]
    return Counterexample(tuple(map(float, u)), (float(x), float(theta)), value)


def _level_of(bounds: Mapping[str, float], rate: float) -> int:
    """Return the level that stated bounds reach; 0 if a condition has none."""
    if not set(CONDITIONS) <= set(bounds):
        return 0
    return max((one.level for one in conclude(bounds, rate) if one.proved), default=1)


def _summary(
    run: CartPoleRun,
    verdicts: Mapping[str, ConditionVerdict],
    bounds: Mapping[str, float],
    files: Mapping[str, bytes],
    level: int,
    start_time: float,
    states: Sequence[Search],
) -> CertificateRecord:
    """Return the summary of a search."""
    levels = conclude(bounds, run.config.rate, level)
    open_ = [name for name, one in verdicts.items() if one.verdict == "undecided"]
    summary = CertificateRecord(
        run=str(run.path),
        robot=run.config.robot,
        spec=run.config.spec,
        verdict="undecided",
        level=level,
        conditions=verdicts,
        levels=levels,
        sha256=hashes_with(run.path, files),
        wall_s=time.perf_counter() - start_time,
        boxes=box_count(states),
        reason=f"the search ran out of time or boxes at {', '.join(open_)}" if open_ else None,
        proof=str(run.path / PROOF) if files else None,
    )
    return replace(summary, verdict=summary.of_all)
