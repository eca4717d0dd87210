"""The lean that the robot believes in beside the true one: two marks on a line, and a sentence."""

from typing import NamedTuple

import numpy as np

from neuralgaits._types import Float
from neuralgaits.gait.commands import LEAN, Commands, place_of
from neuralgaits.viewer.page_style import GOOD, QUIET, TIGHT, Ink, line


class LeanMarks(NamedTuple):
    """How far the torso's centre of mass is ahead of the file's, by the robot and in the plant."""

    believed: float
    """Lean that the controller latched for the step under way [m]."""
    true: float
    """Lean of the simulated torso [m]."""
    low: float
    """Least lean that the gait takes [m]."""
    high: float
    """Largest lean that the gait takes [m]."""
    proved_within: float | None
    """Distance of a robot from its belief up to which the proof file states level 2 or more [m];
    None if it states no such level of the gait."""
    doubted: bool = False
    """Whether the last step showed a lean that cannot be."""

    @property
    def covered(self) -> bool | None:
        """Return whether the belief is within the proved distance; None if none is proved."""
        if self.proved_within is None:
            return None
        return abs(self.true - self.believed) <= self.proved_within


def lean_of(
    commands: Commands,
    latched: Float[np.ndarray, " p"],
    true: float,
    proved_within: float | None,
    *,
    doubted: bool = False,
) -> LeanMarks | None:
    """Return the believed lean of a step beside the true one; None if the gait takes none.

    Args:
        commands: commands of the gait.
        latched: their values in the step under way. [p]
        true: lean of the simulated torso (m).
        proved_within: see `LeanMarks` (m).
        doubted: see `LeanMarks`.
    """
    if (place := place_of(commands, LEAN)) is None:
        return None
    lean = commands[place]
    return LeanMarks(float(latched[place]), true, lean.low, lean.high, proved_within, doubted)


def lean_html(lean: LeanMarks | None) -> str:
    """Return HTML of a belief: marks of belief and truth, and what the proof file says of it."""
    if lean is None:
        return ""
    ink = QUIET if lean.covered is None else GOOD if lean.covered else TIGHT
    return _marks(lean, ink) + line(_words(lean), ink)


def _words(lean: LeanMarks) -> str:
    off = 1e3 * abs(lean.true - lean.believed)
    text = (
        f"Torso ahead of the file: believed {1e3 * lean.believed:+.1f} mm, "
        f"true {1e3 * lean.true:+.1f} mm"
    )
    if lean.doubted:
        text += " (the last step showed one that cannot be; the belief stays)"
    if lean.proved_within is None:
        return f"{text}, {off:.1f} mm off; no proof is about what it believes"
    near = f"{1e3 * lean.proved_within:g} mm"
    if lean.covered:
        return f"{text}: within the {near} that the proof file is about"
    return f"{text}: beyond the {near} that the proof file is about, nothing is proved now"


def _marks(lean: LeanMarks, ink: Ink) -> str:
    """Return a line over the range of leans, the belief as a bar on it and the truth as a ring."""
    middle = 0.5 * (lean.low + lean.high)
    half = max(0.5 * (lean.high - lean.low), abs(lean.true - middle))

    def place(value: float) -> float:
        return 50.0 + 46.0 * (value - middle) / half

    band = ""
    if lean.proved_within is not None:
        width = 2.0 * 46.0 * lean.proved_within / half
        band = (
            f'<span style="position:absolute;top:4px;height:8px;opacity:.25;'
            f"left:{place(lean.believed) - 0.5 * width:.2f}%;width:{width:.2f}%;"
            f'background:{ink.light}"></span>'
        )
    belief = (
        f'<span style="position:absolute;top:1px;height:14px;width:3px;margin-left:-1px;'
        f'left:{place(lean.believed):.2f}%;background:{ink.light}"></span>'
    )
    truth = (
        f'<span style="position:absolute;top:3px;height:7px;width:7px;margin-left:-5px;'
        f'border:2px solid;border-radius:50%;left:{place(lean.true):.2f}%;{QUIET.css}"></span>'
    )
    axis = (
        '<span style="position:absolute;top:8px;left:4%;right:4%;height:1px;'
        'background:rgba(128,140,150,.6)"></span>'
    )
    hint = "bar: believed; ring: true; band: the distance that is proved"
    return (
        f'<div style="position:relative;height:17px;margin:3px 10px 0;overflow:hidden" '
        f'title="{hint}">{axis}{band}{belief}{truth}</div>'
    )
