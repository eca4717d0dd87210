"""A drawn figure as PNG and SVG files, and as one for a telephone."""

from io import BytesIO
from pathlib import Path
from typing import NamedTuple

from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.backends.backend_svg import FigureCanvasSVG
from matplotlib.figure import Figure

from neuralgaits.report.drawing import style
from neuralgaits.report.drawing.narrow import make_narrow
from neuralgaits.runs import write_bytes


def png(figure: Figure) -> bytes:
    """Return the figure as a PNG file."""
    buffer = BytesIO()
    with style.settings():
        FigureCanvasAgg(figure).print_png(buffer)
    return buffer.getvalue()


def svg(figure: Figure) -> bytes:
    """Return the figure as an SVG file that holds only the drawing: no time, no addresses."""
    buffer = BytesIO()
    with style.settings():
        FigureCanvasSVG(figure).print_svg(
            buffer, metadata=dict.fromkeys(("Date", "Creator", "Format", "Type"))
        )
    return buffer.getvalue()


def narrow_svg(figure: Figure) -> bytes:
    """Return the figure's narrow form as an SVG file; the figure keeps that form."""
    with style.settings():
        make_narrow(figure)
    return svg(figure)


class FigurePaths(NamedTuple):
    """Paths of a figure's files: PNG and SVG, and SVG of its narrow form."""

    png: Path
    svg: Path
    narrow: Path


def paths_of(folder: Path, name: str) -> FigurePaths:
    """Return the paths of a figure's files."""
    return FigurePaths(*(folder / f"{name}{end}" for end in (".png", ".svg", "-narrow.svg")))


def write(figure: Figure, folder: Path, name: str) -> FigurePaths:
    """Write NAME.png, NAME.svg and NAME-narrow.svg. Returns: their paths."""
    paths = paths_of(folder, name)
    # The layout is found once; both wide files share it.
    with style.settings():
        FigureCanvasAgg(figure)
        engine = figure.get_layout_engine()
        if engine is not None:
            engine.execute(figure)
            figure.set_layout_engine("none")
    # In this order: the last one changes the figure.
    for path, content_of in zip(paths, (png, svg, narrow_svg), strict=True):
        write_bytes(path, content_of(figure))
    return paths
