"""Verb that writes the report of a run."""

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
    return Outcome(written.summary, good=True, table=show_report, brief=brief_report)


def show_report(result: ReportRecord) -> None:
    """Show what could not be read, and every part that is not made yet with its command."""
    show_facts([("damaged", f"{file}: {reason}") for file, reason in result.damaged.items()])
    missing: dict[str, list[str]] = {}
    for entry in result.missing:
        missing.setdefault(entry.command, []).append(entry.what)
    for command, what in missing.items():
        for one in what:
            show_sentence(f"not made yet: {one}", hang=2)
        show_facts([("", command)])
