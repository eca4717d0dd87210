"""The end of the page: failures, missing parts, how to reproduce the run, and a glossary."""

import os
from collections import Counter
from collections.abc import Iterator, Mapping
from pathlib import Path

from neuralgaits._printable import counted
from neuralgaits.records import certificate_sentences
from neuralgaits.records.certified import PROOF, SUMMARY, CertificateRecord
from neuralgaits.records.level_words import ORBIT_LEVEL
from neuralgaits.report.drawing.command_words import FIGURES as OF_COMMANDS
from neuralgaits.report.drawing.figure_files import FigureFiles, MissingFigure
from neuralgaits.report.page import markup as html
from neuralgaits.report.page import phrases, repeat_commands
from neuralgaits.report.page.markup import Html
from neuralgaits.report.page.saved import Contents, RunContents
from neuralgaits.runs.shell_words import command, named, resuming


def failures(contents: Contents) -> Html:
    """List everything that failed, with its reason."""
    items = list(_failures(contents))
    if items:
        return html.section("failures", "What failed, and why", html.items(items))
    sentence = "Nothing failed in what was done with this run. What was not done is listed next."
    return html.section("failures", "What failed, and why", html.paragraph(sentence))


def _failures(contents: Contents) -> Iterator[str]:
    saved = contents.saved
    if saved.nan is not None:
        yield saved.nan
    for file, reason in saved.damaged.items():
        yield f"{file}: {reason}"
    for name, measured in saved.measured.items():
        if measured.broken:
            most = html.number(measured.max_violation)
            left = (
                "Training left {} violated" if saved.config.as_given is None else "{} is violated"
            )
            yield f"{left.format(name)} on samples, by up to {most} of its scale."
    for name, entry in saved.conditions.items():
        point = entry.counterexample
        if point is not None:
            place = point.place(lambda value: html.number(value, 6))
            yield (
                f"{name} is refuted: at {place} its margin is "
                f"{html.number(point.margin)} of its scale. certify recorded this point; no proof "
                "file states it, and this page has not evaluated it again."
            )
        elif entry.verdict == "undecided":
            share = html.number(100.0 * entry.proved_fraction)
            yield f"{name} is undecided: {share} % of its region is proved."
    for level in () if saved.certificate is None else saved.certificate.levels:
        if not level.proved:
            yield f"Level {level.level} is {level.verdict}: {level.reason}."
    yield from _falls(contents)
    if saved.episodes is not None and saved.episodes.diverged:
        yield f"Training diverged in a round of the episodes: {saved.episodes.diverged}"


def _falls(contents: Contents) -> Iterator[str]:
    simulation, walks = contents.saved.simulation, contents.saved.walks
    for where, walked in (("In simulation", simulation), ("In its round of episodes", walks)):
        reasons = () if walked is None else walked.fall_reasons or ()
        for reason, count in Counter(reason for reason in reasons if reason).items():
            yield f"{where} {count} of {len(reasons)} walks fell: {reason}."
    walk = contents.walk
    if walk is not None and walk.fell:
        steps = counted(walk.steps_walked, "step")
        yield (f"The walk shown above fell after {steps}: {walk.fall_reason}.")


def missing(contents: Contents) -> Html:
    """List the parts that this run does not have yet, with the commands that make them."""
    by_command: dict[str, list[str]] = {}
    for what, line in missing_parts(contents):
        by_command.setdefault(line, []).append(what)
    rows = [("; ".join(what), html.tag("code", line)) for line, what in by_command.items()]
    if not rows:
        return html.section(
            "missing", "What is missing", html.paragraph("Nothing: every part is here.")
        )
    head = ("missing", "the command that makes it")
    return html.section(
        "missing",
        "What is missing",
        html.table("Parts this run does not have", head, rows, cards=True),
    )


def missing_parts(contents: Contents) -> Iterator[tuple[str, str]]:
    """Yield each missing part in words, with the command that makes it."""
    saved = contents.saved
    if saved.nan is not None:
        line = repeat_commands.another_seed(saved.folder)
        if line is not None:
            yield (
                "a training that does not end in NaN: a formula mended, or another seed",
                line,
            )
        return
    if saved.summary is None:
        yield "the end of the training", resuming(saved.folder.path)
        return
    if saved.simulation is None:
        yield "simulations", command("simulate", saved.name)
    unprovable = bool(saved.failing or saved.config.not_provable_because)
    if saved.failing:
        # The table has the rest.
        names = ", ".join(saved.failing[:3]) + (", …" if len(saved.failing) > 3 else "")
        what = f"a gait that can be proved: some states break {names}, which"
        if saved.config.as_given is None:
            yield f"{what} more steps may mend", repeat_commands.longer(saved.folder)
        else:
            anew = command("train", repeat_commands.robot_word(saved.folder))
            yield f"{what} one that is trained need not", anew
    elif unprovable or not saved.damaged.keys().isdisjoint((SUMMARY, PROOF)):
        # A damaged certificate is among the failures, with the command that makes it again.
        pass
    elif saved.certificate is None:
        yield "a certificate", command("certify", saved.name)
    elif (level := saved.certificate.proved_level) < _last_level(saved, saved.certificate):
        other = _other_box(saved, saved.certificate)
        line = repeat_commands.certifying(saved.folder.path, level + 1, parameters=other)
        statement = certificate_sentences.states(
            level + 1, bool(saved.config.commands), saved.certificate
        )
        yield f"level {level + 1}: {statement}", line
    for figure in contents.figures:
        # What a proof would show is no use to ask for where there can be none.
        proof = isinstance(figure, MissingFigure) and figure.command.startswith(command("certify"))
        if isinstance(figure, MissingFigure) and not (proof and unprovable):
            yield f"figure “{figure.title}”: {figure.reason}", figure.command


def _other_box(saved: RunContents, certificate: CertificateRecord) -> Mapping[str, float] | None:
    """Return the box that a proof is about; None if it is the box that the run is meant for."""
    return None if certificate.parameters == saved.config.parameters else certificate.parameters


def _last_level(saved: RunContents, certificate: CertificateRecord) -> int:
    """Return the highest level that can be requested for the same box; above 3 it is one robot."""
    return (
        min(saved.config.last_level, ORBIT_LEVEL)
        if certificate.parameters
        else saved.config.last_level
    )


def reproduction(contents: Contents) -> Html:
    """Return the section that lists commands, versions and hashes."""
    saved = contents.saved
    folder, path = saved.folder, saved.folder.path
    # Beside the run: its robot and spec are read from its own copies.
    copy = Path(os.path.normpath(path / ".." / f"{path.resolve().name}-again"))
    trained = repeat_commands.training(saved.folder, copy)
    lines = ["" if trained is None else trained]
    if saved.certificate is not None:
        lines.append(_certifying(saved, saved.certificate, copy))
    if saved.simulation is not None:
        lines.append(repeat_commands.simulating(saved.folder, saved.simulation, copy) or "")
    lines.append(command("report", named(copy)))
    versions = list(folder.written_by.items())
    hashes = [
        (html.tag("code", file), html.tag("code", digest)) for file, digest in saved.hashes.items()
    ]
    return html.section(
        "reproduce",
        "How to make it again",
        *_commands(saved, trained, [line for line in lines if line]),
        html.facts(f"Versions, {folder.created_utc}", versions),
        html.table("Files of the run", ("file", "sha256"), hashes, cards=True),
    )


def _certifying(saved: RunContents, certificate: CertificateRecord, copy: Path) -> str:
    """Return the command that proves what the run's proof file confirms; usual settings else."""
    level: int | None = saved.confirmed_level
    some = {} if saved.of_some is None else saved.of_some.ranges
    within = {name: (one.low, one.high) for name, one in some.items()}
    other = _other_box(saved, certificate) if PROOF in saved.hashes else None
    if not level or (
        level == 1 and "floor" in (saved.config.parameters if other is None else other)
    ):
        # Statements about a floor begin at level 2.
        level = None
    disturbance = () if level == 1 else saved.disturbance
    return repeat_commands.certifying(copy, level, disturbance, within, other)


def _commands(saved: RunContents, trained: str | None, lines: list[str]) -> list[Html]:
    """Return the commands that reproduce the run, or the reason why there are none."""
    if trained is None:
        lost = (
            "the run that it was refined from is not where it was"
            if saved.config.parent
            else f"its spec, {saved.config.spec}, was made in Python and is in no file"
        )
        return [html.paragraph(f"No command makes this run again: {lost}.")]
    sentence = (
        "On the same machine and the same versions these commands give the same gait, bit for "
        "bit; elsewhere, a gait that differs in its last digits. They write to a folder beside "
        "this run, which must be new."
    )
    simulation = saved.simulation
    if (
        simulation is not None
        and repeat_commands.simulating(saved.folder, simulation, saved.folder.path) is None
    ):
        sentence += (
            " The simulation is left out: the run has kept no file of its plant, "
            f"{simulation.plant}, or of its controller, {simulation.controller}."
        )
    return [html.paragraph(sentence), html.shell(lines)]


def figures(contents: Contents, pictures: Mapping[str, Html]) -> Html:
    """Return every figure with its caption, or the reason why it is missing.

    Args:
        contents: contents of the page.
        pictures: an image element for each drawn figure, by name.
    """
    # What is told has a part of its own, with its figure.
    here = [figure for figure in contents.figures if figure.name not in OF_COMMANDS]
    inline = [
        html.captioned(figure.title, figure.caption, pictures[figure.name])
        for figure in here
        if isinstance(figure, FigureFiles)
    ]
    parts = [html.tag("div", *inline, class_="figures wide")] if inline else []
    absent = [figure.title for figure in here if isinstance(figure, MissingFigure)]
    if absent:
        sentence = f"Optional, not made yet: {'; '.join(absent)}. "
        link = html.tag("a", "What is missing", href="#missing")
        parts.append(html.paragraph(sentence, link, " has the commands.", class_="quiet"))
    if not parts:
        parts.append(html.paragraph("There are no figures of this run."))
    return html.section("figures", "Figures", *parts)


def glossary() -> Html:
    """Return the glossary of ten terms."""
    entries = html.join(
        html.join([html.tag("dt", term), html.tag("dd", meaning)])
        for term, meaning in phrases.GLOSSARY
    )
    return html.section("words", "Ten words", html.tag("dl", entries))
