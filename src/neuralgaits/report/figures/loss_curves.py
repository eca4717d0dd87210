"""Loss of every condition during training."""

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.figure import Figure

from neuralgaits.report.drawing.style import BLACK, GREY, marker, new_figure, panel, series, styled

WHOLE = ("loss", "validation_loss")
"""Columns of `metrics.csv` about all conditions together."""
FLOOR = 1e-6
"""Value at which smaller losses are drawn: a logarithmic axis has no zero [1]."""


@styled
def draw(rows: Sequence[Mapping[str, float]]) -> Figure:
    """Draw the curves.

    Args:
        rows: rows of `metrics.csv`, at least one.
    """
    steps = np.array([row["step"] for row in rows])
    figure = new_figure(5.8)
    whole, parts = figure.subplots(1, 2)
    for name, label, colour, dash, mark in (
        ("loss", "training loss", BLACK, "-", "o"),
        ("validation_loss", "on fresh states, best so far", GREY, "--", "s"),
    ):
        whole.plot(steps, _column(rows, name), dash, color=colour, marker=mark, ms=4, label=label)
    panel(whole, "a", "all conditions and effort together")
    names = sorted(
        (name for name in rows[0] if name not in ("step", *WHOLE, "effort")),
        key=lambda name: -float(_column(rows, name).max()),
    )
    broken = [name for name in names if _column(rows, name).max() > FLOOR]
    # The most violated ones have a curve of their own.
    for number, name in enumerate(broken[:7]):
        line = {**series(number), "marker": marker(number), "ms": 4}
        parts.plot(steps, _column(rows, name), label=name, **line)
    others = len(names) - len(broken[:7])
    panel(parts, "b", "worst conditions alone")
    parts.axhline(FLOOR, color=GREY, linewidth=0.8)
    if others:
        parts.plot([], [], " ", label=f"{others} others: lower")
    for axes in (whole, parts):
        axes.set(yscale="log", xlabel="gradient steps", ylabel="loss")
        # One checkpoint is drawn as well as many.
        axes.set_xlim(0.0, 1.05 * max(float(steps.max()), 1.0))
        axes.grid(True, which="major", color="0.9")
    parts.set_ylabel(f"loss of the condition [1], lowest line: ≤\u00a0{FLOOR:g}")
    whole.legend(loc="upper center", bbox_to_anchor=(0.5, -0.14))
    parts.legend(loc="upper center", bbox_to_anchor=(0.5, -0.14), fontsize=9)
    return figure


def _column(rows: Sequence[Mapping[str, float]], name: str) -> np.ndarray:
    return np.maximum([row[name] for row in rows], FLOOR)
