"""Verbs on systems beside walkers: carried out by their families, and shown."""

from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial
from typing import Any

from rich.text import Text

from neuralgaits.cli.arguments import CheckProofOptions, ViewOptions
from neuralgaits.cli.outcome import Outcome
from neuralgaits.cli.proof_screen import show_proof
from neuralgaits.cli.screen_tables import show_facts, show_sentence, show_table
from neuralgaits.records.certified import CertificateRecord
from neuralgaits.systems.family_tasks import task_of
from neuralgaits.systems.system_family import ProgressCallbacks, VerbResult


def outcome_of_family(verb: Any, name: str) -> Outcome | None:
    """Carry out a verb about a system of a family beside walkers; None if it is about a walker."""
    if isinstance(verb, CheckProofOptions | ViewOptions):
        # A proof file says itself what it is about; a page is served, not shown.
        return None
    task = task_of(name, verb)
    if task is None:
        return None
    with _progress(name, quiet=verb.output.json) as progress:
        result = task(progress)
    show = partial(_show, result)
    if not isinstance(result.result, CertificateRecord):
        return Outcome(result.result, good=result.good, table=show, undecided=result.undecided)
    return Outcome(
        result.result,
        good=result.good,
        table=show_proof,
        undecided=result.undecided,
        brief=show,
    )


def _show(outcome: VerbResult, result: Any, *, hint: bool = True) -> None:
    """Show the answer of a family's verb, then its screen."""
    del result, hint
    screen = outcome.screen
    if screen.answer:
        colour = "green" if outcome.good else "yellow" if outcome.undecided else "red"
        show_sentence(Text(screen.answer, colour), screen.sentence)
    if screen.table is not None:
        show_table(*screen.table)
    show_facts(screen.facts)


@contextmanager
def _progress(name: str, quiet: bool) -> Iterator[ProgressCallbacks]:
    """Show the progress of a verb while the context is open."""
    from neuralgaits.cli.progress import ProofProgress, TrainingProgress, WorkProgress

    if name == "train":
        with TrainingProgress(quiet) as training:
            yield ProgressCallbacks(trained=training, proved=training.proved, begun=training.begun)
    elif name == "certify":
        with ProofProgress(quiet) as proof:
            yield ProgressCallbacks(proved=proof)
    else:
        waits = {
            "simulate": "simulating",
            "export": "writing it, comparing it",
            "report": "drawing it",
        }
        with WorkProgress(waits.get(name, name), quiet) as work:
            yield ProgressCallbacks(begun=work.begun)
