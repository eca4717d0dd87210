"""Write the certificate of a run, and say what becomes of the proof from before."""

import time
from collections.abc import Mapping, Sequence
from dataclasses import replace

from neuralgaits.analysis.run import Run
from neuralgaits.certificate.levels.level_search import LevelSets
from neuralgaits.certificate.run_certificate.certificate_files import (
    hashes_with,
    write_certificate,
)
from neuralgaits.certificate.run_certificate.earlier import (
    EarlierProof,
    put_hidden_aside,
    saying,
)
from neuralgaits.certificate.run_certificate.scope import Scope
from neuralgaits.certificate.search.statement_record import StatementRecord
from neuralgaits.records import certified
from neuralgaits.records.certified import CertificateRecord, Conclusion, ConditionVerdict
from neuralgaits.runs.names import MAP, MAP_FIGURE
from neuralgaits.runs.plain import to_json
from neuralgaits.workflows.certify_result import CertifyResult

NO_SETS = LevelSets()


def finish_certificate(
    run: Run,
    scope: Scope,
    verdicts: Mapping[str, ConditionVerdict],
    conclusions: Sequence[Conclusion],
    start_time: float,
    files: Mapping[str, bytes],
    *,
    boxes: int = 0,
    reason: str | None = None,
    reached: int = 0,
    sets: LevelSets = NO_SETS,
    statements: Sequence[StatementRecord] = (),
) -> CertifyResult:
    """Write the certificate: `files` by name and the summary; files of an older one are removed.

    A search that came to less leaves the older one; a proof that says what the new one does not
    stays beside it.

    Args:
        run: the run.
        scope: what was to be proved.
        verdicts: verdicts on its conditions.
        conclusions: those of the levels above 1.
        start_time: start time of the command (s, of `time.perf_counter`).
        files: contents of proof file and map, by file.
        boxes: number of boxes that were bounded; 0 if nothing could be traced.
        reason: why something is not decided.
        reached: highest level that is proved of the scope, which may be part of the gait's
            commands.
        sets: sets of the levels.
        statements: statements of the proof file.

    Returns: the result, with words on a proof from before.
    Raises: as `write_certificate`.
    """
    proof = str(run.path / certified.PROOF) if certified.PROOF in files else None
    summary = _judged(
        CertificateRecord(
            run=str(run.path),
            robot=run.asked.robot,
            spec=run.asked.spec,
            verdict="undecided",
            level=scope.level,
            conditions=verdicts,
            levels=tuple(conclusions),
            sha256=hashes_with(run.path, files),
            wall_s=time.perf_counter() - start_time,
            boxes=boxes,
            within=scope.within,
            parameters=dict(scope.box),
            reason=reason,
            proof=proof,
            full_order_proof=proof if sets.full_order else None,
            map=str(run.path / MAP_FIGURE) if MAP in files else None,
        )
    )
    return _beside_earlier(run, summary, files, reached, sets, statements)


def _judged(summary: CertificateRecord) -> CertificateRecord:
    """Return a summary with the verdict on all of its parts."""
    return replace(summary, verdict=summary.of_all)


def _beside_earlier(
    run: Run,
    summary: CertificateRecord,
    files: Mapping[str, bytes],
    reached: int,
    sets: LevelSets,
    statements: Sequence[StatementRecord],
) -> CertifyResult:
    """Write the certificate, unless one from before says more; arguments as above."""
    before = EarlierProof.of(run.folder)
    # Where nothing could be traced, a proof from before would be taken for one of this run.
    if before is not None and summary.boxes and before.stays(summary, reached):
        kept = replace(summary, proof=None, full_order_proof=None, map=None)
        said = f"the certificate from before stays: {before.states}, and {before.checked_how}"
        return CertifyResult(saying(kept, said))
    known = before is None or before.is_said_by(summary, reached, sets.parameters, statements)
    said = _with_proofs_aside(run, summary, None if known else before)
    write_certificate(run.path, files, to_json(summary).encode())
    return CertifyResult(said)


def _with_proofs_aside(
    run: Run, summary: CertificateRecord, unsaid: EarlierProof | None
) -> CertificateRecord:
    """Put proofs that the new one does not say aside, and return the summary with words on them."""
    said = summary
    if unsaid is not None:
        what = "file" if unsaid.summary is None else "proof"
        aside = unsaid.put_aside()
        said = saying(said, f"the {what} from before is now {aside}: {unsaid.states}")
    if (hidden := put_hidden_aside(run.path)) is not None:
        said = saying(said, f"another proof, compressed beside it, is now {hidden}")
    return said
