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


def screen_of_written(found: BuiltIn) -> Screen:
    """Return where a built-in robot was written, and the next command."""
    facts = [("robot", one.name) for one in found.robots]
    next_line = command("inspect", str(found.written))
    return Screen(facts=[*facts, ("written", found.written), ("next", next_line)])


def screen_of_training(system: ProvedSystem, found: TrainedSummary) -> Screen:
    """Return whether a training's conditions hold at fresh random states, and the set's size."""
    what = "hold" if found.holds else "do not all hold"
    rows = [(name, f"{least:.4g}") for name, least in found.margins.items()]
    return Screen(
        "trained" if found.holds else "not trained",
        f": {len(found.margins)} conditions {what} at {found.samples} random states",
        None if found.holds else (("condition", "smallest margin"), rows),
        [
            ("set", system.sizes(found)),
            ("time", f"{found.wall_s:.0f} s"),
            ("run", found.run),
            *([("proof", found.proof)] if found.proof else []),
            ("next", command("simulate" if found.proof else "certify", named(found.run))),
        ],
    )


def screen_of_proof(system: ProvedSystem, found: CertificateRecord) -> Screen:
    """Return what is proved of a run, and where the proof is."""
    reason = f": {found.reason}" if found.reason else ""
    level, least = found.proved_level, found.least_margin
    margins = "" if least is None else f", margins of {at_least(least, 2)} or more"
    to = f" to level {level}, {len(found.conditions)} conditions{margins}" if level else ""
    facts = [
        (f"level {one.level}", one.words[0] if one.proved else one.reason) for one in found.levels
    ]
    for name, one in found.conditions.items():
        if (point := one.counterexample) is not None:
            where = system.place_in_words(point.z)
            facts.append(("broken", f"{name}: margin {point.margin:.3g} at {where}"))
    facts += [
        ("about", system.about_proofs),
        ("boxes", f"{found.boxes} in {found.wall_s:.0f} s; -v prints more"),
        ("proof", found.proof),
        ("next", command("simulate", named(found.run))),
    ]
    return Screen(found.verdict, f"{to}{reason}", None, facts)


def screen_of_export(unit: str, found: FamilyExport) -> Screen:
    """Return where the C files are, and how far they agree with Python."""
    answer, told = "written", ": no C compiler here, so it was not compared"
    if found.max_abs_error is not None:
        answer = "written and compared"
        told = f": largest difference {found.max_abs_error:.4g} {unit} at {found.states} states"
    return Screen(answer, told, None, [("files", ", ".join(found.files))])


def screen_of_report(found: FamilyReport) -> Screen:
    """Return the page to open."""
    facts = [("open", found.report)]
    if found.damaged is not None:
        facts.append(("damaged", found.damaged))
    return Screen("written", f": {found.bytes / 1e6:.1f} MB", None, facts)
