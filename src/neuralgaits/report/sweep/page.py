"""The page of a sweep: what came of its rows, as distributions and as a table. Fetches nothing."""

import base64
import hashlib
from collections.abc import Mapping, Sequence
from importlib import resources

import numpy as np

from neuralgaits.records.swept import UNDISTURBED, SweepAsked, SweepRow, Swept
from neuralgaits.report.drawing.figure import svg
from neuralgaits.report.page.markup import (
    Html,
    bound,
    facts,
    items,
    number,
    paragraph,
    section,
    shell,
    table,
    tag,
)
from neuralgaits.report.sweep import figure as sweep_figure
from neuralgaits.runs.commands import command, named

MOST_ROWS = 500
"""Of the table of runs; all of them are in the CSV file."""
_SHOWN_FAILURES = 50


def page(asked: SweepAsked, rows: Sequence[SweepRow], summary: Swept) -> str:
    """The page as HTML.

    Args:
        asked: of the sweep.
        rows: in the order of the table.
        summary: of the command that ended it.
    """
    groups = _groups(asked, rows)
    parts = [
        _overview(asked, groups),
        section("distributions", sweep_figure.TITLE, _picture(groups)),
        _survival(asked, groups),
        _runs(rows),
        _failures(rows),
        _again(asked, summary),
    ]
    style = resources.files("neuralgaits.report.page").joinpath("assets", "page.css").read_text()
    digest = base64.b64encode(hashlib.sha256(style.encode()).digest()).decode()
    policy = (
        "default-src 'none'; img-src data:; base-uri 'none'; form-action 'none'; "
        f"style-src 'sha256-{digest}'"
    )
    head = tag(
        "head",
        Html('<meta charset="utf-8">'),
        Html(f'<meta http-equiv="Content-Security-Policy" content="{policy}">'),
        Html('<meta name="viewport" content="width=device-width, initial-scale=1">'),
        Html('<link rel="icon" href="data:,">'),
        tag("title", f"Sweep of {', '.join(asked.robots)}"),
        tag("style", Html(style)),
    )
    header = tag(
        "header",
        tag("h1", f"A sweep of {_many(len(rows), 'run')}"),
        tag("div", paragraph(_answer(asked, rows)), class_="answer"),
    )
    footer = tag("footer", "Made by neuralgaits from the rows of the sweep; nothing was fetched.")
    body = tag("body", header, tag("main", *parts), footer)
    return f"<!doctype html>\n{tag('html', head, body, lang='en')}\n"


def _groups(asked: SweepAsked, rows: Sequence[SweepRow]) -> dict[str, list[SweepRow]]:
    """Rows that differ in their seed alone, by what they are called."""
    found: dict[str, list[SweepRow]] = {}
    for row in rows:
        words = [row.robot]
        if len(asked.specs) > 1:
            words.append(row.spec.rpartition(":")[2])
        if len(asked.speeds) > 1 and row.speed is not None:
            words.append(f"{_speed(row)} m/s")
        found.setdefault(", ".join(words), []).append(row)
    return found


def _answer(asked: SweepAsked, rows: Sequence[SweepRow]) -> str:
    trained = [row for row in rows if row.loss is not None]
    words = [f"{len(trained)} of {len(rows)} combinations were trained to the end."]
    if asked.certify is not None:
        proved = sum(row.proved(asked.certify) for row in rows)
        words.append(f"{proved} are proved at level {asked.certify}.")
    walked = [row.undisturbed for row in rows if row.undisturbed is not None]
    if walked:
        all_up = sum(one.stayed == one.walks for one in walked)
        words.append(
            f"Without a disturbance {all_up} of {len(walked)} stayed up in all of their "
            f"{_many(asked.walks, 'simulated walk')} of {asked.walk_steps} steps."
        )
    if lost := sum(not row.final for row in rows):
        words.append(f"{_many(lost, 'row')} could not be carried out: --resume tries them again.")
    return " ".join(words)


def _overview(asked: SweepAsked, groups: Mapping[str, Sequence[SweepRow]]) -> Html:
    head = ["runs of", "runs", "trained", "broken on samples"]
    head += [] if asked.certify is None else [f"proved, level {asked.certify}", "least margin"]
    head += ["speed m/s", "cost of transport"]
    body = []
    for name, rows in groups.items():
        done = [row for row in rows if row.loss is not None]
        cells = [name, len(rows), len(done), sum(bool(row.broken) for row in done)]
        if asked.certify is not None:
            margins = [row.margin for row in rows if row.margin is not None]
            proved = sum(row.proved(asked.certify) for row in rows)
            cells += [proved, bound(min(margins)) if margins else "–"]
        own = [row.undisturbed for row in rows if row.undisturbed is not None]
        cells += [
            _span([one.speed_m_s for one in own]),
            _span([one.cost_of_transport for one in own]),
        ]
        body.append(cells)
    return section(
        "overview",
        "What came out",
        table("Seeds together; ranges are from the least to the most", head, body, numbers=""),
        paragraph(
            "Proved is what a proof file of the run states and check-proof checks again; broken on "
            "samples, speeds and walks are measurements.",
            class_="quiet",
        ),
    )


def _picture(groups: Mapping[str, Sequence[SweepRow]]) -> Html:
    content = base64.b64encode(svg(sweep_figure.draw(groups))).decode()
    image = Html(f'<img src="data:image/svg+xml;base64,{content}" alt="{sweep_figure.TITLE}">')
    return tag("figure", image, tag("figcaption", sweep_figure.CAPTION))


def _survival(asked: SweepAsked, groups: Mapping[str, Sequence[SweepRow]]) -> Html:
    """Shares of walks that stayed up: of all runs together, and of the worst of them."""
    columns = [(name, law) for name in groups for law in asked.controllers]
    head = ["disturbance", *(f"{name}, {law}" for name, law in columns)]
    body = []
    for disturbance in (UNDISTURBED, *asked.disturbances):
        cells: list[str] = [disturbance]
        for name, law in columns:
            found = [row.under(law, disturbance) for row in groups[name]]
            shares = [one.share for one in found if one is not None]
            cells.append(
                f"{_percent(float(np.mean(shares)))} ({_percent(min(shares))})" if shares else "–"
            )
        body.append(cells)
    caption = "Walks that stayed up: of all runs, and in brackets of the worst one"
    about = (
        f"Each run walks {_many(asked.walks, 'time')} of {asked.walk_steps} steps in MuJoCo under "
        "each disturbance, from states anywhere in the region it was trained on."
    )
    return section("survival", "Disturbances", paragraph(about), table(caption, head, body))


def _runs(rows: Sequence[SweepRow]) -> Html:
    head = ("run", "state", "verdict", "level", "least margin", "speed m/s", "stays up", "time s")
    body = []
    for row in rows[:MOST_ROWS]:
        walked, stayed = (sum(getattr(w, n) for w in row.walks) for n in ("walks", "stayed"))
        own, times = row.undisturbed, row.wall_s
        took = sum(t for t in (times.train, times.prove, times.walk) if t is not None)
        name = tag("a", row.name, href=f"rows/{row.name}/row.json") if row.final else row.name
        body.append(
            (
                name,
                row.failure or "done",
                row.verdict or "–",
                number(row.proved_level),
                bound(row.margin),
                number(None if own is None else own.speed_m_s),
                _percent(stayed / walked) if walked else "–",
                number(took),
            )
        )
    more = len(rows) - MOST_ROWS
    note = f" {more} more are in table.csv." if more > 0 else ""
    return section(
        "runs",
        "Runs",
        paragraph(
            "Each is a run folder in rows/, which simulate, certify, report, view and export open."
            + note
        ),
        table("One row a run", head, body),
    )


def _failures(rows: Sequence[SweepRow]) -> Html:
    failed = [row for row in rows if row.failure is not None]
    if not failed:
        return Html("")
    listed = items(f"{row.name}, {row.failure}: {row.reason}" for row in failed[:_SHOWN_FAILURES])
    return section("failures", "What failed", listed)


def _again(asked: SweepAsked, summary: Swept) -> Html:
    disturbed = ", ".join(asked.disturbances) or "none"
    told = [
        ("robots", ", ".join(asked.robots)),
        ("specs", ", ".join(asked.specs)),
        ("seeds", f"{asked.seeds[0]}:{asked.seeds[1]}"),
        ("controllers", ", ".join(asked.controllers)),
        ("disturbances", disturbed),
        ("carried out on", f"{summary.engine}, {_many(summary.workers, 'worker')}"),
        ("time of the last command", f"{summary.wall_s:.0f} s"),
    ]
    return section(
        "again",
        "How it was made",
        facts("What was asked", told),
        paragraph("What is missing is made, and what is there is kept, by"),
        shell([command("sweep", "--out", named(summary.sweep), "--resume")]),
    )


def _span(values: Sequence[float | None]) -> str:
    known = [value for value in values if value is not None]
    if not known:
        return "–"
    low, high = number(min(known)), number(max(known))
    return low if low == high else f"{low} to {high}"


def _speed(row: SweepRow) -> str:
    return "-".join(f"{v:g}" for v in row.speed or ())


def _percent(share: float) -> str:
    # Nothing that fell once is said to have stayed up for sure.
    percent = 100.0 * share
    return f"{min(percent, 99.9):.1f} %" if 99.0 < percent < 100.0 else f"{percent:.0f} %"


def _many(count: int, what: str) -> str:
    return f"{count} {what}" + ("" if count == 1 else "s")
