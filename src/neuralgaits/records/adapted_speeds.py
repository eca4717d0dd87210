"""Speeds of a walk whose commanded speed was adapted: a part of the result of `simulate`."""

import math
from dataclasses import dataclass

from neuralgaits.records.record import Count

SETTLED_STEPS = 10
"""Steps at the start of a walk after which an adapted speed has settled, where it can."""


@dataclass(frozen=True)
class LearnedLean:
    """How far the torso's centre of mass is ahead of the file's, by the first walk's joint angles.

    Attributes:
        mean_m: mean over its whole steps, positive forward [m].
        spread_m: standard deviation from step to step [m].
        steps: number of these steps.
    """

    mean_m: float
    spread_m: float
    steps: Count

    @property
    def in_words(self) -> str:
        """The lean in millimetres, and from what."""
        return (
            f"torso's centre of mass {abs(1e3 * self.mean_m):.1f} mm {_side(self.mean_m)} the "
            "file's, by "
            f"{self.steps} steps (spread {1e3 * self.spread_m:.1f} mm)"
        )


_END_OF_RANGE = ", the end of the gait's range: more than that it cannot learn"


@dataclass(frozen=True)
class BelievedLean:
    """Leans that the first walk believed in.

    Attributes:
        believed_m: lean of each step that ended with a touchdown, positive forward [m].
        proved_level: level up to which the run's proof is about every sequence of beliefs in the
            range of the command; None without such a proof.
        near_m: how far from its belief a robot may be that the proof is about [m]; None without.
        at_end: whether the last belief stands at an end of the command's range.
    """

    believed_m: tuple[float, ...]
    proved_level: Count | None = None
    near_m: float | None = None
    at_end: bool = False

    @property
    def in_words(self) -> str:
        """The last belief, in millimetres, and what is proved of beliefs."""
        outcome = "too few steps to learn it"
        if self.believed_m:
            last = self.believed_m[-1]
            outcome = (
                f"believed {abs(1e3 * last):.1f} mm {_side(last)} the file's after "
                f"{len(self.believed_m)} steps{_END_OF_RANGE if self.at_end else ''}"
            )
        about = "no proof of this run is about what it believes"
        if self.proved_level is not None and self.near_m is not None:
            about = (
                f"the run's proof, to level {self.proved_level}, is about every sequence of "
                f"beliefs, of robots within {1e3 * self.near_m:g} mm of theirs"
            )
        return f"{outcome}; {about}"


@dataclass(frozen=True)
class BelievedSlope:
    """Slopes of the ground that the first walk believed in.

    Attributes:
        believed_rad: slope of each step that ended with a touchdown, positive uphill [rad].
        proved_level: level up to which the run's proof is about every sequence of slopes in the
            range of the command; None without such a proof.
        at_end: whether the last belief stands at an end of the command's range.
    """

    believed_rad: tuple[float, ...]
    proved_level: Count | None = None
    at_end: bool = False

    @property
    def in_words(self) -> str:
        """The last belief, in degrees, and what is proved of beliefs."""
        outcome = "too few steps to learn it"
        if self.believed_rad:
            last = math.degrees(self.believed_rad[-1])
            way = "uphill" if last >= 0.0 else "downhill"
            outcome = f"believed {abs(last):.2f} degrees {way} after {len(self.believed_rad)} steps"
            outcome += _END_OF_RANGE if self.at_end else ""
        about = "no proof of this run is about what it believes"
        if self.proved_level is not None:
            about = (
                f"the run's proof, to level {self.proved_level}, is about every sequence of "
                "slopes, on ground that is as believed"
            )
        return f"{outcome}; {about}"


def _side(lean: float) -> str:
    return "ahead of" if lean >= 0.0 else "behind"


@dataclass(frozen=True)
class AdaptedSpeeds:
    """Speeds of the first walk, a value for each step between two touchdowns [m/s].

    Attributes:
        told: speed that the user told the step, spread over steps as the gait's changes are.
        commanded: speed that the adapter chose and the controller latched.
        walked: mean forward speed of the hip in the simulator.
        measured: the same by the robot's joint angles and pitch; None where it is not known.
        proved_level: level up to which the run's proof is about every sequence of commands in the
            range that is adapted in; None without such a proof.
    """

    SAME_LENGTH = ("told", "commanded", "walked", "measured")

    told: tuple[float, ...]
    commanded: tuple[float, ...]
    walked: tuple[float, ...]
    measured: tuple[float | None, ...]
    proved_level: Count | None = None

    @property
    def settled(self) -> tuple[float, float] | None:
        """Mean told and walked speed after the first steps (m/s); None of a shorter walk."""
        told, walked = self.told[SETTLED_STEPS:], self.walked[SETTLED_STEPS:]
        return (sum(told) / len(told), sum(walked) / len(walked)) if told else None

    @property
    def in_words(self) -> str:
        """How near the walked speed came, and what is proved of the commands."""
        outcome = "too few steps to settle"
        if (means := self.settled) is not None:
            outcome = (
                f"walked {means[1]:.3f} m/s for {means[0]:.3f} m/s after {SETTLED_STEPS} steps"
            )
        about = "no proof of this run is about the commands that it can choose"
        if self.proved_level is not None:
            about = (
                f"the run's proof, to level {self.proved_level}, is about every sequence of "
                "commands that it can choose"
            )
        return f"speed: {outcome}; {about}"
