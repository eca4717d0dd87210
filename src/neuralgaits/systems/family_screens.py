"""Results about systems of families beside walkers for a person."""

from neuralgaits._digits import at_least
from neuralgaits.records.certified import CertificateRecord
from neuralgaits.records.installed import BuiltIn
from neuralgaits.runs.shell_words import command, named
from neuralgaits.systems.controller_export import FamilyExport
from neuralgaits.systems.family_page import FamilyReport
from neuralgaits.systems.family_run import TrainedSummary
from neuralgaits.systems.proved_system import ProvedSystem
from neuralgaits.systems.system_family import Screen


def screen_of_written(written: BuiltIn) -> Screen:
    """Return where a built-in robot was written, and the next command."""
    facts = [("robot", one.name) for one in written.robots]
    next_line = command("inspect", str(written.written))
    return Screen(facts=[*facts, ("written", written.written), ("next", next_line)])


def screen_of_training(system: ProvedSystem, summary: TrainedSummary) -> Screen:
    """Return whether a training's conditions hold at fresh random states, and the set's size."""
    what = "hold" if summary.holds else "do not all hold"
    rows = [(name, f"{least:.4g}") for name, least in summary.margins.items()]
    return Screen(
        "trained" if summary.holds else "not trained",
        f": {len(summary.margins)} conditions {what} at {summary.samples} random states",
        None if summary.holds else (("condition", "smallest margin"), rows),
        [
            ("set", system.sizes(summary)),
            ("time", f"{summary.wall_s:.0f} s"),
            ("run", summary.run),
            *([("proof", summary.proof)] if summary.proof else []),
            ("next", command("simulate" if summary.proof else "certify", named(summary.run))),
        ],
    )


def screen_of_proof(system: ProvedSystem, certificate: CertificateRecord) -> Screen:
    """Return what is proved of a run, and where the proof is."""
    reason = f": {certificate.reason}" if certificate.reason else ""
    level, least = certificate.proved_level, certificate.least_margin
    margins = "" if least is None else f", margins of {at_least(least, 2)} or more"
    to = f" to level {level}, {len(certificate.conditions)} conditions{margins}" if level else ""
    facts = [
        (f"level {one.level}", one.words[0] if one.proved else one.reason)
        for one in certificate.levels
    ]
    for name, one in certificate.conditions.items():
        if (point := one.counterexample) is not None:
            where = system.place_in_words(point.z)
            facts.append(("broken", f"{name}: margin {point.margin:.3g} at {where}"))
    bounded = f"{certificate.boxes} bounded in the search"
    facts += [
        ("about", system.about_proofs),
        ("boxes", f"{bounded}, {certificate.wall_s:.0f} s; -v prints more"),
        ("proof", certificate.proof),
        ("next", command("simulate", named(certificate.run))),
    ]
    return Screen(certificate.verdict, f"{to}{reason}", None, facts)


def screen_of_export(unit: str, exported: FamilyExport) -> Screen:
    """Return where the C files are, and how far they agree with Python."""
    answer, sentence = "written", ": no C compiler here, so it was not compared"
    if exported.max_abs_error is not None:
        answer = "written and compared"
        sentence = (
            f": largest difference {exported.max_abs_error:.4g} {unit} at {exported.states} states"
        )
    return Screen(answer, sentence, None, [("files", ", ".join(exported.files))])


def screen_of_report(written: FamilyReport, *, exports: bool) -> Screen:
    """Return the screen that names the page to open, and the next command if `exports`."""
    facts = [("open", written.report)]
    if written.damaged is not None:
        facts.append(("damaged", written.damaged))
    if exports:
        facts.append(("next", command("export", named(written.run), "--out", "build/c")))
    return Screen("written", f": {written.bytes / 1e6:.1f} MB", None, facts)
