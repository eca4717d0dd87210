"""Drawings of a biped's live page as SVG: the tube in three slices, and footprints from above."""

import math

import numpy as np

from neuralgaits.systems.walker3d.live_moment import SpatialMoment
from neuralgaits.systems.walker3d.spatial_gait import SpatialGait
from neuralgaits.viewer.page_style import BAD, GOOD, Ink

SLICES = (
    ("y, hip aside", "mm", 1e3),
    ("L_y, forward", "kg m²/s", 1.0),
    ("n, aside", "kg m²/s", 1.0),
)
"""Name, unit and factor of each slice."""
SEEN = 3.0
"""Extent of a slice either way, in the tube's largest half width; what is beyond is at its edge."""
WIDE, TALL = 330.0, 74.0
"""Size of a slice [px]."""
LEFT_PX = 6.0
"""Left margin of a slice [px]."""
RIGHT_INK, LEFT_INK = Ink("#1a63b8", "#6aa8ee"), Ink("#c46a1b", "#f0a35a")


class TubeSlices:
    """Slices of a gait's tube: deviations of (y, L_y, n) from its middle over a step."""

    def __init__(self, gait: SpatialGait):
        """Draw the tube's bands; states are drawn over them. The scale stays that of this tube."""
        self._phases = np.linspace(0.0, 1.0, 41)
        self._follow(gait)
        self._most = SEEN * self._half.max(axis=0)
        self._bands = [self._band(k) for k in range(3)]

    def _follow(self, gait: SpatialGait) -> None:
        """Measure the tube of this gait."""
        self._gait = gait
        _, axes = gait.tube.sections(self._phases)
        self._half = np.linalg.norm(axes, axis=2)

    def render(self, shown: SpatialMoment) -> str:
        """Return the slices with the trail and the present state as HTML."""
        if shown.gait is not self._gait:  # A step that was told another speed has another tube.
            self._follow(shown.gait)
            self._bands = [self._band(k) for k in range(3)]
        ink = GOOD if shown.distance <= 1.0 else BAD
        return (
            '<div style="padding:2px 10px 4px">'
            + "".join(self._slice(k, shown, ink) for k in range(3))
            + "</div>"
        )

    def _slice(self, k: int, shown: SpatialMoment, ink: Ink) -> str:
        name, unit, factor = SLICES[k]
        value = shown.off[k]
        half = float(np.interp(shown.phase, self._phases, self._half[:, k]))
        read = (
            ""
            if math.isnan(value)
            else (
                f"{factor * value:+.2f} {unit} = {value / half:+.1f} half widths".replace("-", "−")
            )
        )
        drawn = self._bands[k] + self._trail(k, shown)
        if not math.isnan(value):
            x, y = self._place(shown.phase, value, k)
            drawn += (
                f'<circle cx="{x:.1f}" cy="{y:.1f}" r="4.5" style="fill:currentColor;{ink.css}"/>'
            )
        return (
            '<div style="display:flex;justify-content:space-between;font-size:12px;gap:8px">'
            f'<span style="font-weight:600">{name}</span><span style="font-variant-numeric:'
            f'tabular-nums">{read}</span></div>'
            f'<svg viewBox="0 0 {WIDE:.0f} {TALL:.0f}" style="width:100%;display:block" role="img" '
            f'aria-label="{name} over a step">{drawn}</svg>'
        )

    def _band(self, k: int) -> str:
        upper = [self._place(t, h, k) for t, h in zip(self._phases, self._half[:, k], strict=True)]
        lower = [self._place(t, -h, k) for t, h in zip(self._phases, self._half[:, k], strict=True)]
        middle = self._place(0.0, 0.0, k)[1]
        return (
            f'<rect x="{LEFT_PX}" y="1" width="{WIDE - 2 * LEFT_PX}" height="{TALL - 2}" rx="3" '
            'style="fill:rgba(128,140,150,.10)"/>'
            f'<polygon points="{_points(upper + lower[::-1])}" style="fill:rgba(61,140,87,.30)"/>'
            f'<line x1="{LEFT_PX}" x2="{WIDE - LEFT_PX}" y1="{middle}" y2="{middle}" '
            'style="stroke:currentColor;opacity:.35;stroke-dasharray:4 4"/>'
        )

    def _trail(self, k: int, shown: SpatialMoment) -> str:
        lines, line = [], []
        for row in [*shown.trail, np.full(5, np.nan)]:
            if math.isnan(row[0]):
                lines += [line] if len(line) > 1 else []
                line = []
            else:
                line.append(self._place(row[0], row[1 + k], k))
        return "".join(
            f'<polyline points="{_points(one)}" style="fill:none;stroke:currentColor;opacity:.45"/>'
            for one in lines
        )

    def _place(self, phase: float, value: float, k: int) -> tuple[float, float]:
        """Return the place of a phase and a deviation [px]."""
        share = float(np.clip(value / self._most[k], -1.0, 1.0))
        x = LEFT_PX + phase * (WIDE - 2.0 * LEFT_PX)
        return x, 0.5 * TALL - share * (0.5 * TALL - 6.0)


def draw_prints(shown: SpatialMoment) -> str:
    """Return the last footprints and the hips' path from above as HTML; forward is to the right."""
    height_px = 100.0  # Height of the drawing of footprints [px].
    m_across = 2.6  # Length of the floor that is seen [m].
    scale = WIDE / m_across
    middle = np.array([shown.hips[0] - 0.38 * m_across, shown.hips[1]])
    if len(shown.prints) > 1:
        middle[1] = np.mean([one.y for one in shown.prints[-6:]])

    def place(x: float, y: float) -> tuple[float, float]:
        return 0.5 * WIDE + scale * (x - middle[0]), 0.5 * height_px - scale * (y - middle[1])

    path = [place(*row) for row in shown.path]
    drawn = f'<polyline points="{_points(path)}" style="fill:none;stroke:currentColor;opacity:.5"/>'
    for one in shown.prints:
        x, y = place(one.x, one.y)
        ink = LEFT_INK if one.left else RIGHT_INK
        drawn += f'<circle cx="{x:.1f}" cy="{y:.1f}" r="4.5" style="fill:currentColor;{ink.css}"/>'
    x, y = place(*shown.hips[:2])
    drawn += (
        f'<path d="M{x - 5:.1f},{y - 5:.1f} l10,5 l-10,5 z" style="fill:currentColor;opacity:.8"/>'
    )
    return (
        f'<div style="padding:2px 10px 4px"><svg viewBox="0 0 {WIDE:.0f} {height_px:.0f}" '
        'style="width:100%;display:block" role="img" aria-label="footprints from above">'
        f'<rect width="{WIDE}" height="{height_px}" rx="3" style="fill:rgba(128,140,150,.10)"/>'
        f"{drawn}</svg></div>"
    )


def _points(rows: list[tuple[float, float]]) -> str:
    return " ".join(f"{x:.1f},{y:.1f}" for x, y in rows)
