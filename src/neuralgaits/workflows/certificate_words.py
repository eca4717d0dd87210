"""How sure we are of a run's gait, in a few lines of Markdown, and whether its proof is its own."""

from pathlib import Path
from typing import NamedTuple

from neuralgaits.certificate.claims import InconsistentError, read_claims
from neuralgaits.certificate.run_match import differences
from neuralgaits.errors import NeuralGaitsError
from neuralgaits.workflows.run import Run

PROOF, SUMMARY = "certificate/proof.json", "certificate/summary.json"


class Sureness(NamedTuple):
    """What is known of a gait."""

    certified: bool
    """Whether there is a certificate of this very gait."""
    words: str
    """Markdown."""


def how_sure(run: Run) -> Sureness:
    """Read the certificate's answer and compare its proof with the run, hash by hash.

    The proof is not checked again here: `check-proof` does that.
    """
    if not (run.path / SUMMARY).is_file():
        return Sureness(
            False,
            "**Nothing is proved of this gait.** Training looked at samples. "
            f"`neuralgaits certify {run.path}` looks for a proof.",
        )
    wrong = _mismatch(run.path)
    if wrong is not None:
        return Sureness(
            False,
            f"**The certificate is not about this gait**: {wrong}. "
            f"`neuralgaits certify {run.path}` looks for a new one.",
        )
    answer = run.folder.read_json(SUMMARY)
    lines = [f"**{answer['verdict'].capitalize()} at level {answer['level']}**"]
    margins = [one["margin"] for one in answer["conditions"].values() if one["margin"] is not None]
    if margins and answer["verdict"] == "proved":
        lines.append(
            f"Each of {len(answer['conditions'])} conditions holds at every state of its region, "
            f"by {min(margins):.3f} of its scale or more."
        )
    for level in answer["levels"]:
        lines += [f"{sentence}." for sentence in level["words"][:2]]
    lines.append(
        "This is about the zero dynamics of the rigid model, not about MuJoCo, pushes, slopes or "
        "other masses: what you see here is a simulation, and may fall. "
        f"`neuralgaits check-proof {run.path / PROOF} --run {run.path}` checks it again."
    )
    return Sureness(True, "\n\n".join(lines))


def _mismatch(path: Path) -> str | None:
    """What of the proof is not the run's; None if all of it is."""
    try:
        wrong = differences(read_claims(path / PROOF), path)
    except InconsistentError as error:
        return f"its proof contradicts itself ({error})"
    except (NeuralGaitsError, OSError) as error:
        return f"its proof cannot be read ({error})"
    return wrong[0] if wrong else None
