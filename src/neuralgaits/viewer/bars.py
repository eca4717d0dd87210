"""Margins of conditions as bars, in plain HTML without scripts."""

import html
from collections.abc import Mapping, Sequence

import numpy as np

from neuralgaits.viewer import scheme
from neuralgaits.viewer.walker import Margins

FULL = 1.0
"""Margin of a full bar, in scales of its condition."""
TIGHT = 0.05
"""Margin below which a bar warns; training aims at this margin."""
_GOOD, _TIGHT, _BROKEN, _FADED = "#2e7d53", "#b06a00", "#c0392b", "#6b7780"
_BRIGHT = {_GOOD: "#6fd09a", _TIGHT: "#f0b35b", _BROKEN: "#ff8f83", _FADED: "#a3b0bb"}
"""Colours of the bars on a dark background."""
_ROW = (
    '<div style="display:flex;align-items:center;gap:6px;height:17px;opacity:{opacity}" '
    'title="{hint}">'
    '<span style="flex:0 0 43%;overflow:hidden;text-overflow:ellipsis;white-space:nowrap">{name}'
    '</span><span style="flex:1;height:9px;background:rgba(128,140,150,.18);border-radius:3px;'
    'overflow:hidden"><span style="display:block;height:9px;width:{width:.0f}%;'
    'background:{colour}"></span></span>'
    '<span style="flex:0 0 44px;text-align:right;font-variant-numeric:tabular-nums;'
    '{ink}">{value}</span></div>'
)
_KEY = (
    '<div style="opacity:.7;margin-top:5px;line-height:1.35">Remaining margin at the robot\'s z, '
    "in scales of the condition; below 0 it is violated. Pale: z is outside of the region where "
    "the condition must hold, and the margin is read near it.</div>"
)


_NONE = (
    '<div style="font-size:12px;padding:2px 10px 6px">No margins at present: they are still being '
    "computed, the robot gets another command than the gait on the board, or its state is far "
    "outside of the region.</div>"
)


def render(names: Sequence[str], margins: Margins, words: Mapping[str, str] | None = None) -> str:
    """Return bars of all conditions; a sentence if no margin is a number.

    Args:
        names: names of the conditions, in the order of the margins.
        margins: their margins.
        words: what they state, by name, for whoever points at a bar.
    """
    if not np.isfinite(margins.values).any():
        return _NONE
    rows = [
        _row(name, float(value), bool(inside), (words or {}).get(name, ""))
        for name, value, inside in zip(names, margins.values, margins.inside, strict=True)
    ]
    return f'<div style="font-size:11.5px;padding:2px 10px 8px">{"".join(rows)}{_KEY}</div>'


def _row(name: str, value: float, inside: bool, words: str) -> str:
    colour, width, text = _FADED, 0.0, "–"
    if np.isfinite(value):
        colour = _BROKEN if value < 0.0 else _TIGHT if value < TIGHT else _GOOD
        # A broken condition shows how far, in red.
        width, text = 100.0 * min(abs(value) / FULL, 1.0), f"{value:.2f}"
    hint = "z is in its region" if inside else "z is outside of its region: read near it"
    return _ROW.format(
        name=html.escape(name),
        hint=html.escape(f"{words}; {hint}" if words else hint),
        colour=colour,
        ink=scheme.colour(colour, _BRIGHT[colour]),
        width=width,
        value=text,
        opacity="1" if inside else ".45",
    )
