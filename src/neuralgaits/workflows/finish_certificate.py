"""Write the certificate of a run, and say what becomes of the proof from before."""

import time
from collections.abc import Mapping
from dataclasses import replace

from neuralgaits.analysis.run import Run
from neuralgaits.certificate.levels.conditions.verdicts import of_conditions
from neuralgaits.certificate.run_certificate.certificate_files import (
    hashes_with,
    write_certificate,
)
from neuralgaits.certificate.run_certificate.earlier import (
    EarlierProof,
    put_hidden_aside,
    saying,
)
from neuralgaits.certificate.run_certificate.run_proof import RunProof
from neuralgaits.certificate.run_certificate.scope import Scope
from neuralgaits.records import certified
from neuralgaits.records.certified import CertificateRecord, verdict_of
from neuralgaits.runs.names import MAP, MAP_FIGURE
from neuralgaits.runs.plain import to_json
from neuralgaits.workflows.certify_result import CertifyResult


def finish_certificate(
    run: Run, scope: Scope, run_proof: RunProof, start_time: float
) -> CertifyResult:
    """Write the certificate: proof, map and summary; files of an older one are removed.

    A search that came to less leaves the older one; a proof that says what the new one does not
    stays beside it.

    Args:
        run: the run.
        scope: what was to be proved.
        run_proof: what is proved of it.
        start_time: start time of the command (s, of `time.perf_counter`).

    Returns: the result, with words on a proof from before.
    Raises: as `write_certificate`.
    """
    files = _map(run, scope, run_proof) if run_proof.searched and not scope.chart.parameters else {}
    proof = None
    if run_proof.proof is not None:
        files[certified.PROOF], proof = run_proof.proof, str(run.path / certified.PROOF)
    summary = CertificateRecord(
        run=str(run.path),
        robot=run.config.robot,
        spec=run.config.spec,
        verdict=verdict_of(run_proof.verdicts, run_proof.conclusions),
        level=scope.level,
        conditions=run_proof.verdicts,
        levels=tuple(run_proof.conclusions),
        sha256=hashes_with(run.path, files),
        wall_s=time.perf_counter() - start_time,
        boxes=run_proof.boxes,
        within=scope.within,
        parameters=dict(scope.box),
        reason=run_proof.reason,
        proof=proof,
        full_order_proof=proof if run_proof.sets.full_order else None,
        map=str(run.path / MAP_FIGURE) if MAP in files else None,
    )
    return _beside_earlier(run, summary, files, run_proof)


def _map(run: Run, scope: Scope, run_proof: RunProof) -> dict[str, bytes]:
    """Return the contents of the map of all conditions' boxes, by file."""
    # Drawing takes longer to import than small proofs take.
    from neuralgaits.report.figures.map_of_boxes import map_files

    searched = of_conditions(scope.spec, run_proof.searched)
    return map_files(run, [problem for problem, _ in searched], [state for _, state in searched])


def _beside_earlier(
    run: Run, summary: CertificateRecord, files: Mapping[str, bytes], run_proof: RunProof
) -> CertifyResult:
    """Write the certificate, unless one from before says more."""
    reached, parameters = run_proof.reached, run_proof.sets.parameters
    before = EarlierProof.of(run.folder)
    # Where nothing could be traced, a proof from before would be taken for one of this run.
    if before is not None and summary.boxes and before.stays(summary, reached):
        without_files = replace(summary, proof=None, full_order_proof=None, map=None)
        finished = f"the certificate from before stays: {before.states}, and {before.checked_how}"
        return CertifyResult(saying(without_files, finished))
    same = before is None or before.is_said_by(summary, reached, parameters, run_proof.statements)
    finished = _with_proofs_aside(run, summary, None if same else before)
    write_certificate(run.path, files, to_json(summary).encode())
    return CertifyResult(finished)


def _with_proofs_aside(
    run: Run, summary: CertificateRecord, earlier: EarlierProof | None
) -> CertificateRecord:
    """Put proofs that the new one does not say aside, and return the summary with words on them."""
    finished = summary
    if earlier is not None:
        what = "file" if earlier.summary is None else "proof"
        aside = earlier.put_aside()
        finished = saying(finished, f"the {what} from before is now {aside}: {earlier.states}")
    if (hidden := put_hidden_aside(run.path)) is not None:
        finished = saying(finished, f"another proof, compressed beside it, is now {hidden}")
    return finished
