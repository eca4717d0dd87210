"""Verb that writes the report of a run."""

from rich.text import Text

from neuralgaits.cli.arguments import ReportOptions
from neuralgaits.cli.brief import brief_report
from neuralgaits.cli.outcome import Outcome
from neuralgaits.cli.screen_tables import show_facts, show_sentence
from neuralgaits.records.reported import ReportRecord


def carry_out_report(verb: ReportOptions) -> Outcome:
    """Carry out `report`. Good even if parts are missing: the page lists them."""
    from neuralgaits.cli.progress import WorkProgress
    from neuralgaits.workflows.report import write_report

    what = "walking once more, drawing the figures"
    with WorkProgress(what, quiet=verb.output.json) as progress:
        written = write_report(verb.run, out=verb.out, begun=progress.begun)
    return Outcome(written.summary, True, show_report, brief=brief_report)


def show_report(result: ReportRecord) -> None:
    """Show where the page is, what is in it, and which commands would add the missing parts."""
    size = result.bytes / 1e6
    sentence = f": {len(result.figures)} figures, {size:.1f} MB, opens without a network"
    show_sentence(Text("written", "green"), sentence)
    facts = [("report", result.report)]
    facts += [("damaged", f"{file}: {reason}") for file, reason in result.damaged.items()]
    show_facts(facts)
    missing: dict[str, list[str]] = {}
    for entry in result.missing:
        missing.setdefault(entry.command, []).append(entry.what)
    for command, what in missing.items():
        show_sentence(f"not there: {'; '.join(what)}", hang=2)
        show_facts([("", command)])
