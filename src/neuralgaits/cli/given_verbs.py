"""Verbs that make runs of gaits that are not trained, and their output."""

from typing import Any

from rich.text import Text

from neuralgaits.cli.arguments import ImportGaitOptions, OptimiseOptions
from neuralgaits.cli.argv_parser import given
from neuralgaits.cli.outcome import Outcome
from neuralgaits.cli.screen_tables import number, show_facts, show_sentence, show_table
from neuralgaits.records.trained import TrainingSummary
from neuralgaits.runs.shell_words import command, named
from neuralgaits.settings import ImportGaitSettings, OptimiseSettings


def carry_out_optimise(verb: OptimiseOptions) -> Outcome:
    """Carry out the verb `optimise`; always good."""
    from neuralgaits.cli.progress import WorkProgress
    from neuralgaits.workflows.optimise import optimise

    with WorkProgress("looking for a gait", quiet=verb.output.json) as progress:
        run = optimise(**given(verb, OptimiseSettings, begun=progress.begun))
    return Outcome(run.summary, good=True, table=show_given)


def carry_out_import(verb: ImportGaitOptions) -> Outcome:
    """Carry out the verb `import-gait`; always good."""
    from neuralgaits.cli.progress import WorkProgress
    from neuralgaits.workflows.import_gait import import_gait

    with WorkProgress("looking for its orbit", quiet=verb.output.json) as progress:
        run = import_gait(**given(verb, ImportGaitSettings, begun=progress.begun))
    return Outcome(run.summary, good=True, table=show_given)


def show_given(result: TrainingSummary) -> None:
    """Show the orbit, whether the limits hold in the tube around it, and the next command."""
    broken = result.broken
    if broken:
        count = Text(f"{len(broken)} of {len(result.conditions)} conditions fail", "yellow")
        show_sentence(count, " somewhere in the tube around the orbit")
        rows = [(name, number(condition.max_violation)) for name, condition in broken.items()]
        show_table(("condition", "max violation, in scales"), rows)
    else:
        sentence = (
            f": all {len(result.conditions)} conditions hold on samples of the tube around it"
        )
        show_sentence(Text("an orbit that attracts", "green"), sentence)
    facts: list[tuple[str, Any]] = [
        ("robot", result.robot),
        ("spec", result.spec),
        ("speed", f"{number(result.speed_m_s)} m/s"),
        ("mechanical cost of transport", result.cost_of_transport),
        ("Poincaré multiplier", result.multiplier),
    ]
    if result.train_s:
        facts.append(("solving", f"{result.train_s:.1f} s"))
    run = named(result.run)
    facts += [("time", f"{result.wall_s:.0f} s"), ("run", result.run)]
    facts += [("next", command("certify", run)), ("", command("simulate", run))]
    show_facts(facts)
