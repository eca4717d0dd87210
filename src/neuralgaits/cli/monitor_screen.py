"""Answers of the monitor about walks, as a table for a person, on stdout."""

from neuralgaits._digits import percent
from neuralgaits.cli.screen_tables import number, show_sentence, show_table
from neuralgaits.records.monitored import MonitorFigures


def show_monitor(monitored: MonitorFigures) -> None:
    """Show in which share of ticks the state was in the proved sets, and what was outside last."""
    rows = []
    for levels, one in monitored.by_set:
        last = "none"
        if (tick := one.last_outside) is not None:
            last = f"{tick.name}, walk {tick.walk} at {tick.time_s:.3f} s"
        rows.append((levels, percent(one.inside, 2), f"{number(one.margin)}, {one.name}", last))
    show_table(("set of level", "inside", "smallest margin", "last outside"), rows)
    in_time = (
        ""
        if monitored.in_time is None
        else f", {percent(monitored.in_time, 2)} came within its hold (level 5)"
    )
    show_sentence(
        f"of {monitored.ticks} ticks, {percent(monitored.admissible, 2)} had commands that the "
        "proof is about"
        f"{in_time}; the sets are those of the model under the proof's own controller"
    )
