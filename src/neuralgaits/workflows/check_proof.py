"""Check a proof file again, in other arithmetic, and compare it with a run.

Without a run, no JAX is imported, and the best verdict is `consistent`: nothing ties the Program
in the file to a robot. With a run, a separate process traces the Program again from the run's own
robot, spec and weights. If the hash is the same, the statements are about these conditions; each of
the spec's boxes must have one. This is done before the file's boxes are checked, unless the spec is
the run's own: its code runs only after they hold.
"""

import time
from dataclasses import replace
from functools import partial
from pathlib import Path

from neuralgaits.certificate.proof_file.check import (
    ASSUMPTIONS,
    DERIVED_ELSEWHERE,
    OWN_SPEC,
    TRUSTED,
    CheckResult,
    all_in_words,
    check,
    tied,
)
from neuralgaits.certificate.proof_file.reader import Claims, read_claims
from neuralgaits.certificate.proof_file.run_match import differences
from neuralgaits.certificate.run_certificate.run_comparison import RunComparison, compare_with_run
from neuralgaits.errors import RunError
from neuralgaits.records.certified import PROOF
from neuralgaits.records.checked import ProofCheck
from neuralgaits.runs import packed, resolve
from neuralgaits.runs.folder import CONFIG
from neuralgaits.runs.latest import through_latest
from neuralgaits.runs.shell_words import LATEST, command, named
from neuralgaits.settings import CheckProofSettings, called_with
from neuralgaits.systems.family_tasks import family_named


@called_with(CheckProofSettings)
def check_proof(settings: CheckProofSettings) -> ProofCheck:
    """Check a proof file.

    Returns: `ProofCheck`, a mapping of what `check-proof --json` prints: verdict ("proved" with a
        run, "consistent" without; "rejected" or "undecided"), reason (None if proved), reasons
        (each, of a rejection that has several), statements (in words), levels, unclaimed, boxes,
        boxes_in_balls, arithmetic, wall_s, assumptions, proof, run, robot, spec, weights_sha256.
    Raises: InputError in one line if the file is no proof file; RunError if the run does not exist.
    """
    start_time = time.perf_counter()
    file = proof_file_at(settings.file)
    claims = read_claims(file)
    folder = None if settings.run is None else resolve(settings.run).path
    wrong = [] if folder is None else differences(claims, folder)
    runs_own_code = (OWN_SPEC,) if ".py:" in claims.spec[0] else ()
    comparison, own_spec = None, ()
    if folder is not None and not wrong and not runs_own_code:
        # A spec of this package runs no code of the file's author, so the boxes can wait.
        comparison = compare_with_run(claims, folder)
        wrong = list(comparison.wrong)
    ask = partial(check, progress=settings.progress, arithmetic=settings.arithmetic)
    report = _rejected(claims, wrong) if wrong else ask(claims)
    if folder is not None and report.holds:
        report = against(claims, report, comparison or compare_with_run(claims, folder))
        own_spec = runs_own_code
    family, always = family_named((claims.model or {}).get("family")), ASSUMPTIONS
    if family is not None:
        report, always = family.with_levels(report, claims), family.assumptions
    elif not claims.chart.walks:
        # Without a model nothing says what the axes are.
        always = ASSUMPTIONS[0], ASSUMPTIONS[-1]
    always = (*always[:-1], TRUSTED[settings.arithmetic])
    assumed = (*own_spec, *always) if folder is not None else (DERIVED_ELSEWHERE, *always)
    values = {name: value for name, value in vars(report).items() if name != "holds"}
    return ProofCheck(
        proof=str(file),
        run=None if settings.run is None else str(settings.run),
        robot=claims.robot[0],
        spec=claims.spec[0],
        weights_sha256=claims.weights_sha256,
        arithmetic=settings.arithmetic,
        assumptions=assumed,
        wall_s=time.perf_counter() - start_time,
        **values,
    )


def proof_file_at(place: str | Path) -> Path:
    """Find the proof file at a place: a file, the folder of a run, or `latest`.

    Raises: RunError if the run does not exist, or has no proof file.
    """
    path = Path(place)
    if str(place) == LATEST and not path.exists():
        path = resolve(LATEST).path
    if not (path / CONFIG).is_file():
        return through_latest(path)
    proof = path / PROOF
    if not packed.is_there(proof):
        raise RunError(
            f"expected a proof file at {proof}, found none: make one with "
            f"`{command('certify', named(path))}`"
        )
    return proof


def against(claims: Claims, report: CheckResult, comparison: RunComparison) -> CheckResult:
    """Report whether a file whose statements hold is about the run that it was compared with."""
    if comparison.wrong:
        return _rejected(claims, list(comparison.wrong))
    report = tied(report, claims, comparison.outline)
    return report if claims.chart == comparison.chart else _of_part(report, claims)


def _of_part(report: CheckResult, claims: Claims) -> CheckResult:
    """Return the report about a file that covers only a part of the run's commands."""
    axes = " and ".join(claims.chart.intervals())
    reason = f"every statement holds, for {axes} only: part of the gait's commands"
    levels = tuple(replace(one, verdict="consistent") for one in report.levels)
    if report.verdict != "proved":
        return replace(report, levels=levels)
    return replace(report, verdict="undecided", reason=reason, levels=levels)


def _rejected(claims: Claims, wrong: list[str]) -> CheckResult:
    """Return the report about a file that is not about the run."""
    report = CheckResult("rejected", None, all_in_words(claims), (), (), 0)
    return report.rejected(wrong)
