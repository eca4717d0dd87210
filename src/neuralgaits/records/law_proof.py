"""Statements of level 5 of a proof file about the control laws of an export."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

Clock = Literal["touchdown", "free"]
"""When torques are set: with a tick at each touchdown, or wherever touchdowns lie."""


@dataclass(frozen=True)
class LawProof:
    """Whether level 5 of a proof file is about a control law as an export has it.

    Attributes:
        law: name of the law.
        bandwidth: its double pole of output errors [rad/s]; None for a law without one.
        subject: name of the law that the proof is about.
        hold_s: longest proved time between two ticks [s].
        clock: whether one of the ticks has to be at each touchdown.
        reason: why the proof is not about this law; None if it is.
        model_box: largest errors of the robot's masses [1], centres of mass [m] and inertias [1];
            empty if the proof is about the file's robot alone.
    """

    law: str
    bandwidth: float | None
    subject: str
    hold_s: float
    clock: Clock
    reason: str | None = None
    model_box: tuple[float, ...] = ()

    @property
    def proved(self) -> bool:
        """Whether the proof is about this law."""
        return self.reason is None

    @property
    def words(self) -> str:
        """Return it as a sentence without its full stop."""
        name = self.law if self.bandwidth is None else f"{self.law} at {self.bandwidth:g} rad/s"
        if self.reason is not None:
            return f"{name}: nothing is proved, {self.reason}"
        hold = f"{1e3 * self.hold_s:.7g}"
        clocks = {"touchdown": "one of them at each touchdown", "free": "wherever touchdowns lie"}
        words = f"{name}: proved for ticks at most {hold} ms apart, {clocks[self.clock]}"
        return words + _robots(self.model_box)


def _robots(box: tuple[float, ...]) -> str:
    """Name the robots of a proof that is about others than the file's, too."""
    if not box:
        return ""
    mass, com, inertia = box
    sizes = {
        f"masses by {100.0 * mass:.4g} %": mass,
        f"centres of mass by {1e3 * com:.4g} mm": com,
        f"inertias by {100.0 * inertia:.4g} %": inertia,
    }
    words = ", ".join(word for word, size in sizes.items() if size)
    return f", on robots with both legs alike that are off by at most: {words}; by nothing else"


def summary_of(proofs: Sequence[LawProof]) -> str | None:
    """Return what is proved of some laws in one line; None without a proof of level 5."""
    if not proofs:
        return None
    about = [one.words for one in proofs if one.law == one.subject]
    return about[0] if about else f"nothing is proved, the proof is about {proofs[0].subject}"
