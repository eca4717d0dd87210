"""A drawn figure as PNG and SVG files."""

from io import BytesIO
from pathlib import Path

from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.backends.backend_svg import FigureCanvasSVG
from matplotlib.figure import Figure

from neuralgaits.report.drawing import style
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


def paths_of(folder: Path, name: str) -> tuple[Path, Path]:
    """Return the paths of a figure's PNG and SVG files."""
    return folder / f"{name}.png", folder / f"{name}.svg"


def write(figure: Figure, folder: Path, name: str) -> tuple[Path, Path]:
    """Write NAME.png and NAME.svg. Returns: both paths."""
    paths = paths_of(folder, name)
    # The layout is found once; both files share it.
    with style.settings():
        FigureCanvasAgg(figure)
        engine = figure.get_layout_engine()
        if engine is not None:
            engine.execute(figure)
            figure.set_layout_engine("none")
    for path, content in zip(paths, (png(figure), svg(figure)), strict=True):
        write_bytes(path, content)
    return paths
