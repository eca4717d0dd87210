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
from neuralgaits.systems.cartpole.cartpole_run import CartPoleRun
from neuralgaits.systems.cartpole.proof_model import model_data
from neuralgaits.systems.cartpole.state_regions import CHART, CONDITIONS, REGIONS


def why_nothing_is_stated(run: CartPoleRun) -> str | None:
    """Return why a proof file that is there counts for nothing; None if there is none.

    For whoever has got no bounds from `stated_bounds`.
    """
    if not (run.path / PROOF).exists():
        return None
    again = command("certify", named(run.path))
    return (
        f"{PROOF} is damaged, or about other numbers than the run's: prove it again with `{again}`"
    )


def stated_bounds(run: CartPoleRun, program: Program) -> dict[str, float] | None:
    """Return the bounds that a run's proof file states of its conditions, on all of their regions.

    Args:
        run: the run.
        program: its conditions, traced.

    Returns: None if there is no such file, or if it is about another run or contradicts itself.
    """
    try:
        claims = read_claims(run.path / PROOF)
        if claims.asked is None or claims.chart != CHART or claims.asked.regions != REGIONS:
            return None
        if claims.program_hash != program.hash or claims.model != plain(model_data(run, program)):
            return None
        if differences(claims, run.path):
            return None
        if inconsistencies(claims, claims.asked) or first_broken_bound(claims):
            return None
    except InputError:
        return None
    found = {}
    for one in claims.statements:
        for name in one.conditions:
            if (one.low, one.high) == REGIONS[CONDITIONS[name]][0]:
                found[name] = one.bounds[name]
    return found
