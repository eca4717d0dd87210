"""The few lines that `check-proof` ends with: the verdict, what it is about, what to do next."""

import re
from pathlib import Path

from neuralgaits._printable import counted
from neuralgaits.cli.brief import listed
from neuralgaits.cli.screen_tables import show_facts, show_sentence, verdict
from neuralgaits.errors import RunError
from neuralgaits.records.certified import PROOF
from neuralgaits.records.checked import ProofCheck
from neuralgaits.runs import packed, resolve
from neuralgaits.runs.names import CONFIG
from neuralgaits.runs.shell_words import command, named


def brief_check(result: ProofCheck, *, hint: bool = True) -> None:
    """Print the verdict on a proof file, what it is about, and that it rests on assumptions."""
    show_sentence(verdict(result.verdict), _why_no_better(result, hint))
    levels = (f"level {one.level} {one.verdict}" for one in result.levels)
    above = "".join(f", {level}" for level in levels)
    unclaimed = f"; none of {listed(result.unclaimed)}" if result.unclaimed else ""
    facts = [
        ("about", f"{result.robot}, spec {result.spec}, weights {result.weights_sha256[:12]}..."),
        ("claims", f"{len(result.statements)} bounds{above}{unclaimed}"),
        (
            "boxes",
            f"{result.boxes} bounded in the check, {result.wall_s:.0f} s, {_arithmetic(result)}",
        ),
        ("assumes", _assumed(len(result.assumptions), hint)),
        ("next", _after_check(result)),
    ]
    show_facts(facts)


def _arithmetic(result: ProofCheck) -> str:
    """Return in what arithmetic boxes were bounded."""
    if result.arithmetic == "balls":
        return "all in balls"
    if result.boxes_in_balls:
        return f"in doubles, {result.boxes_in_balls} in balls"
    return "in doubles"


def _why_no_better(result: ProofCheck, hint: bool) -> str:
    """Return the first reason for a verdict on a proof file, and how many there are."""
    if not result.reason:
        return ""
    if result.verdict != "rejected":
        return f": {result.reason}"
    first, *others = result.reasons or (result.reason,)
    # Of a sha256 the first digits: the whole ones are in --json, for programs, and on -v.
    line = ": " + re.sub(r"\b([0-9a-f]{12})[0-9a-f]{52}\b", r"\1...", first)
    if not others:
        return line
    return f"{line}; {counted(len(others), 'more reason')}, {_where(hint)}"


def _where(hint: bool) -> str:
    return "-v prints all" if hint else "listed above"


def _assumed(count: int, hint: bool) -> str:
    things = counted(count, "thing")
    return f"{things}; -v prints them and every statement" if hint else f"{things}, listed above"


def _after_check(result: ProofCheck) -> str:
    """Return the command to give next: of a proof of a run, use it; otherwise, name the run."""
    if result.run is None:
        own = Path(result.proof).parent.parent
        run = named(own) if (own / CONFIG).is_file() else "RUN"
        return command("check-proof", named(result.proof), "--run", run)
    if result.verdict != "proved":
        return _after_refusal(result, result.run)
    from neuralgaits.systems.family_tasks import family_of_run

    if family_of_run(result.run) is not None:
        # Not every family has an export.
        return command("report", named(result.run))
    return command("export", named(result.run), "--out", "build/c")


def _after_refusal(result: ProofCheck, run: str) -> str:
    """Return the command for a proof that does not prove its run: check the run's own, or make it.

    A run whose own proof was refused is proved again.
    """
    try:
        own = resolve(run).path / PROOF
    except RunError:
        return command("certify", named(run))
    if packed.is_there(own) and own.resolve() != Path(result.proof).resolve():
        return command("check-proof", named(run), "--run", named(run))
    return command("certify", named(run))
