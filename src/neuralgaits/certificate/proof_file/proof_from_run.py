"""Build the proof file of a run, with the hashes of the run's files."""

import hashlib
from collections.abc import Mapping
from typing import Any

from neuralgaits.certificate.chart import Chart
from neuralgaits.certificate.proof_file.theorem_tables import Theorems
from neuralgaits.certificate.proof_file.writer import Proof
from neuralgaits.certificate.search.statement_record import StatementRecord
from neuralgaits.programs import Program
from neuralgaits.runs import RunFolder
from neuralgaits.runs.names import ROBOT, SPEC, WEIGHTS

NO_THEOREMS = Theorems()


def proof_of(
    folder: RunFolder,
    program: Program,
    statements: tuple[StatementRecord, ...],
    model: Mapping[str, Any] | None,
    chart: Chart,
    theorems: Theorems = NO_THEOREMS,
) -> Proof:
    """Return a proof about a run of any family: its robot, spec and weights by name and sha256."""
    config, copies = folder.config, folder.copies
    return Proof(
        {"name": str(config["robot"]), "sha256": copies[ROBOT]},
        {"name": str(config["spec"]), "sha256": copies[SPEC]},
        hashlib.sha256((folder.path / WEIGHTS).read_bytes()).hexdigest(),
        program,
        chart,
        statements,
        theorems=theorems.tables(),
        model=model,
    )
