"""Prove a run of a family beside walkers: its conditions on their regions, and what follows."""

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import partial

import jax.numpy as jnp
import numpy as np

from neuralgaits.certificate.levels.conditions.verdicts import Searched, verdict_on
from neuralgaits.certificate.proof_file.proof_from_run import proof_of
from neuralgaits.certificate.proof_file.writer import prove
from neuralgaits.certificate.run_certificate.certificate_files import (
    hashes_with,
    refuse_unwritable_certificate,
    write_certificate,
)
from neuralgaits.certificate.run_certificate.earlier import put_hidden_aside
from neuralgaits.certificate.search.problem import Problem
from neuralgaits.certificate.search.root_turns import box_count, explore
from neuralgaits.certificate.search.statement_record import StatementRecord
from neuralgaits.programs import Program
from neuralgaits.programs.prune import prune
from neuralgaits.records.certified import (
    PROOF,
    CertificateRecord,
    ConditionVerdict,
    Counterexample,
    verdict_of,
)
from neuralgaits.runs.plain import to_json
from neuralgaits.systems.condition_table import ConditionTable
from neuralgaits.systems.family_run import FamilyRun
from neuralgaits.systems.proof_model import model_data, trace_conditions
from neuralgaits.systems.run_statements import stated_bounds

SearchProgress = Callable[[float, int], None]
"""Function of the proved share of all regions, and the number of boxes."""


def certify_family(
    run: FamilyRun,
    *,
    level: int | None = None,
    budget: float | None = None,
    progress: SearchProgress | None = None,
) -> CertificateRecord:
    """Prove the conditions of a run, and its levels; write proof and summary.

    Args:
        run: the run.
        level: highest level; None for all.
        budget: seconds; None for no limit.
        progress: called now and then.

    Returns: the summary. Proof and summary are in the run's folder.
    """
    start_time, table = time.perf_counter(), run.table
    refuse_unwritable_certificate(run.path)
    program = trace_conditions(run)
    searched = _search(run, program, budget, progress)
    statements = tuple(one for pair in searched for one in prove(*pair))
    files = {}
    if statements:
        model = model_data(run, program)
        proof = proof_of(run.folder, program, statements, model, table.chart)
        files[PROOF] = proof.content()
    bounds, verdicts = _verdicts(table, searched, statements)
    to = int(run.system.highest) if level is None else level
    levels = run.system.conclude(bounds, run.config, to)
    open_ = [name for name, one in verdicts.items() if one.verdict == "undecided"]
    certificate = CertificateRecord(
        run=str(run.path),
        robot=run.config.robot,
        spec=run.config.spec,
        verdict=verdict_of(verdicts, levels),
        level=to,
        conditions=verdicts,
        levels=levels,
        sha256=hashes_with(run.path, files),
        wall_s=time.perf_counter() - start_time,
        boxes=box_count([state for _, state in searched]),
        reason=f"the search ran out of time or boxes at {', '.join(open_)}" if open_ else None,
        proof=str(run.path / PROOF) if files else None,
    )
    before = _level_of(run, stated_bounds(run, program) or {})
    # A condition that is broken somewhere is stated by no true proof.
    if before > certificate.proved_level and certificate.verdict != "refuted":
        # A search that came to less, or was asked for less, leaves the proof that is there.
        sentence = f"the proof of level {before} from before stays"
        reason = "; ".join(filter(None, (certificate.reason, sentence)))
        return replace(certificate, reason=reason, proof=str(run.path / PROOF))
    put_hidden_aside(run.path)
    write_certificate(run.path, files, to_json(certificate).encode())
    return certificate


def _search(
    run: FamilyRun, program: Program, budget: float | None, progress: SearchProgress | None
) -> list[Searched]:
    problems = condition_problems(program, run.table, run.system.claimed)
    states = explore(
        problems,
        [None] * len(problems),
        partial(_counterexample, run),
        deadline=time.monotonic() + (np.inf if budget is None else budget),
        progress=progress,
    )
    return list(zip(problems, states, strict=True))


def condition_problems(program: Program, table: ConditionTable, claimed: float) -> list[Problem]:
    """Return a problem for each box of each condition: boxes of one do not help another.

    Args:
        program: margins of the conditions.
        table: regions of the conditions.
        claimed: share of a margin that the proof claims.
    """
    return [
        Problem(
            region, low, high, (name,), (1.0,), prune(program, [name]), claimed=claimed, tight=0.0
        )
        for name, region in table.conditions.items()
        for low, high in table.regions[region]
    ]


def _verdicts(
    table: ConditionTable, searched: Sequence[Searched], statements: Sequence[StatementRecord]
) -> tuple[dict[str, float], dict[str, ConditionVerdict]]:
    """Return the bounds of the conditions that are proved on all of their region, and verdicts."""
    bound_of_box = {
        (name, one.low, one.high): one.bounds[name] for one in statements for name in one.conditions
    }
    bounds, verdicts = {}, {}
    for name in table.conditions:
        roots = [pair for pair in searched if name in pair[0].names]
        keys = [(name, one.low, one.high) for one, _ in roots]
        if all(key in bound_of_box for key in keys):
            bounds[name] = min(bound_of_box[key] for key in keys)
        verdicts[name] = verdict_on(name, roots, bounds.get(name))
    return bounds, verdicts


def _counterexample(run: FamilyRun, name: str, u: np.ndarray) -> Counterexample | None:
    """Evaluate a condition's own function at a point of the chart."""
    point = jnp.asarray(u)
    value = float(jnp.min(run.system.margins(run, point)[name]))
    if not value < 0.0:
        return None
    return Counterexample(tuple(map(float, u)), run.system.place(run, point), value)


def _level_of(run: FamilyRun, bounds: Mapping[str, float]) -> int:
    """Return the level that stated bounds reach; 0 if a condition has none."""
    system = run.system
    if not set(run.table.conditions) <= set(bounds):
        return 0
    levels = system.conclude(bounds, run.config, system.highest)
    return max((one.level for one in levels if one.proved), default=1)
