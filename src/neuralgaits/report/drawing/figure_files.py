"""The outcome of a figure: files with a caption, or the reason why it is missing."""

from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True)
class FigureFiles:
    """A figure on disk.

    Attributes:
        name: name of the figure and of its files, the same for every run.
        title: a few words.
        caption: what the figure shows and why it matters, in plain words.
        path_png, path_svg: the files.
        path_narrow: SVG file of its narrow form, for a telephone, with panels below one another.
    """

    name: str
    title: str
    caption: str
    path_png: Path
    path_svg: Path
    path_narrow: Path

    def __repr__(self) -> str:
        """Return the title and one of the files, in a line."""
        return f"<Figure {self.title!r}: {self.path_png}>"

    def _repr_png_(self) -> bytes:
        """Return the PNG file, for a notebook. Raises: OSError if the file is missing."""
        return self.path_png.read_bytes()


@dataclass(frozen=True)
class MissingFigure:
    """A figure that cannot be drawn yet.

    Attributes:
        name, title: those of the figure.
        reason: what is missing.
        command: command that makes it.
    """

    name: str
    title: str
    reason: str
    command: str

    def __repr__(self) -> str:
        """Return the title, what is missing and what makes it, in a line."""
        return f"<No figure {self.title!r}: {self.reason}; `{self.command}`>"
