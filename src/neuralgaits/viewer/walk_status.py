"""The line of a live page about a walk: steps, speed and time, or how it ended."""

from typing import Protocol

from neuralgaits._printable import counted
from neuralgaits.viewer.page_style import BAD, GOOD, QUIET, TIGHT, line
from neuralgaits.viewer.player import Picture


class WalkFacts(Protocol):
    """Numbers of a walk at one moment, see `viewer.walker.WalkFrame`."""

    @property
    def steps(self) -> int:
        """Touchdowns since the last start."""
        ...

    @property
    def speed(self) -> float:
        """Mean forward speed over the last whole step [m/s]."""
        ...

    @property
    def walked(self) -> float:
        """Simulated time since the last start [s]."""
        ...

    @property
    def fall(self) -> str | None:
        """Reason why the robot fell or stopped; None while it walks."""
        ...

    @property
    def upright(self) -> bool:
        """Whether the robot stands upright although its walk has ended."""
        ...


def walk_line(picture: Picture, shown: WalkFacts, speed: float) -> str:
    """Return the line as HTML; `speed` is the playback speed that was asked for."""
    facts = f"steps {shown.steps} · forward speed {shown.speed:.2f} m/s · {shown.walked:.1f} s"
    if shown.fall is not None:
        return line(ended(shown, picture.reset_in), BAD, strong=True)
    if picture.paused:
        return line(f"Paused · {facts}", QUIET)
    if picture.pace < 0.9 * speed:
        return line(f"Walks · {facts}", GOOD) + slow_line(picture.pace, speed)
    return line(f"Walks · {facts}", GOOD)


def slow_line(pace: float, speed: float) -> str:
    """Return a line of HTML that says that the machine is too slow.

    Args:
        pace: playback speed that is reached, × real time.
        speed: playback speed that was asked for, × real time.
    """
    reached = "less than ×0.01" if pace < 0.01 else f"×{pace:.2g}"
    return line(f"Playback: asked ×{speed:g}, this machine manages {reached}", TIGHT)


def ended(shown: WalkFacts, left: float | None) -> str:
    """Say why a walk ended, and what the visitor can do next.

    Args:
        shown: last moment of the walk.
        left: time until the robot is put back (s); None if the visitor does that.
    """
    what = "Stopped" if shown.upright else "Fell"
    text = f"{what}: {shown.fall}, after {counted(shown.steps, 'step')}. "
    text += "Press Reset" if left is None else f"Reset in {left:.0f} s"
    return text + ("; push it forward where it slows down." if shown.upright else ".")
