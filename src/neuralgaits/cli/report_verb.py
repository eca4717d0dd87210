"""The verb that writes the report of a run."""

from collections.abc import Mapping
from typing import Any

from rich.console import Console
from rich.table import Table
from rich.text import Text

from neuralgaits.cli.arguments import Report
from neuralgaits.cli.outcome import Outcome


def carry_out_report(verb: Report) -> Outcome:
    """Run `report`. Good even if parts are missing: the page says which."""
    from neuralgaits.cli.progress import waiting
    from neuralgaits.workflows.report import write_report

    with waiting("walking once more, drawing the figures"):
        done = write_report(verb.run, out=verb.out)
    return Outcome(done.summary, True, show_report)


def show_report(result: Mapping[str, Any]) -> None:
    """Where the page is, what is in it, and what would make it more."""
    console = Console(highlight=False)
    size = result["bytes"] / 1e6
    told = f": {len(result['figures'])} figures, {size:.1f} MB, opens without a network"
    console.print(Text.assemble(Text("written", "green"), told))
    facts = Table(box=None, pad_edge=False, show_header=False)
    facts.add_row("report", Text(result["report"], overflow="fold"))
    for file, reason in result["damaged"].items():
        facts.add_row("damaged", Text(f"{file}: {reason}"))
    commands = dict.fromkeys(entry["command"] for entry in result["missing"])
    for command in commands:
        facts.add_row("for more", Text(command, overflow="fold"))
    console.print(facts)
