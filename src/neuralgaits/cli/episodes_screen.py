"""Rounds of episodes as a table for a person, on stdout."""

from collections.abc import Sequence

from rich.text import Text

from neuralgaits._digits import percent
from neuralgaits.cli.screen_tables import short, show_facts, show_sentence, show_table
from neuralgaits.records.episode_records import EpisodesSummary
from neuralgaits.records.record import Pair
from neuralgaits.runs.shell_words import command, named


def show_episodes(result: EpisodesSummary) -> None:
    """Show a line for each round, and the next command."""
    rounds = result.rounds
    if rounds and (share := rounds[-1].share_that_walks) is not None:
        verdict = Text("walks", "green") if share >= 0.9 else Text("falls", "red")
        text = f": {_percent(share)} of the walks of round {rounds[-1].round} stayed up"
        show_sentence(verdict, text)
    rows = [
        (
            str(entry.round),
            _span(entry.steps_walked),
            _percent(entry.share_that_walks),
            _percent(entry.share_of_speeds),
            _range(entry.speed_range_m_s),
            _percent(entry.barriers.tube),
            _left(entry.heldout_error, entry.nominal_heldout_error),
            short(entry.loss),
        )
        for entry in rounds
    ]
    # Starts at 0.8 to 1.2 times the nominal z2; held-out error relative to the model's. The table
    # fits 80 columns.
    head = (
        "round",
        "steps",
        "stay up",
        "0.8-1.2 z2",
        "speeds m/s",
        "in tube",
        "error left",
        "loss",
    )
    show_table(head, rows)
    for entry in rounds:
        if entry.reason:
            show_sentence(f"round {entry.round}: nothing learned: {entry.reason}", hang=2)
    if result.diverged:
        what = f"round {len(rounds)}: training diverged: {result.diverged}"
        show_sentence(Text(what, "red"), hang=2)
    facts = [("figure", result.figure), ("run", result.run)]
    if result.waiting_for:
        facts += [
            ("next", f"walk {result.run} on the robot, put its logs into"),
            ("", f"{result.waiting_for}, then"),
            ("", command("episodes", "--resume", named(result.episodes))),
        ]
    show_facts(facts)


def _span(steps: Sequence[int]) -> str:
    low, high = min(steps), max(steps)
    return f"{low}" if low == high else f"{low} to {high}"


def _range(speeds: Pair | None) -> str:
    return "-" if speeds is None else f"{speeds[0]:.2f} to {speeds[1]:.2f}"


def _percent(share: float | None) -> str:
    return "-" if share is None else percent(share, 0)


def _left(error: float | None, nominal: float | None) -> str:
    return _percent(error / nominal) if error is not None and nominal else "-"
