"""Results as tables for a person, on stdout."""

import math
from collections import Counter
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

from rich.text import Text

from neuralgaits._digits import percent
from neuralgaits._printable import counted
from neuralgaits.cli.monitor_screen import show_monitor
from neuralgaits.cli.screen_tables import (
    ROWS,
    number,
    show_facts,
    show_sentence,
    show_table,
    verdict,
)
from neuralgaits.errors import RunError
from neuralgaits.records.link_figures import LOCKSTEP, LinkFigures
from neuralgaits.records.simulated import SimulationSummary
from neuralgaits.records.trained import TrainingProof, TrainingSummary
from neuralgaits.records.training_config import config_of
from neuralgaits.runs import RunFolder
from neuralgaits.runs.shell_words import command


def show_training(result: TrainingSummary) -> None:
    """Show which conditions fail and what to do next, or what the short screen leaves out.

    The verdict and the command to give next stand at the end, where a reader looks first.
    """
    broken, mend = result.broken, []
    if broken:
        worst = sorted(broken.items(), key=lambda item: -item[1].max_violation)
        rows = [
            (name, number(entry.mean_violation), number(entry.max_violation))
            for name, entry in worst
        ]
        show_table(
            ("condition that fails", "mean violation, in scales", "max violation, in scales"),
            rows[:ROWS],
        )
        if len(rows) > ROWS:
            show_sentence(f"and {len(rows) - ROWS} more, by {rows[ROWS][2]} at most")
        mend = _to_mend(result, worst[0][0])
    if result.certificate is not None:
        show_sentence(_proof_of_training(result.certificate))
    facts = [(name, getattr(result, name)) for name in ("robot", "spec", "seed")]
    if result.loss is not None:
        facts.append(("loss", f"{number(result.loss)} on fresh samples"))
    if broken and "speed" in result.commands:
        requested, measured = result.commands["speed"], result.orbit_speeds_m_s
        orbits = (
            "no orbit" if measured is None else f"orbits at {measured[0]:.3g} to {measured[1]:.3g}"
        )
        facts.append(("speed", f"asked {requested.low:g} to {requested.high:g} m/s, {orbits}"))
    if result.step_size < 1.0:
        rate = f"{result.step_size:.2g} of the usual one: larger steps met NaN"
        facts.append(("learning rate", rate))
    if broken:
        facts.append(("time", f"{result.wall_s:.0f} s, {result.compile_s:.0f} s compiling"))
        facts.append(("run", result.run))
        what = counted(len(result.conditions), "condition")
        failed = f"{len(broken)} of {what} {'does' if len(broken) == 1 else 'do'} not hold"
        said = Text.assemble(("the gait failed", "yellow"), f": {failed} on fresh samples")
        facts += [("result", said), *mend]
    show_facts(facts)


def _to_mend(result: TrainingSummary, worst: str) -> list[tuple[str, str]]:
    """Return what to do about failing conditions, the command to try first ahead of the others.

    If the run is missing, it is only general advice.
    """
    # Imported here: few commands need it.
    from neuralgaits.report.page import repeat_commands

    page = "docs/did_not_train.md"
    last = "or loosen", f'without("{worst}") in a spec of your own, see {page}'
    commands: list[tuple[str, str | None]] = []
    try:
        folder = RunFolder.open(Path(result.run))
        commands = [
            ("next", repeat_commands.longer(folder)),
            ("or a seed", repeat_commands.another_seed(folder)),
        ]
        if config_of(folder).given is not None:
            # Its spec is no choice of the user's; a trained policy meets its start as it is made.
            last = "or a network", command("train", repeat_commands.robot_word(folder))
    except RunError:
        pass
    return [*((name, line) for name, line in commands if line), last]


def _proof_of_training(proof: TrainingProof) -> Text:
    """Describe the last certificate of a training, and the repairs that it took."""
    repairs = f"{proof.repairs} repairs of {proof.repair_steps} steps"
    outcome = verdict(proof.verdict)
    if proof.smallest_margin is None:
        names = ", ".join(sorted(proof.failing))
        return Text.assemble(
            outcome, f" at level 1 after {repairs}: {proof.open_boxes} boxes open ({names})"
        )
    margin = f"smallest margin {proof.smallest_margin:.3g} of its scale"
    return Text.assemble(outcome, f" at level 1 after {repairs}, {margin}")


def show_walks(result: SimulationSummary) -> None:
    """Show what stopped each episode, and the gait's figures; the short screen follows."""
    count = len(result.fell)
    reasons = Counter(reason for reason in result.fall_reasons if reason is not None)
    show_table(("fell because", "episodes"), [(why, str(n)) for why, n in reasons.items()])
    if result.push and (fallen := result.fell_after_push):
        show_sentence(
            f"{len(fallen)} of {count} walks ended once their push of {number(result.push)} N s "
            f"was due, within half a second of touchdown {result.touchdowns_before_push}: at step "
            f"{_span(fallen)}"
        )
    figures = result.shown
    if (orbit := result.poincare) is not None:
        figures += [
            ("length of a step, model", orbit.step_length_m, "m"),
            ("Poincaré multiplier, model", orbit.multiplier, ""),
        ]
    figures.append(("speed, × real time", result.real_time_factor, ""))
    rows = [(label, f"{number(v)} {unit}".rstrip()) for label, v, unit in figures if v is not None]
    show_table(("quantity", "value"), rows)
    share = result.saturated_fraction
    usual = 0.05  # Share of ticks at the limit: touchdowns alone cause a tenth of it.
    if share is not None and share > usual:
        show_sentence(
            f"{percent(share, 0)} of ticks are at the torque limit: what walks here has no torque "
            "in reserve; a slower gait (`train --speed`), stronger motors or lower gains have"
        )
    if (given_up := result.relaxed) is not None:
        show_sentence(
            "within limits of torque and friction, outputs could come back slower than commanded "
            f"at {percent(given_up.decrease, 2)} of ticks, and forces were asked that the "
            f"floor does not give at {percent(given_up.contact, 2)}"
        )
    missed = [
        (name, number(error.mean), number(error.worst))
        for name, error in result.command_error.items()
        if error.mean is not None and error.worst is not None
    ]
    show_table(("command", "missed by, mean", "worst"), missed)
    off = result.foothold_error_m
    if off is not None and off.mean is not None and off.worst is not None:
        show_sentence(
            f"feet came down {number(1e3 * off.mean)} mm from the middle of their stones in the "
            f"mean, {number(1e3 * off.worst)} mm at worst"
        )
    if result.link is not None:
        _link(result.link)
    if result.monitor is not None:
        show_monitor(result.monitor)
    _adapted(result)
    _settings_of_walks(result)


def _adapted(result: SimulationSummary) -> None:
    """Show what was adapted and learned from step to step."""
    if result.adapted is not None:
        show_sentence(f"adapted {result.adapted.in_words}")
    if result.believed_lean is not None:
        show_sentence(f"adapted lean: {result.believed_lean.in_words}")
    if result.believed_slope is not None:
        show_sentence(f"adapted slope: {result.believed_slope.in_words}")
    if result.learned_lean is not None:
        show_sentence(f"learned {result.learned_lean.in_words}")


def _settings_of_walks(result: SimulationSummary) -> None:
    """Show what walked, and under which conditions."""
    names = ("plant", "simulator", "controller", "engine", "terrain", "start", "push", "run")
    facts = [(name, value) for name in names if (value := getattr(result, name)) is not None]
    changed = [f"{name}={number(value)}" for name, value in _disturbed(result)]
    settings = [f"{name}={number(value)}" for name, value in (result.command or {}).items()]
    if settings or result.commands is not None:
        facts.append(("told", ", ".join(settings) or str(result.commands)))
    if result.drawn_from is not None:
        facts.append(("robots", f"one a walk, drawn from {result.drawn_from}"))
    show_facts([*facts, *([("disturb", ", ".join(changed))] if changed else [])])


def _span(counts: Sequence[int]) -> str:
    """Format the range of some counts."""
    lowest, highest = min(counts), max(counts)
    return f"{lowest}" if lowest == highest else f"{lowest} to {highest}"


def _link(link: LinkFigures) -> None:
    """Show how the connection to a controller process performed."""
    trips = link.round_trip_us
    p50, p99 = (math.nan, math.nan) if trips is None else (trips.p50, trips.p99)
    place = "in a process of its own" if link.address is None else f"at {link.address}"
    words = (
        f"{link.law} {place}, {link.mode}: {link.ticks} ticks, "
        f"{link.packets_lost} of {link.packets_sent} packets lost, "
        f"{link.packets_late} late, round trip {p50:.0f} µs, p99 {p99:.0f} µs"
    )
    show_sentence(words)
    if link.deadline_misses:
        share = f"{link.deadline_misses} ticks ({percent(link.missed_share, 1)})"
        show_sentence(f"{share} kept the command of the tick before: {_why_missed(link)}")


def _why_missed(link: LinkFigures) -> str:
    """Explain why answers were missed, and whether that matters."""
    if link.mode == LOCKSTEP:
        return (
            "the loss and delay that --link asks for; the simulation waits for everything else, so "
            "the walk is the same each time"
        )
    return (
        "an answer was lost or came too late. A busy machine does that, and the walk differs from "
        "one time to the next; --link lockstep=1 waits for every answer"
    )


def _disturbed(result: SimulationSummary) -> Iterable[tuple[str, Any]]:
    """Return the disturbances that differ from their defaults."""
    from neuralgaits.simulation.setup.disturbance import PlantChanges

    usual = vars(PlantChanges())
    return [(name, value) for name, value in result.changed.items() if value != usual.get(name)]
