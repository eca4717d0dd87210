"""One style for all figures: sizes, and colours that are never the only distinction.

Colours are those of Okabe and Ito (2008), which colour-blind readers can distinguish. In grey
some of them coincide, so each series also has a line style or a marker of its own.
"""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import wraps
from typing import Any, ParamSpec, TypeVar

import matplotlib as mpl
from matplotlib.axes import Axes
from matplotlib.figure import Figure

BLACK, GREY, LIGHT = "#1a1a1a", "#767676", "#c9c9c9"
BLUE, ORANGE, GREEN, RED = "#0072b2", "#e69f00", "#009e73", "#d55e00"
ALLOWED, FORBIDDEN = "#dcebf7", "#fbe6da"
"""Fills of what conditions allow and forbid."""
WIDTH_IN = 7.2
"""Width of a figure [in]. In a column of the page, of 640 pixels, 9 points are 11 pixels high."""
NARROW_IN = 3.9
"""Width of a figure's narrow form [in]. On a telephone, 390 pixels wide, 9 points are 11."""
SMALL_PT = 9.0
"""Height of the smallest letters [pt]."""
_SERIES: tuple[tuple[str, Any, str], ...] = (
    (BLUE, "-", "o"),
    (RED, "--", "s"),
    (GREEN, "-.", "^"),
    (ORANGE, ":", "D"),
    ("#cc79a7", (0, (5, 1, 1, 1, 1, 1)), "v"),
    (BLACK, (0, (10, 4)), "P"),
    ("#56b4e9", (0, (1, 4)), "X"),
)
"""Colour, line style and marker of the series of a panel, one after another."""

P = ParamSpec("P")
R = TypeVar("R")


@contextmanager
def settings() -> Iterator[None]:
    """Apply the common style within the context, and restore Matplotlib's settings afterwards.

    Figures look the same for everyone: a `matplotlibrc` of the user's or of the folder has no part.
    """
    style: dict[Any, Any] = {
        "font.size": 10.0,
        "axes.titlesize": 10.0,
        "axes.labelsize": 10.0,
        "legend.fontsize": SMALL_PT,
        "xtick.labelsize": SMALL_PT,
        "ytick.labelsize": SMALL_PT,
        "axes.spines.top": False,
        "axes.spines.right": False,
        "axes.edgecolor": GREY,
        "axes.linewidth": 0.8,
        "legend.frameon": True,
        "legend.framealpha": 0.9,
        "legend.edgecolor": LIGHT,
        "lines.linewidth": 1.6,
        "hatch.linewidth": 0.5,
        # The same data gives the same file, byte for byte.
        "svg.hashsalt": "neuralgaits",
    }
    with mpl.rc_context():
        mpl.rcdefaults()
        mpl.rcParams.update(style)
        yield


def styled(draw: Callable[P, R]) -> Callable[P, R]:
    """Wrap a function so that it draws in the common style."""

    @wraps(draw)
    def wrapped(*args: P.args, **kwargs: P.kwargs) -> R:
        with settings():
            return draw(*args, **kwargs)

    return wrapped


def new_figure(height: float) -> Figure:
    """Return an empty figure of a height [in], with a layout that keeps labels apart."""
    # PNG files are 878 pixels across.
    return Figure(figsize=(WIDTH_IN, height), dpi=122, layout="constrained")


def series(number: int) -> dict[str, Any]:
    """Return colour and line style of the number-th series; the pairs do not repeat."""
    count = len(_SERIES)
    colour, dash = _SERIES[number % count][0], _SERIES[(number + number // count) % count][1]
    return {"color": colour, "linestyle": dash}


def marker(number: int) -> str:
    """Return the marker of the number-th series."""
    return _SERIES[number % len(_SERIES)][2]


def panel(axes: Axes, letter: str, title: str) -> None:
    """Write a panel's letter and title above its left edge."""
    axes.set_title(f"{letter})  {title}", loc="left")


def say(axes: Axes, words: str, height: float = 0.5) -> None:
    """Write across the middle of a panel what is not in it, at a share of its height."""
    place = {"ha": "center", "va": "center", "transform": axes.transAxes}
    axes.text(0.5, height, words, color=GREY, fontsize=SMALL_PT, **place)
