"""Build the proof file of a run, with the hashes of the run's files."""

import hashlib
from collections.abc import Mapping
from typing import Any

from neuralgaits.analysis.run import Run
from neuralgaits.certificate.chart import Chart
from neuralgaits.certificate.proof_file.theorem_tables import Theorems
from neuralgaits.certificate.proof_file.writer import Proof
from neuralgaits.certificate.search.statement_record import StatementRecord
from neuralgaits.programs import Program
from neuralgaits.runs.names import ROBOT, SPEC, WEIGHTS


def proof_of(
    run: Run,
    program: Program,
    statements: tuple[StatementRecord, ...],
    theorems: Theorems,
    model: Mapping[str, Any] | None,
    chart: Chart,
) -> Proof:
    """Return a proof about a run: its robot, spec and weights by name and sha256."""
    asked, copies = run.asked, run.folder.copies
    return Proof(
        {"name": asked.robot, "sha256": copies[ROBOT]},
        {"name": asked.spec, "sha256": copies[SPEC]},
        hashlib.sha256((run.path / WEIGHTS).read_bytes()).hexdigest(),
        program,
        chart,
        statements,
        theorems=theorems.tables(),
        model=model,
    )
