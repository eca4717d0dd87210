"""Drawing of a phase portrait as SVG, which is sharp at every size and on every screen.

Its ground is transparent. Words and edges have the colour of the text around the drawing; all other
colours can be told from a light ground and from a dark one.
"""

import io

import numpy as np

from neuralgaits.analysis.box_map import BoxAnswer
from neuralgaits.viewer.page_style import Ink
from neuralgaits.viewer.portrait import Portrait

WIDTH_PX, HEIGHT_PX = 350.0, 262.0
"""Size of the drawing in the panel; it grows with the panel."""
LEFT_PX, RIGHT_PX, TOP_PX, BOTTOM_PX = 44.0, 8.0, 6.0, 40.0
"""Space around the plane, for ticks and labels."""
TEXT_PX = 11.0
"""Height of the smallest letters."""
INK = Ink("#3d4852", "#c8d1d9")
"""Colour of words and edges."""
ORBIT, FLOW, GUARD = "#d55e00", "#848c95", "#a066c4"
GREENS = ("#d3ecd6", "#7fc18c", "#1d6a3b")
"""Colours of margins, from none to the darkest."""
UNDECIDED, REFUTED = "#f0a040", "#d0664c"
_CLASS = "phase-portrait"


def svg(portrait: Portrait) -> str:
    """Return the drawing as an SVG element for a page."""
    # Half a second of imports that the first frame does not wait for.
    import matplotlib as mpl

    with mpl.rc_context():
        # A `matplotlibrc` of the user's or of the folder has no part in it.
        mpl.rcdefaults()
        mpl.rcParams.update({"svg.fonttype": "none", "svg.hashsalt": "neuralgaits"})
        written = io.BytesIO()
        # What is drawn as pixels has four for each of the drawing's own.
        figure(portrait).savefig(
            written, format="svg", transparent=True, dpi=288, metadata={"Date": None}
        )
    text = written.getvalue().decode()
    # The file's own head and size are left out: the drawing is a part of a page, as wide as that.
    content = text[text.index(">", text.index("<svg ")) + 1 :]
    # Its rule about the ends of lines is not for the rest of the page.
    content = content.replace("*{", f".{_CLASS} *{{").replace(INK.light, "currentColor")
    return (
        f'<svg class="{_CLASS}" viewBox="0 0 {WIDTH_PX:g} {HEIGHT_PX:g}" role="img" '
        f'aria-label="phase portrait" style="display:block;width:100%;{INK.css}">{content}'
    )


def figure(portrait: Portrait):
    """Return the drawing as a figure with 72 of its pixels an inch, in a light page's ink."""
    from matplotlib.figure import Figure

    drawing = Figure(figsize=(WIDTH_PX / 72.0, HEIGHT_PX / 72.0), dpi=72, facecolor="none")
    place = (
        LEFT_PX / WIDTH_PX,
        BOTTOM_PX / HEIGHT_PX,
        (WIDTH_PX - LEFT_PX - RIGHT_PX) / WIDTH_PX,
        (HEIGHT_PX - TOP_PX - BOTTOM_PX) / HEIGHT_PX,
    )
    axes = drawing.add_axes(place, facecolor="none")
    _draw_boxes(axes, portrait)
    _draw_flow(axes, portrait)
    for fence in portrait.fence_z2:
        axes.plot(portrait.fence_z1, fence, color=INK.light, linewidth=1.4)
    for end, style in ((0, ":"), (-1, "--")):
        ends = portrait.fence_z1[[end, end]], portrait.fence_z2[:, end]
        axes.plot(*ends, style, color=GUARD, linewidth=1.8)
    if len(portrait.orbit):
        _draw_orbit(axes, portrait)
    _label(axes, portrait)
    return drawing


def _draw_boxes(axes, portrait: Portrait) -> None:
    from matplotlib.collections import PolyCollection
    from matplotlib.colors import LinearSegmentedColormap, to_rgba

    boxes = portrait.boxes
    greens = LinearSegmentedColormap.from_list("margin", GREENS)
    colours = greens(np.clip(boxes.margin / portrait.darkest_margin, 0.0, 1.0))
    colours[boxes.answer == BoxAnswer.UNDECIDED] = to_rgba(UNDECIDED)
    colours[boxes.answer == BoxAnswer.REFUTED] = to_rgba(REFUTED)
    flat = boxes.drawn_last[~boxes.curved[boxes.drawn_last]]
    polygons = PolyCollection(list(boxes.corners[flat]), linewidths=0.3)
    # There may be thousands: a browser draws one picture faster.
    polygons.set(facecolors=colours[flat], edgecolors=colours[flat], rasterized=True)
    axes.add_collection(polygons)


def _draw_flow(axes, portrait: Portrait) -> None:
    speed = np.where(np.isfinite(portrait.dz), portrait.dz, 0.0)
    look = {"color": FLOW, "linewidth": 0.6, "arrowsize": 0.6}
    axes.streamplot(
        portrait.z1, portrait.z2, speed[..., 0], speed[..., 1], density=(0.8, 0.6), **look
    )


def _draw_orbit(axes, portrait: Portrait) -> None:
    # Wider than the walk that is drawn over it.
    axes.plot(*portrait.orbit.T, color=ORBIT, linewidth=3.6)
    first, last = portrait.orbit[0], portrait.orbit[-1]
    arrow = {"arrowstyle": "->", "color": ORBIT, "ls": ":", "lw": 1.2}
    axes.annotate("", first, last, arrowprops=arrow)


def _label(axes, portrait: Portrait) -> None:
    axes.set(xlim=(portrait.z1[0], portrait.z1[-1]), ylim=(portrait.z2[0], portrait.z2[-1]))
    words = {"fontsize": TEXT_PX, "color": INK.light}
    axes.set_xlabel("z1, hip ahead of the stance foot [m]", labelpad=2, **words)
    axes.set_ylabel("z2, angular momentum [kg m²/s]", labelpad=2, **words)
    axes.tick_params(labelsize=TEXT_PX, colors=INK.light, length=3.0, pad=2.0)
    axes.locator_params(nbins=6)
    for spine in axes.spines.values():
        spine.set(color=INK.light, linewidth=0.6)
    for end, word, side in ((0, "after impact", "left"), (-1, "guard", "right")):
        place = portrait.fence_z1[end], portrait.fence_z2[1, end]
        above = {"textcoords": "offset points", "ha": side}
        axes.annotate(word, place, (0, 4), **above, **words)
