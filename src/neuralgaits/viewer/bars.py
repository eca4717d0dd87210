"""Margins of conditions as bars, in plain HTML without scripts."""

import html
from collections.abc import Mapping, Sequence

import numpy as np

from neuralgaits.viewer.page_style import BAD, GOOD, QUIET, TIGHT, line, note
from neuralgaits.viewer.walker import Margins


def render(
    names: Sequence[str],
    margins: Margins,
    words: Mapping[str, str] | None = None,
    *,
    changed: bool = False,
) -> str:
    """Return bars of all conditions; a sentence if no margin is a number.

    Args:
        names: names of the conditions, in the order of the margins.
        margins: their margins.
        words: what they state, by name; their names where there is nothing.
        changed: whether the robot or the floor are not those that the margins are about; then no
            bar has a colour.
    """
    if not np.isfinite(margins.values).any():
        why = margins.why_none or "they are not numbers here"
        return note(f"No margins at present: {why}.")
    rows = [
        _row(name, float(value), bool(inside), (words or {}).get(name, ""), changed)
        for name, value, inside in zip(names, margins.values, margins.inside, strict=True)
    ]
    axis = (
        f'<div style="margin-bottom:3px;line-height:1.35;{QUIET.css}">Bar: 0 to 1 scale of the '
        "condition; the number goes on beyond 1.</div>"
    )
    about = ""
    if changed:
        about = line(
            "About the robot and the floor of the file, not about what was changed.", TIGHT
        )
    key = (
        f'<div style="margin-top:5px;line-height:1.35;{QUIET.css}">Remaining margin at the '
        "robot's z; below 0 the condition is violated. Pale bar: z is outside of the region "
        "where the condition must hold, and the margin is read near it.</div>"
    )
    bars = f"{axis}{''.join(rows)}{key}"
    return f'{about}<div style="font-size:11.5px;padding:2px 10px 8px">{bars}</div>'


def _row(name: str, value: float, inside: bool, words: str, changed: bool) -> str:
    ink = QUIET
    width = 0.0
    text = "–"
    if np.isfinite(value):
        # Training aims at a margin of 0.05.
        ink = BAD if value < 0.0 else TIGHT if value < 0.05 else GOOD
        ink = QUIET if changed else ink
        # A bar is full at one scale; a broken condition shows how far, in red.
        width, text = 100.0 * min(abs(value), 1.0), f"{value:.2f}".replace("-", "\u2212")
    place = "z is in its region" if inside else "z is outside of its region: read near it"
    hint = html.escape("; ".join(filter(None, (name, words, place))))
    # A touch screen shows no hint: the name by which screens and pages call it is always there.
    called = (
        f' <code style="display:inline-block;font-size:11px;background:none;padding:0;{QUIET.css}">'
        f"{html.escape(name)}</code>"
        if words
        else ""
    )
    # What a barrier adds to its bound, behind a semicolon, is left to the hint.
    label = words.partition(";")[0] or name
    return (
        f'<div style="display:flex;align-items:center;gap:6px;min-height:17px;line-height:1.2;'
        f'{"" if inside else QUIET.css}" title="{hint}">'
        '<span style="flex:0 0 62%;overflow-wrap:anywhere;padding:2px 0">'
        f'<span>{html.escape(label)}</span>{called}</span><span style="flex:1;height:9px;'
        'background:rgba(128,140,150,.18);border-radius:3px;overflow:hidden">'
        f'<span style="display:block;height:9px;width:{width:.0f}%;background:{ink.light}'
        f'{"" if inside else ";opacity:.45"}"></span>'
        '</span><span style="flex:0 0 32px;text-align:right;font-variant-numeric:tabular-nums;'
        f'{ink.css}">{text}</span></div>'
    )
