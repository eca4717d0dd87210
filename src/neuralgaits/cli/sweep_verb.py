"""Verb that makes many runs: its settings, and a line for each finished run."""

from rich.text import Text

from neuralgaits.cli.arguments import SweepOptions
from neuralgaits.cli.argv_parser import given
from neuralgaits.cli.outcome import Outcome
from neuralgaits.cli.screen_tables import show_facts, show_sentence
from neuralgaits.records.swept import SweepRow, SweepSummary
from neuralgaits.runs.shell_words import command, named
from neuralgaits.settings import SweepSettings


def carry_out_sweep(verb: SweepOptions) -> Outcome:
    """Carry out `sweep`. Good if every row is done; undecided if some could not be carried out."""
    from neuralgaits.cli.progress import SweepProgress
    from neuralgaits.workflows.sweep import sweep

    with SweepProgress(quiet=verb.output.json) as progress:

        def tell(row: SweepRow, done: int, every: int) -> None:
            progress(line_of(row), done, every)

        done = sweep(**given(verb, SweepSettings, tell=tell, begun=progress.say))
    summary = done.summary
    return Outcome(summary, good=not summary.failed, table=show_sweep, undecided=summary.lost > 0)


def show_sweep(result: SweepSummary) -> None:
    """Show how many rows there are, and where the table and the page are."""
    good = result.rows - result.failed
    state = Text("done", "green") if not result.failed else Text("not all done", "yellow")
    show_sentence(state, f": {good} of {result.rows} rows")
    if refused := result.failed - result.lost:
        show_sentence(f"{refused} said no, and would again: the page says why", hang=2)
    facts = [
        ("workers", _workers(result)),
        ("time", f"{result.wall_s:.0f} s"),
        ("runs", f"{result.sweep}/rows"),
        ("table", result.table),
        ("page", result.page),
    ]
    if result.lost:
        again = command("sweep", "--out", named(result.sweep), "--resume")
        facts.append(("try the other again" if result.lost == 1 else "try others again", again))
    show_facts(facts)


def _workers(result: SweepSummary) -> str:
    if result.engine == "processes":
        return f"{result.workers} process{'' if result.workers == 1 else 'es'}"
    return f"{result.workers} ({result.engine})"


def line_of(row: SweepRow) -> str:
    """Summarise a row in one line."""
    if row.failure is not None:
        return f"{row.name}: {row.failure}: {row.reason}"
    parts = [f"{row.broken} of {row.conditions} conditions broken" if row.broken else "trained"]
    if row.verdict is not None:
        level = f" to level {row.proved_level}" if row.proved_level else ""
        parts.append(f"{row.verdict}{level}")
    if (own := row.undisturbed) is not None:
        speed = "" if own.speed_m_s is None else f" at {own.speed_m_s:.2f} m/s"
        parts.append(f"{own.stayed} of {own.walks} walk{speed}")
        others = [one for one in row.walks if one is not own]
        stayed, walks = (sum(getattr(one, name) for one in others) for name in ("stayed", "walks"))
        parts += [f"disturbed {stayed} of {walks}"] if walks else []
    times = row.wall_s
    took = sum(t for t in (times.train, times.prove, times.walk) if t is not None)
    return f"{row.name}: {', '.join(parts)}, {took:.0f} s"
