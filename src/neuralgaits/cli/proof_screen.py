"""Results of proofs for a person, on stdout."""

import math
from collections.abc import Sequence
from typing import Any

from neuralgaits._digits import at_least, at_most
from neuralgaits.cli.screen_tables import (
    ROWS,
    number,
    show_facts,
    show_sentence,
    show_table,
    verdict,
)
from neuralgaits.records.certified import (
    CertificateRecord,
    Conclusion,
    ConditionVerdict,
    TheoremConstant,
)
from neuralgaits.records.checked import ProofCheck

_INDENT = 2


def show_proof(result: CertificateRecord) -> None:
    """Show each condition's verdict, with its margin (in scales) or a state that violates it.

    The verdict on all of them is on the short screen, which follows.
    """
    conditions = sorted(result.conditions.items(), key=_urgency)
    head = ("condition", "verdict", "proved", "margin", "bounded", "")
    show_table(head, [_row(name, entry) for name, entry in conditions[:ROWS]])
    others = [entry for _, entry in conditions[ROWS:]]
    if others:
        left = sum(not entry.proved_as_requested for entry in others)
        least = min((entry.margin for entry in others if entry.margin is not None), default=None)
        what = f"{left} of them not proved"
        if not left:
            what = (
                "proved in this part"
                if least is None
                else f"proved with margins of {at_least(least, 4)} or more"
            )
        show_sentence(f"and {len(others)} more, {what}; --json has all")
    _show_levels(result.levels)
    facts: list[tuple[str, Any]] = []
    if result.robots is not None:
        facts.append(("robots", f"all {result.all_robots}"))
    if result.ground is not None:
        facts.append(("floor", result.ground))
    facts += [("map", result.map)]
    show_facts(facts)


def _urgency(item: tuple[str, ConditionVerdict]) -> tuple[bool, float]:
    """Sort key: unproved conditions first, then the smallest margin."""
    _, entry = item
    return entry.proved_as_requested, math.inf if entry.margin is None else entry.margin


def _row(name: str, entry: ConditionVerdict) -> tuple[Any, ...]:
    point, detail = entry.counterexample, ""
    if point is not None:
        z = ", ".join(f"{value:.6g}" for value in point.z)
        detail = f"{point.margin:.3g} at z = ({z})"
    elif entry.verdict == "undecided":
        left = f"{entry.undecided_boxes} boxes left"
        detail = "proved in this part" if entry.proved_in_part else left
    # Rounded down: less than everything never reads as everything.
    share = f"{math.floor(1e4 * entry.proved_fraction) / 100:g} %"
    bound = number(None) if entry.margin is None else at_least(entry.margin, 4)
    return name, verdict(entry.verdict), share, bound, number(entry.boxes), detail


def show_check(result: ProofCheck) -> None:
    """Show the claims of the file, and their assumptions; the verdict is on the short screen.

    All reasons for a rejection are shown if there are several: the short screen has the first.
    """
    if result.reasons:
        show_sentence("rejected because")
        for reason in result.reasons:
            show_sentence(reason, indent=_INDENT, hang=_INDENT)
    weights = f"weights of sha256 {result.weights_sha256[:12]}..."
    show_sentence(f"claims for {result.robot}, spec {result.spec}, {weights}")
    statements = result.statements
    # Names of premises have a slash, as orbit/inside; conditions of a spec have none.
    lines = [text for text in statements if "/" not in text.partition(":")[0]]
    lines = lines or list(statements[:ROWS])
    for statement in lines:
        show_sentence(statement, indent=_INDENT, hang=_INDENT)
    if len(lines) < len(statements):
        rest = len(statements) - len(lines)
        show_sentence(f"and {rest} premises of the levels; --json has them", indent=_INDENT)
    _show_levels(result.levels)
    if result.unclaimed:
        show_sentence(f"not claimed: {', '.join(result.unclaimed)}", hang=_INDENT)
    show_sentence("assuming that")
    for assumption in result.assumptions:
        show_sentence(assumption, indent=_INDENT, hang=_INDENT)


def _show_levels(levels: Sequence[Conclusion]) -> None:
    """Show the conclusions about trajectories, sentence by sentence."""
    for level in levels:
        reason = f": {level.reason}" if level.reason else ""
        show_sentence(f"level {level.level} ", verdict(level.verdict), reason, hang=_INDENT)
        for sentence in level.words:
            show_sentence(sentence, indent=_INDENT, hang=_INDENT)
        _show_constants(level.constants)


def _show_constants(constants: Sequence[TheoremConstant]) -> None:
    """Show the overall constants with their meanings, then those of each barrier in columns."""
    whole = [one for one in constants if ": " not in one.name]
    rows = [(one.name, _rounded(one), one.unit, one.meaning) for one in whole]
    show_table(("constant", "value", "unit", "meaning"), rows)
    each: dict[str, dict[str, str]] = {}
    for one in constants:
        barrier, colon, name = one.name.partition(": ")
        if colon:
            each.setdefault(barrier, {})[name] = _rounded(one)
    barriers = list(each)
    # Barriers whose constants share a table: names and numbers of four fit 80 columns.
    together = 4
    for first in range(0, len(barriers), together):
        group = barriers[first : first + together]
        names = dict.fromkeys(name for barrier in group for name in each[barrier])
        show_table(
            ("of each barrier", *group),
            [(name, *(each[barrier].get(name, "-") for barrier in group)) for name in names],
        )


def _rounded(constant: TheoremConstant) -> str:
    """Format a constant with four digits; a bound is rounded to the side on which it stays true."""
    rounds = {"least": at_least, "most": at_most}.get(constant.side)
    return number(constant.value) if rounds is None else rounds(constant.value, 4)
