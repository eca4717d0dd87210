"""The page of a run of a family beside walkers: its set, episodes, and what is proved."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from matplotlib.figure import Figure

from neuralgaits._digits import at_least
from neuralgaits._printable import printable
from neuralgaits.errors import InputError
from neuralgaits.records.record import Count, Record
from neuralgaits.report.drawing.figure import narrow_svg, svg
from neuralgaits.report.page.html_shell import inline_image, whole
from neuralgaits.report.page.markup import Html, items, join, paragraph, table, tag
from neuralgaits.runs import write_text
from neuralgaits.runs.outputs import refuse_outputs
from neuralgaits.systems.family_run import FamilyRun
from neuralgaits.systems.run_statements import stated_bounds, why_nothing_is_stated

PAGE = "report.html"
"""Name of the page in its run's folder."""


@dataclass(frozen=True, eq=False, kw_only=True)
class FamilyReport(Record):
    """Result of `report`.

    Attributes:
        report: the page.
        bytes: its size.
        damaged: why a proof file that is there counts for nothing; None if it counts.
    """

    run: str
    report: str
    bytes: Count
    damaged: str | None = None


def report_family(run: FamilyRun, out: Path | None = None) -> FamilyReport:
    """Write the page of a run. Returns: where it is."""
    place = run.path / PAGE if out is None else out
    refuse_outputs([place], run=run.path)
    if place.suffix.lower() not in ("", ".html", ".htm"):
        raise InputError(f"expected --out as a file *.html, found {place}: the report is a page")
    bounds = stated_bounds(run)
    figures = [
        tag("figure", _image(figure, words), tag("figcaption", words))
        for figure, words in run.system.page_figures(run)
    ]
    main = tag("main", join([_about(run), *figures, _proof(run, bounds)]))
    name = run.config.robot
    header = tag("header", tag("h1", f"{name}: {run.system.family.words}"))
    text = whole(name, header, main, printable(run.path), ())
    write_text(place, text)
    return FamilyReport(
        run=str(run.path),
        report=str(place),
        bytes=len(text.encode()),
        damaged=why_nothing_is_stated(run) if bounds is None else None,
    )


def _image(figure: Figure, alt: str) -> Html:
    return inline_image("svg+xml", svg(figure), alt, narrow_svg(figure))


def _about(run: FamilyRun) -> Html:
    """Return sentences about the robot, its set and the training."""
    summary, lines = run.summary, run.system.page_lines(run)
    names = run.table.conditions
    margins = [margin for name, margin in summary.margins.items() if name in names]
    if margins:
        lines.append(
            f"Recorded in training: at {summary.samples} random states the smallest margin of "
            f"{len(margins)} conditions is {min(margins):.3g}."
        )
    return tag("section", tag("h2", "Run"), items(lines))


def _proof(run: FamilyRun, bounds: Mapping[str, float] | None) -> Html:
    """Return the bounds that the run's proof file states, and what follows."""
    if bounds is None:
        why = why_nothing_is_stated(run)
        sentence = "No proof of this run." if why is None else f"Nothing is proved: {why}."
        return tag("section", tag("h2", "Proof"), paragraph(sentence))
    system = run.system
    levels = []
    for one in system.conclude(bounds, run.config, system.highest):
        sentence = "; ".join(one.words) if one.proved else one.reason
        levels.append(f"level {one.level}: {one.verdict}; {sentence}")
    rows = [
        (name, region, at_least(bounds[name], 2) if name in bounds else "not stated")
        for name, region in run.table.conditions.items()
    ]
    caption = "Level 1: conditions on all of their regions, with margins of at least"
    conditions = table(caption, ("condition", "where", "margin"), rows, numbers="  n")
    note = (
        "According to the proof file, which this page has not checked: about the rigid model in "
        "continuous time. Verify with check-proof or build/proofcheck."
    )
    return tag("section", tag("h2", "Proof"), items(levels), paragraph(note), conditions)
