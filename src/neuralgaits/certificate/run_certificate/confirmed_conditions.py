"""Verdicts on conditions in a run's summary, as far as its proof file agrees with them."""

from collections.abc import Collection, Iterator, Mapping
from dataclasses import replace
from typing import NamedTuple

from neuralgaits.certificate.proof_file.coverage import stated_roots
from neuralgaits.certificate.proof_file.reader import Claims
from neuralgaits.certificate.run_certificate.run_comparison import RunComparison
from neuralgaits.records.certified import PROOF, SUMMARY, ConditionVerdict


class Unfit(Exception):
    """Raised when a certificate contradicts its run. The message gives the contradiction."""


class ProofOfRun(NamedTuple):
    """A proof file about a run's own files, and its comparison with the run."""

    claims: Claims
    comparison: RunComparison


def confirmed_conditions(
    conditions: Mapping[str, ConditionVerdict],
    proof: ProofOfRun | None,
    in_part: Collection[str],
) -> Iterator[tuple[str, ConditionVerdict]]:
    """Return verdicts on conditions; a proved one has a statement on each box of its region.

    A refuted one has none there, and the point that was recorded: nobody evaluates it again here.

    Args:
        conditions: conditions of the summary, by name.
        proof: the run's proof file, if there is one.
        in_part: names of conditions that are proved for some of the gait's commands.

    Raises: Unfit if a verdict contradicts the proof file, or itself.
    """
    statements = {} if proof is None else dict(stated_roots(proof.claims.statements))
    boxes = [] if proof is None else proof.comparison.outline.boxes()
    for name, row in conditions.items():
        _refuse_contradiction(name, row)
        required = [box for box in boxes if box[0] == name]
        bounds = [statements[box].bounds[name] for box in required if box in statements]
        margin = min(bounds) if bounds and len(bounds) == len(required) else None
        if row.verdict == "proved":
            if margin is None:
                raise Unfit(f"{SUMMARY} calls {name} proved, and {PROOF} has no such statement")
            yield name, replace(row, margin=margin, proved_fraction=1.0, undecided_boxes=0)
        elif row.verdict == "refuted" and margin is not None:
            raise Unfit(f"{SUMMARY} calls {name} refuted, and {PROOF} states it everywhere")
        elif row.proved_in_part and name not in in_part:
            yield name, replace(row, margin=None, proved_fraction=0.0)
        else:
            yield name, replace(row, margin=None)


def _refuse_contradiction(name: str, row: ConditionVerdict) -> None:
    """Raise Unfit unless a point with a negative margin refutes a condition, or nothing does."""
    point = row.counterexample
    if (point is not None) != (row.verdict == "refuted"):
        beside = "without a point" if point is None else "with a point that breaks it"
        raise Unfit(f"{SUMMARY} calls {name} {row.verdict} {beside}")
    if point is not None and not point.margin < 0.0:
        raise Unfit(f"{SUMMARY} calls {name} refuted where its margin is {point.margin:g}")
