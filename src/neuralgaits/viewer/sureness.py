"""How sure we are of a run's gait, in a few lines of Markdown, and whether its proof is its own."""

from typing import NamedTuple

from neuralgaits._digits import at_least
from neuralgaits.analysis.run import Run
from neuralgaits.certificate.reading import read_certificate
from neuralgaits.records.certified import PROOF, Certified
from neuralgaits.runs.commands import command, named
from neuralgaits.viewer import markdown


class Sureness(NamedTuple):
    """What is known of a gait."""

    certified: bool
    """Whether there is a certificate of this very gait."""
    words: str
    """Markdown."""
    map_fits: bool = False
    """Whether the map of boxes was made with the proof."""


def how_sure(run: Run) -> Sureness:
    """Read the certificate's answer as far as the run's proof files bear it out.

    The boxes are not bounded again here: `check-proof` does that.
    """
    again = markdown.code(command("certify", named(run.path)))
    found = read_certificate(run.folder)
    if found.summary is None and found.reason is None:
        return Sureness(
            False,
            "**Nothing is proved of this gait.** Training looked at samples. "
            f"{again} looks for a proof.",
        )
    if found.summary is None:
        return Sureness(
            False,
            f"**There is no certificate of this gait**: {markdown.text(str(found.reason))}. "
            f"{again} looks for a new one.",
        )
    return Sureness(True, "\n\n".join(_lines(run, found.summary)), found.map_fits)


def _lines(run: Run, answer: Certified) -> list[str]:
    lines = [f"**{answer.verdict.capitalize()} at level {answer.level}**"]
    level, count, least = answer.proved_level, len(answer.conditions), answer.least_margin
    if level and least is not None:
        lines.append(
            f"Each of {count} conditions holds at every state of its region, by "
            f"{at_least(least, 3)} of its scale or more."
        )
    for word in ("refuted", "undecided"):
        if names := answer.named(word):
            listed = markdown.text(", ".join(names))
            lines.append(f"{len(names)} of {count} conditions {word}: {listed}.")
    for entry in answer.levels:
        lines += [f"{markdown.text(sentence)}." for sentence in entry.words[:2]]
    about = "This is about the zero dynamics of the rigid model"
    if level == 4:
        about += ", and at level 4 about the whole of it under an exact controller without delay"
    lines.append(
        f"{about}; not about MuJoCo, pushes, slopes or other masses: what you see here is a "
        "simulation, and may fall."
    )
    if answer.proof:
        check = command("check-proof", named(run.path / PROOF), "--run", named(run.path))
        lines.append(f"{markdown.code(check)} checks it again.")
    return lines
