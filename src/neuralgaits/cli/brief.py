"""The few lines that a command ends with: the answer, its key numbers, what to open and do next.

At most six lines each, long ones wrapped. `-v` prints the rest above them, `--json` all of it. With
`hint` a line says so.
"""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from rich.text import Text

from neuralgaits._commands import KNOWN_COMMANDS
from neuralgaits._digits import at_least, percent
from neuralgaits._printable import counted
from neuralgaits.cli.screen_tables import number, show_facts, show_sentence, verdict
from neuralgaits.errors import RunError
from neuralgaits.records.certified import PROOF, CertificateRecord
from neuralgaits.records.final_boxes import boxes_of_proof
from neuralgaits.records.fitted import FitSummary
from neuralgaits.records.law_proof import LawProof
from neuralgaits.records.level_words import DISTURBED_LEVEL, FULL_ORDER_LEVEL, WORDS
from neuralgaits.records.reported import ReportRecord
from neuralgaits.records.simulated import SimulationSummary
from neuralgaits.records.trained import TrainingSummary
from neuralgaits.runs import RunFolder
from neuralgaits.runs.shell_words import command, named
from neuralgaits.settings import CertifySettings
from neuralgaits.settings.forms import command_word
from neuralgaits.settings.options import words_of

_MORE = "-v prints more"


def _hinted(text: str, hint: bool, joint: str = "; ") -> str:
    """Return a line that ends with how to get the rest, if that is not there already."""
    return f"{text}{joint}{_MORE}" if hint else text


def brief_training(result: TrainingSummary, *, hint: bool = True) -> None:
    """Print whether a training's conditions hold on fresh samples, and what to do next."""
    assert not result.broken  # A training that failed is shown whole.
    count = len(result.conditions)
    sentence = "its condition holds" if count == 1 else f"all {count} conditions hold"
    show_sentence(Text("trained", "green"), f": {sentence} on fresh samples")
    facts: list[tuple[str, Any]] = []
    if result.certificate is not None:
        margin = result.certificate.smallest_margin
        least = "" if margin is None else f", margins of {at_least(margin, 3)} or more"
        facts.append(("proof", f"{result.certificate.verdict} at level 1{least}"))
    if "speed" in result.commands:
        requested, measured = result.commands["speed"], result.orbit_speeds_m_s
        orbits = (
            "no orbit"
            if measured is None
            else f"orbits at {measured[0]:.3g} to {measured[1]:.3g} m/s"
        )
        facts.append(("speed", f"requested {requested.low:g} to {requested.high:g} m/s, {orbits}"))
        if measured is not None and (slower := requested.high - measured[1]) > 0.01 * measured[1]:
            # Twice as much more: what is added is missed by as large a share.
            wider = f"--speed {requested.low:g}:{requested.high + 2.0 * slower:.3g}"
            facts.append(
                ("slower", f"by {slower:.2g} m/s than requested at the upper end: train {wider}")
            )
    facts.append(("time", f"{result.wall_s:.0f} s, {result.compile_s:.0f} s of it compiling"))
    facts += [("run", result.run), ("next", command("simulate", named(result.run)))]
    show_facts(facts)


def brief_walks(result: SimulationSummary, *, hint: bool = True) -> None:
    """Print how many walks stayed up, how fast they went, and what made others fall."""
    count, steps = len(result.fell), result.steps_walked or (0,)
    span = f"{min(steps)}" if len(set(steps)) == 1 else f"{min(steps)} to {max(steps)}"
    answer = Text("walks", "green") if result.stayed == count else Text("falls", "red")
    setting = f"{result.walked_by}{result.met}{_commanded(result)}"
    show_sentence(
        answer,
        f": {result.stayed} of {count} episodes stayed up, "
        f"{span} step{'' if span == '1' else 's'}, {setting}",
    )
    reasons = sorted({reason for reason in result.fall_reasons if reason})
    key = (
        ("speed", result.speed_m_s, f"m/s{_told_speed(result)}"),
        ("cost of transport", result.cost_of_transport, ""),
        ("peak torque", result.peak_torque_nm, "N m"),
        ("output error up to", result.max_output_error_rad, "rad"),
    )
    numbers = [f"{what} {number(value)} {unit}".rstrip() for what, value, unit in key if value]
    numbers += [
        f"{name} off its command by {number(error.mean)} {KNOWN_COMMANDS[name].unit} on average"
        for name, error in result.command_error.items()
        if error.mean is not None and not (name == "speed" and _told_speed(result))
    ]
    if result.push and (fallen := result.fell_after_push):
        which = "" if count == 1 else f"{len(fallen)} of {counted(count, 'walk')} "
        reasons.append(f"{which}after the push of {number(result.push)} N s")
    facts: list[tuple[str, Any]] = [("fell", ", ".join(reasons))] if reasons else []
    if line := ", ".join([*numbers, *([_MORE] if hint else [])]):
        facts.append(("numbers", line))
    if share := result.saturated_fraction:
        facts.append(("torque", f"at its limit in {percent(share, 1)} of ticks"))
    if (link := result.link) is not None and link.deadline_misses:
        late = f"{link.deadline_misses} of {link.ticks} ticks kept the command of the tick before"
        facts.append(("link", late))
    if (monitored := result.monitor) is not None:
        shares = (
            f"{percent(one.inside, 2)} in the set of level {levels}"
            for levels, one in monitored.by_set
        )
        facts.append(("monitor", f"of {monitored.ticks} ticks, {', '.join(shares)}"))
    if result.adapted is not None:
        facts.append(("adapted", result.adapted.in_words))
    if result.believed_lean is not None:
        facts.append(("lean", result.believed_lean.in_words))
    elif result.learned_lean is not None:
        facts.append(("learned", result.learned_lean.in_words))
    if result.believed_slope is not None:
        facts.append(("slope", result.believed_slope.in_words))
    facts.append(("next", _after_walks(result)))
    show_facts(facts)


def _commanded(result: SimulationSummary) -> str:
    """Return the commands of walks as the command line takes them; empty without."""
    if result.commands is not None:
        return f", commands {result.commands}"
    return "".join(f", {command_word({name: v})}" for name, v in (result.command or {}).items())


def _told_speed(result: SimulationSummary) -> str:
    """Return the constant speed that walks were commanded, beside the measured one."""
    speed = (result.command or {}).get("speed")
    return "" if speed is None or result.adapt else f" where {number(speed)} was commanded"


def _after_walks(result: SimulationSummary) -> str:
    """Return the command to give next: look at a fall, prove a gait, read about a proved one."""
    if result.stayed < len(result.fell):
        return command("view", named(result.run))
    proved = (Path(result.run) / PROOF).is_file()
    return command("report" if proved else "certify", named(result.run))


def brief_proof(result: CertificateRecord, *, hint: bool = True) -> None:
    """Print what is proved, or which conditions are not, and where the proof is."""
    entries = result.conditions
    open_ = [name for name, one in entries.items() if not one.proved_as_requested]
    about = "".join(f", {part}" for part in (result.robots, result.ground) if part)
    level, least = result.proved_level, result.least_margin
    margins = "" if least is None else f", margins of {at_least(least, 4)} or more"
    sentence = ""
    if level:
        sentence = (
            f"level {level} ({WORDS[level].about}{about}): {len(entries)} conditions{margins}"
        )
    facts: list[tuple[str, Any]] = []
    if result.verdict == "proved":
        show_sentence(verdict(result.verdict), f" to {sentence}")
        facts += [("note", result.reason)] if result.reason else []
    else:
        reason = f": {result.reason}" if result.reason else ""
        at = f" at level {result.level}"
        if result.verdict == "refuted" and result.level > 1:
            # A condition is refuted; nothing above stands on it.
            at = f" at level 1, level {result.level} was requested"
        show_sentence(verdict(result.verdict), f"{at}{about}{reason}")
        facts += [("proved", sentence)] if sentence else []
    for name, one in entries.items():
        if (point := one.counterexample) is not None:
            z = ", ".join(f"{value:.6g}" for value in point.z)
            facts.append(("broken", f"{name}: margin {point.margin:.3g} at z = ({z})"))
            break
    if open_:
        facts.append(("open", listed(sorted(open_, key=lambda n: entries[n].verdict != "refuted"))))
    above = next((one for one in result.levels if not one.proved), None)
    if above is not None and not open_:
        facts.append((f"level {above.level}", above.reason or above.verdict))
    if level and not open_ and above is None:
        if level > FULL_ORDER_LEVEL:
            subject = "the rigid model, joints off target, under torques within level 5's bounds"
            facts += _law(result)
        elif level == FULL_ORDER_LEVEL:
            subject = (
                "the rigid model under exact linearisation in continuous time, joints off target"
            )
        else:
            subject = "the model with every joint exactly where the gait wants it"
        facts.append(("about", subject))
    boxes = f"{result.boxes} bounded"
    if (final := boxes_of_proof(result.proof)) is not None:
        boxes = f"{final} in the proof file ({boxes} in the search)"
    facts.append(("boxes", _hinted(f"{boxes}, {result.wall_s:.0f} s", hint)))
    facts += [("proof", result.proof)] if result.proof else []
    facts.append(("next", _after_proof(result)))
    show_facts(facts)


def _law(result: CertificateRecord) -> list[tuple[str, str]]:
    """Say of which control law level 5 is, and of which ticks; nothing if it is of no held torque.

    The law's own rest and the kick at a touchdown are constants of that law and that clock alone.
    """
    figures = {one.level: one.figures for one in result.levels}
    full, disturbed = figures[FULL_ORDER_LEVEL], figures[DISTURBED_LEVEL]
    if "hold" not in disturbed:
        return []
    name = "scheduled-pd" if "rest" in disturbed else "fblin"
    clock = "free" if "kick" in disturbed else "touchdown"
    errors = "mass error", "centre error", "inertia error"
    box = tuple(disturbed[one] for one in errors if one in disturbed)
    proof = LawProof(name, full["w"], name, disturbed["hold"], clock, model_box=box)
    return [("law", proof.words)]


def _after_proof(result: CertificateRecord) -> str:
    """Return the command to give next: read about what is proved, search on, or train again."""
    if result.proved_level:
        return command("report", named(result.run))
    left = any(one.undecided_boxes for one in result.conditions.values())
    if result.verdict != "refuted" and left:
        asked = CertifySettings(
            named(result.run),
            level=result.level,
            within=result.within,
            parameters=result.parameters or None,
            resume=True,
        )
        return command("certify", *words_of(asked, CertifySettings))
    if result.verdict != "refuted":
        return command("report", named(result.run))
    from neuralgaits.report.page import repeat_commands

    try:
        folder = RunFolder.open(Path(result.run))
        again = repeat_commands.another_seed(folder)
        return again or command("train", repeat_commands.robot_word(folder), "--certify")
    except RunError:
        return command("train", "ROBOT", "--certify")


def brief_fit(result: FitSummary, *, hint: bool = True) -> None:
    """Print by how much a residual lowers the prediction error, and what error it leaves."""
    learned, nominal = result.heldout_error, result.nominal_heldout_error
    if result.better and nominal and learned is not None:
        share = f"{100.0 * (1.0 - learned / nominal):.3g} %"
        answer = Text("learned", "green")
        show_sentence(answer, f": prediction error on held-out strides reduced by {share}")
    else:
        show_sentence(
            Text("not learned", "red"), ": no smaller prediction error on held-out strides"
        )
    bound = ", ".join(
        f"{number(value)} {unit}"
        for value, unit in zip(result.error_bound, ("m/s", "N m"), strict=True)
        if value is not None
    )
    show_facts(
        [
            ("remaining", f"error bound on dz, from held-out strides: {bound or 'unknown'}"),
            ("used", _hinted(f"{result.walked_s:.1f} s of walking", hint)),
            ("residual", result.residual),
            ("next", command("refine", named(result.run))),
        ]
    )


def brief_report(result: ReportRecord, *, hint: bool = True) -> None:
    """Print the page to open, what is damaged, and how much could still be made."""
    size = f"{len(result.figures)} figures, {result.bytes / 1e6:.1f} MB, opens without a network"
    show_sentence(Text("written", "green"), f": {size}")
    facts = [("open", result.report)]
    if result.damaged:
        facts.append(("damaged", _damaged(result, hint)))
    if result.missing:
        count = len(result.missing)
        what = f"{counted(count, 'optional part')} not made yet"
        facts.append(("missing", f"{what}; {'-v lists them' if hint else 'listed above'}"))
    facts.append(("next", command("view", named(result.run))))
    show_facts(facts)


def _damaged(result: ReportRecord, hint: bool) -> str:
    """Return why one file could not be read, or the names of several."""
    if len(result.damaged) > 1:
        return _hinted(listed(list(result.damaged)), hint)
    ((file, reason),) = result.damaged.items()
    return reason if reason.startswith(file) else f"{file}: {reason}"


def listed(names: Sequence[str]) -> str:
    """Return the first names, and how many more there are."""
    named_at_most = 3  # Conditions that a line names before it counts.
    more = len(names) - named_at_most
    return ", ".join(names[:named_at_most]) + (f" and {more} more" if more > 0 else "")
