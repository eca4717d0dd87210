"""Verb that makes many runs: its settings, and a line for each finished run."""

from typing import Any

from rich.text import Text

from neuralgaits.cli.arguments import SweepOptions
from neuralgaits.cli.outcome import Outcome
from neuralgaits.cli.screen_tables import show_facts, show_sentence
from neuralgaits.errors import InputError
from neuralgaits.records.swept import SweepRow, Swept
from neuralgaits.runs.shell_words import command, named

_SETTINGS = ("steps", "certify", "budget", "disturbances", "walks", "out", "resume")
_LISTS = ("specs", "controllers")


def carry_out_sweep(verb: SweepOptions) -> Outcome:
    """Carry out `sweep`. Good if every row is done; undecided if some could not be carried out."""
    given: dict[str, Any] = {name: getattr(verb, name) for name in _SETTINGS}
    for name in _LISTS:
        if (text := getattr(verb, name)) is not None:
            given[name] = _list(name, text)
    if verb.speeds is not None:
        given["speeds"] = [_speed(word) for word in _list("speeds", verb.speeds)]
    if verb.seeds is not None:
        given["seeds"] = seeds_of(verb.seeds)
    from neuralgaits.cli.progress import SweepProgress
    from neuralgaits.workflows.sweep import sweep

    with SweepProgress(quiet=verb.output.json) as progress:

        def tell(row: SweepRow, done: int, every: int) -> None:
            progress(line_of(row), done, every)

        pool = verb.pool
        done = sweep(verb.robots, workers=pool.workers, ray=pool.ray, tell=tell, **given)
    summary = done.summary
    return Outcome(summary, not summary.failed, show_sweep, undecided=summary.lost > 0)


def show_sweep(result: Swept) -> None:
    """Show how many rows there are, and where the table and the page are."""
    good = result.rows - result.failed
    state = Text("done", "green") if not result.failed else Text("not all done", "yellow")
    show_sentence(state, f": {good} of {result.rows} runs")
    if refused := result.failed - result.lost:
        show_sentence(f"{refused} said no, and would again: the page says why", hang=2)
    facts = [
        ("carried out on", f"{result.engine}, {result.workers} at once"),
        ("time", f"{result.wall_s:.0f} s"),
        ("runs", f"{result.sweep}/rows"),
        ("table", result.table),
        ("page", result.page),
    ]
    if result.lost:
        again = command("sweep", "--out", named(result.sweep), "--resume")
        facts.append(("try the other again" if result.lost == 1 else "try others again", again))
    show_facts(facts)


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


def seeds_of(text: str) -> tuple[int, int]:
    """Read `A:B`, or one seed, as the first seed and the one after the last. Raises: InputError."""
    words = text.split(":")
    if len(words) > 2 or not all(word.isdecimal() for word in words):
        raise InputError(f"expected --seeds A:B or one seed, found {text!r}: write 0:20")
    first = int(words[0])
    return first, int(words[1]) if len(words) == 2 else first + 1


def _list(name: str, text: str) -> list[str]:
    words = [word.strip() for word in text.split(",")]
    if not all(words):
        raise InputError(f"expected --{name} as A,B,..., found {text!r}: a name is missing")
    return words


def _speed(text: str) -> float | tuple[float, float]:
    try:
        values = [float(part) for part in text.split(":")]
    except ValueError:
        values = []
    if len(values) not in (1, 2):
        raise InputError(f"--speeds: expected numbers or LOW:HIGH in m/s, found {text!r}")
    return values[0] if len(values) == 1 else (values[0], values[1])
