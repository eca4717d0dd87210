"""Part of the page about the monitor: how much of the saved walks was in the proved sets."""

import math

from neuralgaits.records.certified import PROOF
from neuralgaits.records.monitored import LevelOccupancy, MonitorFigures, margin_in_words
from neuralgaits.records.simulated import SimulationSummary
from neuralgaits.report.page import markup as html
from neuralgaits.report.page.markup import Html
from neuralgaits.report.page.saved import RunContents
from neuralgaits.runs.shell_words import command


def monitored(saved: RunContents, simulation: SimulationSummary) -> Html:
    """Return how much of a simulation was in the sets of the run's proof.

    Without a proof of such a set there is nothing to say; without figures of this proof there is
    the command that makes them.
    """
    if saved.confirmed_level < 2:  # Level 1 is about no set of states.
        return Html("")
    figures = simulation.monitor
    if figures is None or figures.proof_sha256 != saved.hashes.get(PROOF):
        was = "not compared" if figures is None else "compared with those of another proof, not"
        return html.missing(
            f"Optional, not made yet: this simulation was {was} with the sets that are proved.",
            line=command("simulate", saved.name, "--monitor"),
        )
    return html.tag("div", _sets(figures), html.paragraph(_caveat(figures)))


def _sets(figures: MonitorFigures) -> Html:
    """Return a table with a row for each set."""
    rows = [
        (
            f"level{'s' * (',' in levels)} {levels.replace(', ', ' and ')}",
            f"{share(one.inside)} %",
            f"{html.number(one.margin)}, {margin_in_words(one.name)}",
            _outside(one),
        )
        for levels, one in figures.by_set
    ]
    head = ("proved set of", "inside", "smallest margin", "last tick outside")
    return html.table(f"States at all {figures.ticks} control ticks", head, rows)


def share(value: float) -> str:
    """Return a share in per cent, rounded down: all of it is 100 only."""
    return f"{math.floor(1000.0 * value) / 10.0:.1f}"


def _outside(one: LevelOccupancy) -> str:
    tick = one.last_outside
    if tick is None:
        return "none"
    name = margin_in_words(tick.name)
    return f"walk {tick.walk}, {tick.time_s:.3f} s: {html.number(tick.margin)}, {name}"


def _caveat(figures: MonitorFigures) -> str:
    """Say what the table is not."""
    sentence = (
        ""
        if figures.admissible == 1.0
        else (
            f" At {share(figures.admissible)} % of the ticks the commands were those of the proof."
        )
    )
    late = (
        ""
        if figures.in_time is None
        else (f" {share(figures.in_time)} % of the ticks came within the hold that level 5 allows.")
    )
    return (
        "A margin is negative outside. The sets are those of the model under the proof's own "
        "controller: inside, a simulation may still fall, and outside, nothing is proved."
        f"{sentence}{late}"
    )
