"""What becomes of a figure: two files and words, or the reason why it is missing."""

from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True)
class Drawn:
    """A figure on disk.

    Attributes:
        name: of the figure, the same for every run; also of its files.
        title: a few words.
        caption: what is to be seen and why it matters, in plain words.
        path_png, path_svg: the files.
    """

    name: str
    title: str
    caption: str
    path_png: Path
    path_svg: Path

    def _repr_png_(self) -> bytes:
        """Itself, for a notebook. Raises: OSError if its file is gone."""
        return self.path_png.read_bytes()


@dataclass(frozen=True)
class Missing:
    """A figure that cannot be drawn yet.

    Attributes:
        name, title: as of the figure.
        reason: what is not there.
        command: what to type to get it.
    """

    name: str
    title: str
    reason: str
    command: str
