"""Text of numbers and endings beside the scene."""

import html
import math

from neuralgaits.viewer.walker import Shown, SliderReach

SETTING_WORDS = {
    "slope_deg": ("slope [deg]", 0.5, "uphill positive; the floor turns about the stance foot"),
    "friction": ("friction", 0.01, "sliding coefficient between feet and floor"),
    "mass_scale": ("mass ×", 0.01, "factor on all masses and inertias; the controller is not told"),
    "torque_limit": ("torque [N m]", 0.5, "limit of every joint; the controller knows it"),
}
"""Words, notch and explanation of the sliders of a plant's settings."""
_NOTCHES = 70
"""Steps of a command's slider: half a centimetre a second over the usual range of speeds."""
_DIGITS = 3
"""Digits of a number beside a slider: the page cuts longer ones off."""


def ended(shown: Shown, left: float | None) -> str:
    """Say why a walk ended, and what the visitor can do next.

    Args:
        shown: last moment of the walk.
        left: time until the robot is put back (s); None if the visitor does that.
    """
    what = "Stopped" if shown.upright else "Fell"
    text = f"{what}: {shown.fall}, after {shown.steps} steps. "
    text += "Press Reset" if left is None else f"Reset in {left:.0f} s"
    return text + ("; push it forward where it slows down." if shown.upright else ".")


def notch(limits: SliderReach) -> float:
    """Return the step of a slider: 1, 2 or 5 times a power of ten, about a share of its range.

    Other steps have more digits than the number beside the slider has room for.
    """
    share = (limits.high - limits.low) / _NOTCHES * (1.0 + 1e-9)
    place = 10.0 ** math.floor(math.log10(share))
    return float(f"{max(n * place for n in (1, 2, 5) if n * place <= share):.0e}")


def few_digits(value: float) -> float:
    """Round a number to the digits that a slider shows."""
    return float(f"{value:.{_DIGITS}g}")


def line(text: str, colour: str, *, strong: bool = False) -> str:
    """Return HTML of a line in a colour, which is CSS."""
    weight = 700 if strong else 500
    return (
        f'<div style="padding:3px 10px;font-size:13px;line-height:1.35;font-weight:{weight};'
        f'{colour}">{html.escape(text)}</div>'
    )


def note(text: str) -> str:
    """Return HTML of a small line."""
    return f'<div style="padding:2px 10px 6px;font-size:12px">{html.escape(text)}</div>'
