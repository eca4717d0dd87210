"""`train --seeds`: its settings, and its output."""

from rich.text import Text

from neuralgaits.cli.arguments import TrainOptions
from neuralgaits.cli.argv_parser import given
from neuralgaits.cli.outcome import Outcome
from neuralgaits.cli.screen_tables import ROWS, number, show_facts, show_sentence, show_table
from neuralgaits.errors import InputError
from neuralgaits.records.trained import SeedsSummary
from neuralgaits.runs.shell_words import command, named
from neuralgaits.settings import TrainSeedsSettings


def carry_out_seeds(verb: TrainOptions) -> Outcome:
    """Train many seeds. Good if none is refused.

    Raises: InputError.
    """
    assert verb.seeds is not None
    seeds = f"{verb.seeds[0]}:{verb.seeds[1]}"
    if verb.seed is not None:
        raise InputError(
            f"expected --seed N or --seeds A:B, found both: for one seed, leave out --seeds {seeds}"
        )
    if verb.resume is not None:
        raise InputError(
            "expected --resume alone, found it with --seeds: a run goes on with its own settings; "
            "leave out --seeds"
        )
    for name in ("certify", "budget"):
        if getattr(verb, name):
            raise InputError(
                f"expected --seeds without --{name}, found both: train first, then certify each "
                "run, or sweep with --certify LEVEL"
            )
    if verb.robot is None:
        raise InputError(
            "expected ROBOT with --seeds, found none: name one, as in "
            f"`{command('train', 'amber3m', '--seeds', seeds)}`"
        )
    from neuralgaits.cli.progress import TrainingProgress
    from neuralgaits.workflows.train_seeds import train_seeds

    with TrainingProgress(quiet=verb.output.json) as progress:
        others = {"progress": progress, "doubted": progress.say, "begun": progress.begun}
        summary = train_seeds(**given(verb, TrainSeedsSettings, **others))
    return Outcome(summary.summary, good=not summary.summary.refused, table=show_seeds)


def show_seeds(result: SeedsSummary) -> None:
    """Show how many seeds satisfy all conditions, which ones do not, and the best seed."""
    every = len(result.seeds)
    holding = result.holding
    refused = result.refused
    state = Text("trained", "yellow" if refused else "green")
    sentence = f"; all {result.conditions} conditions hold on fresh samples of {len(holding)}"
    trained = every - len(refused)
    show_sentence(state, f": {trained} of {every} seeds{sentence if trained else ''}")
    for one in refused[:ROWS]:
        show_sentence(f"seed {one.seed}: {one.refused}", hang=2)
    failing = sorted(
        (one for one in result.seeds if one.failing), key=lambda one: -len(one.failing)
    )
    rows = [(str(one.seed), number(one.loss), ", ".join(one.failing)) for one in failing]
    show_table(("seed", "loss", "conditions that fail somewhere"), rows[:ROWS])
    for count, what in ((len(refused), "refused"), (len(rows), "with such conditions")):
        if count > ROWS:
            show_sentence(f"and {count - ROWS} more {what}")
    together = f"{result.batch} at a time" + (
        f" on {result.devices} devices" if result.devices > 1 else ""
    )
    spent = f"{result.wall_s:.0f} s, {result.compile_s:.0f} s compiling, {together}"
    facts = [("robot", result.robot), ("spec", result.spec), ("time", spent)]
    facts.append(("runs", result.folder))
    finished = [one for one in result.seeds if one.loss is not None]
    if finished:
        best = min(finished, key=lambda one: (len(one.failing), one.loss))
        facts.append(("least loss", f"seed {best.seed}, {number(best.loss)}"))
        facts.append(("next", command("simulate", named(best.run))))
    show_facts(facts)
