"""Statements of a run's proof file, if it is about the run: read again, and believed of no other.

No box is bounded here; `check-proof` does that.
"""

from neuralgaits.certificate.proof_file.consistency import inconsistencies
from neuralgaits.certificate.proof_file.reader import read_claims
from neuralgaits.certificate.proof_file.run_match import differences
from neuralgaits.certificate.proof_file.sampled_bounds import first_broken_bound
from neuralgaits.errors import InputError
from neuralgaits.programs import Program
from neuralgaits.records.certified import PROOF
from neuralgaits.runs import plain
from neuralgaits.runs.shell_words import command, named
from neuralgaits.systems.family_run import FamilyRun
from neuralgaits.systems.proof_model import model_data, trace_conditions


def why_nothing_is_stated(run: FamilyRun) -> str | None:
    """Return why a proof file that is there counts for nothing; None if there is none.

    For whoever has got no bounds from `stated_bounds`.
    """
    if not (run.path / PROOF).exists():
        return None
    again = command("certify", named(run.path))
    return (
        f"{PROOF} is damaged, or about other numbers than the run's: prove it again with `{again}`"
    )


def stated_bounds(run: FamilyRun, program: Program | None = None) -> dict[str, float] | None:
    """Return the bounds that a run's proof file states of its conditions, on all of their regions.

    Args:
        run: the run.
        program: its conditions, traced; None to trace them.

    Returns: None if there is no such file, or if it is about another run or contradicts itself.
    """
    program = trace_conditions(run) if program is None else program
    try:
        claims = read_claims(run.path / PROOF)
        if claims.outline is None or not run.table.is_that_of(claims):
            return None
        if claims.program_hash != program.hash or claims.model != plain(model_data(run, program)):
            return None
        if differences(claims, run.path):
            return None
        if inconsistencies(claims, claims.outline) or first_broken_bound(claims):
            return None
    except InputError:
        return None
    return run.table.stated_bounds(claims)
