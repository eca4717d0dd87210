"""The part of the page about the certificate: levels, conditions, assumptions, how to check it."""

import shlex
from pathlib import Path

from neuralgaits.records import certificate_sentences
from neuralgaits.records.certified import (
    PROOF,
    SUMMARY,
    CertificateRecord,
    Conclusion,
    TheoremConstant,
)
from neuralgaits.records.final_boxes import boxes_of_proof
from neuralgaits.records.level_words import HIGHEST, HIGHEST_OF_MANY, WORDS
from neuralgaits.report.page import markup as html
from neuralgaits.report.page import phrases
from neuralgaits.report.page.markup import Html
from neuralgaits.report.page.saved import Contents, RunContents
from neuralgaits.runs import packed
from neuralgaits.runs.shell_words import command, named, quoted


def certificate(contents: Contents) -> Html:
    """Return the section on what is proved and what is not, condition by condition."""
    saved = contents.saved
    summary = saved.certificate
    if summary is None:
        return html.section("certificate", "The certificate", _absent(saved))
    return html.section(
        "certificate",
        "The certificate",
        html.paragraph(
            "Here nothing rests on samples. The region is cut into boxes, and on each box the "
            "margin is bounded from below by interval arithmetic, every rounding error included."
        ),
        _ladder(summary, bool(saved.config.commands)),
        *(_level(entry) for entry in summary.levels),
        html.tag("h3", "Condition by condition (level 1)"),
        _conditions(saved, summary),
        html.tag("h3", "What it assumes"),
        html.items(certificate_sentences.assumptions(saved.confirmed_level, summary.robots)),
        html.paragraph(
            f"It claims nothing about {certificate_sentences.not_claimed(saved.confirmed_level)}."
        ),
        html.folded("The same in the words of check-proof", html.items(contents.assumptions)),
        html.tag("h3", "Check it again"),
        *_files(saved, summary),
    )


def _absent(saved: RunContents) -> Html:
    reason = saved.damaged.get(SUMMARY) or saved.damaged.get(PROOF)
    sentence = reason or (
        "This gait has no certificate: nothing is proved of it. Measured conditions and simulated "
        "walks are evidence, and no more."
    )
    if saved.config.not_provable_because:
        sentence += f" It cannot have one: {saved.config.not_provable_because}"
        return html.missing(sentence)
    sentence += " To prove it, some ten seconds for a built-in robot:"
    return html.missing(sentence, line=command("certify", saved.name))


def _ladder(certificate: CertificateRecord, with_commands: bool) -> Html:
    """Return the table of levels; `with_commands` says whether the gait takes commands."""
    answers = {1: certificate.verdict_of_conditions} | {
        entry.level: entry.verdict for entry in certificate.levels
    }
    if with_commands or certificate.parameters:
        # Higher levels are about a single gait of one robot.
        above = dict.fromkeys(range(HIGHEST_OF_MANY + 1, HIGHEST + 1), "not about such a gait")
        answers = above | answers
    rows = [
        (
            level,
            certificate_sentences.states(level, with_commands, certificate),
            phrases.verdict(answers.get(level, "not asked")),
        )
        for level in WORDS
    ]
    head = ("level", "states that", "verdict")
    title = "The ladder of guarantees: 2 rests on 1, 3 on 2, 5 on 4"
    return html.table(title, head, rows)


def _level(entry: Conclusion) -> Html:
    """Return the theorem of a proved level with its numbers, folded away."""
    level = entry.level
    if not entry.proved:
        reason = entry.reason or "no reason is given"
        return html.paragraph(html.tag("b", f"Level {level} is {entry.verdict}: "), reason)
    labels = {
        "step_time_at_most_s": ("a step takes at most", "s"),
        "forward_at_least_per_s": ("phase runs forward by at least", "1/s"),
        "relative_width": ("width of the walking set in z2, of its middle", ""),
        "contraction_at_most": ("a deviation shrinks per step to at most", "of itself"),
        "multiplier_at_least": ("multiplier of the orbit, at least", ""),
        "multiplier_at_most": ("multiplier of the orbit, at most", ""),
        "z2_at_mid_step_at_least": ("z2 of the orbit at phase 0.5, at least", "kg m²/s"),
        "z2_at_mid_step_at_most": ("z2 of the orbit at phase 0.5, at most", "kg m²/s"),
    }
    figures = [
        (label, f"{html.bound(value, above='_at_most' in name, digits=6)} {unit}".rstrip())
        for name, (label, unit) in labels.items()
        if (value := entry.figures.get(name)) is not None
    ]
    constants = [(one.name, _rounded(one), one.unit, one.meaning) for one in entry.constants]
    parts = [html.paragraph("In the words of the theorem:"), html.items(entry.words)]
    if figures:
        parts.append(html.facts(f"Numbers proved at level {level}", figures))
    if constants:
        head = ("constant", "value", "unit", "meaning")
        parts.append(html.table(f"Constants of level {level}", head, constants, numbers=" n"))
    return html.folded(f"Level {level}: the statement and its numbers", *parts)


def _rounded(constant: TheoremConstant) -> str:
    """Format a constant; a bound is rounded to the side on which it stays true."""
    if constant.side == "exact":
        return html.number(constant.value)
    return html.bound(constant.value, above=constant.side == "most")


def _conditions(saved: RunContents, certificate: CertificateRecord) -> Html:
    words = {one.name: phrases.any_condition(one.data) for one in saved.config.conditions}
    rows = []
    tightness = {"refuted": 0, "undecided": 1}
    ordered = sorted(
        certificate.conditions.items(),
        key=lambda row: (
            2 if row[1].proved_in_part else tightness.get(row[1].verdict, 2),
            row[1].margin or 0.0,
        ),
    )
    for name, entry in ordered:
        point, detail = entry.counterexample, ""
        if point is not None:
            z = ", ".join(html.number(value, 6) for value in point.z)
            detail = f"margin {html.number(point.margin)} at z = ({z})"
        elif entry.verdict == "undecided":
            left = f"{html.number(entry.undecided_boxes)} boxes left"
            detail = "proved in this part" if entry.proved_in_part else left
        share = f"{int(1e4 * entry.proved_fraction) / 100:g} %"
        margin, boxes = html.bound(entry.margin), html.number(entry.boxes)
        words_of_condition = phrases.named(name, words.get(name, ""))
        rows.append(
            (words_of_condition, phrases.verdict(entry.verdict), margin, share, boxes, detail)
        )
    head = (
        "condition",
        "verdict",
        "margin at least",
        "of its region",
        "boxes bounded in the search",
        "",
    )
    failed = sum(
        entry.verdict != "proved" and not entry.proved_in_part
        for entry in certificate.conditions.values()
    )
    about = (
        "with margins in scales, as above; every state of a condition's region has at least its. "
        "Shares, boxes and points are as certify recorded them: no proof file states them"
    )
    return html.tightest(about, head, rows, failed, numbers="  nnn")


def _files(saved: RunContents, certificate: CertificateRecord) -> list[Html]:
    if PROOF not in saved.hashes:
        return [html.paragraph("There is no proof file: nothing was proved that could be checked.")]
    rows = [(html.tag("code", PROOF), html.tag("code", saved.hashes[PROOF]))]
    proof = packed.place(saved.folder.path / PROOF)
    line = command("check-proof", named(proof), "--run", saved.name)
    derives, words = "derives the robot's dynamics again", ["build/proofcheck"]
    if certificate.robots is not None:
        # Its own formulas know one robot.
        derives = "here bounds the arithmetic in the file, which it does not derive again"
        words.append("--program")
    file = quoted(str(proof.resolve()))
    # It knows no packed files.
    final = boxes_of_proof(proof)
    in_file = "" if final is None else f"{html.number(final)} in the proof file, "
    check = f"gunzip -c {file} | {shlex.join(words)} /dev/stdin"
    if proof.name == Path(PROOF).name:
        check = f"{shlex.join(words)} {file}"
    return [
        html.paragraph(
            "The proof file holds the statements, the boxes and the arithmetic they are about. "
            "check-proof bounds every box anew in another arithmetic; proofcheck is a C++ "
            f"program that shares no code with this one and {derives}."
        ),
        html.table("Proof file", ("file", "sha256"), rows, cards=True),
        html.shell([line]),
        html.paragraph("In the folder with the source of this program, where its Makefile is:"),
        html.shell(["make proofcheck", check]),
        html.paragraph(
            f"{html.number(certificate.boxes)} boxes bounded in the search, {in_file}"
            f"{html.number(certificate.wall_s)} s.",
            class_="quiet",
        ),
    ]
