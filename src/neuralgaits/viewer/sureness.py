"""Evidence for a run's gait, in the report's words, and whether its proof is about this gait."""

from collections.abc import Mapping
from typing import NamedTuple

from neuralgaits.analysis.run import Run
from neuralgaits.analysis.state_monitor import StateMonitor
from neuralgaits.certificate.run_certificate.proved_monitor import monitor_of
from neuralgaits.certificate.run_certificate.verified_summary import (
    CertificateReading,
    ProvedPart,
    read_certificate,
)
from neuralgaits.errors import SpecError
from neuralgaits.gait.commands import LEAN, SLOPE
from neuralgaits.records import certificate_sentences
from neuralgaits.records.certified import PROOF, CertificateRecord
from neuralgaits.records.level_words import HIGHEST
from neuralgaits.runs import packed
from neuralgaits.runs.shell_words import command, named
from neuralgaits.viewer import markdown

_OF_THE_FLOOR = {SLOPE, "step_height"}
"""Commands that tell the gait how the floor lies."""


class Sureness(NamedTuple):
    """Evidence for a gait, as shown on the page."""

    certified: bool
    """Whether there is a certificate of exactly this gait."""
    verdict: str
    """The answer in one line."""
    words: str
    """Summary in Markdown."""
    map_fits: bool = False
    """Whether the map of boxes was made with the proof."""
    theorem: str = ""
    """Statements of the proof file, word by word, in Markdown; empty if there are none."""
    monitor: StateMonitor | None = None
    """Sets that are proved of the gait; None if there are none."""
    beliefs_within: float | None = None
    """Distance of a robot from its believed lean up to which the proof file states level 2 or more
    [m]; None if it states none for all commands."""
    proved_of: str = ""
    """Robot and floor that the proof is about, in words; empty if nothing is proved."""


def how_sure(run: Run, words: Mapping[str, str] | None = None) -> Sureness:
    """Read the certificate's answer, as far as the run's proof files support it.

    It does not bound the boxes again; `check-proof` does.

    Args:
        run: run that walks.
        words: what its conditions state, by name, as the bars have it.
    """
    again = markdown.code(command("certify", named(run.path)))
    watched = "You watch a simulation: the robot may fall."
    reading = read_certificate(run.folder)
    if reading.summary is None and reading.reason is None:
        return Sureness(
            False,
            f"Nothing is proved of this gait. {watched}",
            "**Nothing is proved of this gait.** What training records is of samples. "
            f"{again} looks for a proof.",
        )
    if reading.summary is None:
        return Sureness(
            False,
            f"There is no certificate of this gait. {watched}",
            f"**There is no certificate of this gait**: {markdown.text(str(reading.reason))}. "
            f"{again} looks for a new one.",
        )
    text = "\n\n".join(_lines(run, reading.summary, reading.part, words))
    verdict = f"{verdict_of(reading.summary, reading.part)} {watched}"
    monitor = _monitor(run, reading)
    if monitor is not None:
        comparison = (
            "**Inside the proved set** compares the controller's state with the set that a level "
            "is about. That set is one of the model under the proof's own controller: inside, this "
            "robot may still fall, and outside, nothing is proved. Around a touchdown some ticks "
            "are outside: an impact takes about 3 ms in MuJoCo's soft contact, and no time in the "
            "model."
        )
        text += f"\n\n{comparison}"
    within = reading.summary.parameters.get(LEAN) if reading.summary.proved_level >= 2 else None
    theorem = _theorem(reading.summary)
    return Sureness(
        True,
        verdict,
        text,
        reading.map_fits,
        theorem,
        monitor,
        within,
        _proved_of(run, reading.summary, reading.part),
    )


def _proved_of(run: Run, answer: CertificateRecord, part: ProvedPart | None) -> str:
    """Name robot and floor that a proof is about; "" if nothing is proved."""
    if not answer.proved_level and not (part is not None and part.conditions):
        return ""
    robots = answer.all_robots
    commands = {one.name for one in run.trained.commands}
    robot = "the robot of its file" if robots is None else f"robots {robots}"
    if robots is None and LEAN in commands:
        robot = "a robot that leans as it believes"
    if answer.ground:
        return f"{robot}, on floors with {answer.ground}"
    if commands & _OF_THE_FLOOR:
        return f"{robot}, on the floor of its commands"
    return f"{robot}, on a level floor"


def _monitor(run: Run, reading: CertificateReading) -> StateMonitor | None:
    """Return the monitor of a run; None if nothing above level 1 is proved, or it cannot be."""
    try:
        return monitor_of(run, reading)
    except SpecError:
        return None


def verdict_of(answer: CertificateRecord, part: ProvedPart | None) -> str:
    """Say in a few words which level the proof file states, and of what."""
    if part is not None and part.conditions:
        return "The proof file is about some commands only: see below."
    if not answer.proved_level:
        return f"Not proved: {answer.verdict} at level {answer.level}."
    robots = ", for a box of robots" if answer.robots else ""
    if (near := answer.parameters.get(LEAN)) is not None:
        robots = f", for every robot whose lean is within {1e3 * near:g} mm of its belief"
    return f"The proof file states level {answer.proved_level} of {HIGHEST}{robots}."


def _of_part(part: ProvedPart, count: int) -> str:
    """Describe the proof for a part of the commands; the gait has `count` conditions."""
    sentence = f"{len(part.conditions)} of {count} conditions hold at every state of their regions"
    levels = (entry.level for entry in part.levels)
    text = markdown.text(certificate_sentences.states_with_commands(levels, sentence))
    where = markdown.text("; ".join(part.sequences))
    return f"**Proved of some commands only: {where}.** There, {text}. Of others nothing is proved."


def _lines(
    run: Run,
    answer: CertificateRecord,
    part: ProvedPart | None,
    words: Mapping[str, str] | None,
) -> list[str]:
    """Return the report's words, and how they relate to the simulation on the page."""
    level = answer.proved_level
    text = (
        certificate_sentences.proved(answer, bool(run.config.commands), words)
        if level
        else _not_proved(answer)
    )
    lines = [markdown.text(text)]
    if part is not None and part.conditions:
        lines = [_of_part(part, len(answer.conditions))]
        level = max((entry.level for entry in part.levels), default=0)
    samples = (
        "What you see here is a MuJoCo simulation of the whole robot, with whatever you do to "
        "it: it may fall."
    )
    if level:
        lines.append(markdown.text(certificate_sentences.AS_STATED))
        claims = f"It claims nothing about {certificate_sentences.not_claimed(level)}."
        rests = markdown.text(
            f"{certificate_sentences.left_open(level, answer.robots)} {claims} {samples}"
        )
        lines.append(f"**What is not covered.** {rests}")
    else:
        lines.append(samples)
    if answer.proof:
        file = named(packed.place(run.path / PROOF))
        check = command("check-proof", file, "--run", named(run.path))
        many_boxes = 10_000_000
        if answer.boxes > many_boxes:
            # In Python that many take hours or days.
            check = f"make proofcheck && build/proofcheck {file}"
        lines.append(f"{markdown.code(check)} checks every box of it.")
    return lines


def _not_proved(answer: CertificateRecord) -> str:
    why = certificate_sentences.not_proved(answer)
    return f"Not proved: {answer.verdict} at level {answer.level}. {why}"


def _theorem(answer: CertificateRecord) -> str:
    """Return the levels' statements from the proof file, as a list."""
    return "\n".join(
        f"- Level {entry.level}: {markdown.text(sentence)}."
        for entry in answer.levels
        for sentence in entry.words
    )
