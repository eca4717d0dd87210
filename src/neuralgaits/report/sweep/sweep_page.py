"""The page of a sweep: its results as distributions and as a table. The page fetches nothing."""

from collections.abc import Mapping, Sequence

import numpy as np

from neuralgaits.records.swept import UNDISTURBED, SweepConfig, SweepRow, SweepSummary
from neuralgaits.report.drawing.figure import narrow_svg, svg
from neuralgaits.report.page import markup as html
from neuralgaits.report.page.html_shell import inline_image, whole
from neuralgaits.report.page.markup import Html
from neuralgaits.report.sweep import sweep_figure
from neuralgaits.runs.shell_words import command, named


def page(config: SweepConfig, rows: Sequence[SweepRow], summary: SweepSummary) -> str:
    """Return the page as HTML.

    Args:
        config: settings of the sweep.
        rows: rows in the order of the table.
        summary: summary by the command that finished the sweep.
    """
    groups = _groups(config, rows)
    parts = [
        _overview(config, groups),
        _distributions(groups),
        _survival(config, groups),
        _runs(rows),
        _failures(rows),
        _repeat_command(config, summary),
    ]
    header = html.tag(
        "header",
        html.tag("h1", f"A sweep of {_many(len(rows), 'run')}"),
        html.tag("div", html.paragraph(_answer(config, rows)), class_="answer"),
    )
    name = f"Sweep of {', '.join(config.robots)}"
    return whole(name, header, html.tag("main", *parts), "the rows of the sweep", ("hints.js",))


def _groups(config: SweepConfig, rows: Sequence[SweepRow]) -> dict[str, list[SweepRow]]:
    """Group rows that differ only in their seed, by a label."""
    groups: dict[str, list[SweepRow]] = {}
    for row in rows:
        words = [row.robot]
        if len(config.specs) > 1:
            words.append(row.spec.rpartition(":")[2])
        if len(config.speeds) > 1 and row.speed is not None:
            words.append(f"{_speed(row)} m/s")
        groups.setdefault(", ".join(words), []).append(row)
    return groups


def _answer(config: SweepConfig, rows: Sequence[SweepRow]) -> str:
    trained = [row for row in rows if row.loss is not None]
    words = [f"{len(trained)} of {len(rows)} combinations were trained to the end."]
    if config.certify is not None:
        proved = sum(row.proved(config.certify) for row in rows)
        words.append(f"{proved} are proved at level {config.certify}.")
    undisturbed = [row.undisturbed for row in rows if row.undisturbed is not None]
    if undisturbed:
        all_up = sum(one.stayed == one.walks for one in undisturbed)
        words.append(
            f"Without a disturbance {all_up} of {len(undisturbed)} stayed up in all of their "
            f"{_many(config.walks, 'simulated walk')} of {config.walk_steps} steps."
        )
    if lost := sum(not row.final for row in rows):
        words.append(f"{_many(lost, 'row')} could not be carried out: --resume tries them again.")
    return " ".join(words)


def _overview(config: SweepConfig, groups: Mapping[str, Sequence[SweepRow]]) -> Html:
    head = ["runs of", "runs", "trained", "broken on samples"]
    head += [] if config.certify is None else [f"proved, level {config.certify}", "least margin"]
    head += ["speed m/s", "cost of transport"]
    body = []
    for name, rows in groups.items():
        trained = [row for row in rows if row.loss is not None]
        cells = [name, len(rows), len(trained), sum(bool(row.broken) for row in trained)]
        if config.certify is not None:
            margins = [row.margin for row in rows if row.margin is not None]
            proved = sum(row.proved(config.certify) for row in rows)
            cells += [proved, html.bound(min(margins)) if margins else "–"]
        own = [row.undisturbed for row in rows if row.undisturbed is not None]
        cells += [
            _span([one.speed_m_s for one in own]),
            _span([one.cost_of_transport for one in own]),
        ]
        body.append(cells)
    return html.section(
        "overview",
        "What came out",
        html.table("Seeds together; ranges are from the least to the most", head, body, numbers=""),
        html.paragraph(
            "Proved is what a proof file of the run states and check-proof checks again; broken on "
            "samples, speeds and walks are measurements.",
            class_="quiet",
        ),
    )


def _distributions(groups: Mapping[str, Sequence[SweepRow]]) -> Html:
    title = "Distributions over the runs"
    caption = (
        "One dot a run, a row of dots for each robot and specification, a bar at their median. "
        "a) what is proved of all conditions at least, in each condition's own scale; b, c) of "
        "simulated walks without a disturbance; d) time of the proof on one thread of the machine "
        "that found it."
    )
    drawn = sweep_figure.draw(groups)
    image = inline_image("svg+xml", svg(drawn), title, narrow_svg(drawn))
    picture = html.tag("figure", image, html.tag("figcaption", caption))
    return html.section("distributions", title, picture)


def _survival(config: SweepConfig, groups: Mapping[str, Sequence[SweepRow]]) -> Html:
    """Return the shares of walks that stayed up: over all runs, and of the worst run."""
    columns = [(name, law) for name in groups for law in config.controllers]
    head = ["disturbance", *(f"{name}, {law}" for name, law in columns)]
    body = []
    for disturbance in (UNDISTURBED, *config.disturbances):
        cells: list[str] = [disturbance]
        for name, law in columns:
            walks = [row.under(law, disturbance) for row in groups[name]]
            shares = [one.share for one in walks if one is not None]
            cells.append(
                f"{_percent(float(np.mean(shares)))} ({_percent(min(shares))})" if shares else "–"
            )
        body.append(cells)
    caption = "Walks that stayed up: of all runs, and in brackets of the worst one"
    about = (
        f"Each run walks {_many(config.walks, 'time')} of {config.walk_steps} steps in MuJoCo "
        "under each disturbance, from states anywhere in the region it was trained on."
    )
    return html.section(
        "survival", "Disturbances", html.paragraph(about), html.table(caption, head, body)
    )


def _runs(rows: Sequence[SweepRow]) -> Html:
    head = ("run", "state", "verdict", "level", "least margin", "speed m/s", "stays up", "time s")
    body = []
    most_rows = 500  # Most rows of the table of runs; the CSV file has all of them.
    for row in rows[:most_rows]:
        walks, stayed = (sum(getattr(w, n) for w in row.walks) for n in ("walks", "stayed"))
        own, times = row.undisturbed, row.wall_s
        took = sum(t for t in (times.train, times.prove, times.walk) if t is not None)
        name = html.tag("a", row.name, href=f"rows/{row.name}/row.json") if row.final else row.name
        body.append(
            (
                name,
                row.failure or "done",
                row.verdict or "–",
                html.number(row.proved_level),
                html.bound(row.margin),
                html.number(None if own is None else own.speed_m_s),
                _percent(stayed / walks) if walks else "–",
                html.number(took),
            )
        )
    more = len(rows) - most_rows
    note = f" {more} more are in table.csv." if more > 0 else ""
    return html.section(
        "runs",
        "Runs",
        html.paragraph(
            "Each is a run folder in rows/, which simulate, certify, report, view and export open."
            + note
        ),
        html.table("One row a run", head, body),
    )


def _failures(rows: Sequence[SweepRow]) -> Html:
    failed = [row for row in rows if row.failure is not None]
    if not failed:
        return Html("")
    listed = html.items(f"{row.name}, {row.failure}: {row.reason}" for row in failed[:50])
    return html.section("failures", "What failed", listed)


def _repeat_command(config: SweepConfig, summary: SweepSummary) -> Html:
    disturbed = ", ".join(config.disturbances) or "none"
    options = [
        ("robots", ", ".join(config.robots)),
        ("specs", ", ".join(config.specs)),
        ("seeds", f"{config.seeds[0]}:{config.seeds[1]}"),
        ("controllers", ", ".join(config.controllers)),
        ("disturbances", disturbed),
        ("carried out on", f"{summary.engine}, {_many(summary.workers, 'worker')}"),
        ("time of the last command", f"{summary.wall_s:.0f} s"),
    ]
    return html.section(
        "again",
        "How it was made",
        html.facts("What was asked", options),
        html.paragraph("What is missing is made, and what is there is kept, by"),
        html.shell([command("sweep", "--out", named(summary.sweep), "--resume")]),
    )


def _span(values: Sequence[float | None]) -> str:
    numbers = [value for value in values if value is not None]
    if not numbers:
        return "–"
    low, high = html.number(min(numbers)), html.number(max(numbers))
    return low if low == high else f"{low} to {high}"


def _speed(row: SweepRow) -> str:
    return "-".join(f"{v:g}" for v in row.speed or ())


def _percent(share: float) -> str:
    # Nothing that fell once is said to have stayed up for sure.
    percent = 100.0 * share
    return f"{min(percent, 99.9):.1f} %" if 99.0 < percent < 100.0 else f"{percent:.0f} %"


def _many(count: int, what: str) -> str:
    return f"{count} {what}" + ("" if count == 1 else "s")
