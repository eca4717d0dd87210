"""Map of a certificate: boxes in the plane of the zero dynamics, and what is known of each."""

from enum import IntEnum
from pathlib import Path
from typing import NamedTuple

import numpy as np

from neuralgaits._types import Bool, Float, Int
from neuralgaits.errors import RunError
from neuralgaits.runs.arrays import packed, read_arrays


class BoxAnswer(IntEnum):
    """Answer about a box: all conditions proved, some open, some violated everywhere on it."""

    PROVED = 0
    UNDECIDED = 1
    REFUTED = 2


class BoxMap(NamedTuple):
    """Boxes of all conditions, with N boxes and M counterexamples."""

    corners: Float[np.ndarray, "N 4 2"]
    """Corners of each box in (z1, z2), in order around it [m], [kg m^2/s]."""
    answer: Int[np.ndarray, " N"]
    """A `BoxAnswer` for each box."""
    margin: Float[np.ndarray, " N"]
    """Smallest margin in each box, in scales."""
    counterexamples: Float[np.ndarray, "M 2"] = np.zeros((0, 2))
    """States that break a condition."""
    title: str = ""
    """One line about the boxes."""

    @property
    def curved(self) -> Bool[np.ndarray, " N"]:
        """Return which boxes have no area: those on fences and guard are curves."""
        first = self.corners[:, :1]
        across, up = (np.abs(self.corners[:, [n]] - first).max(axis=(1, 2)) for n in (1, 3))
        return (across == 0.0) | (up == 0.0)

    @property
    def drawn_last(self) -> Int[np.ndarray, " N"]:
        """Return the boxes in the order to draw them: regions overlap, and the worst is on top."""
        return np.lexsort((-self.margin, self.answer))

    def content(self) -> bytes:
        """Return the content of the map's file."""
        arrays = {name: getattr(self, name) for name in self._fields if name != "title"}
        return packed(arrays, {"title": self.title})

    @classmethod
    def read(cls, path: Path) -> "BoxMap":
        """Read a map's file. Raises: RunError if it is missing or damaged."""
        arrays, metadata = read_arrays(path)
        count, points = (np.size(arrays.get(name, ())) for name in ("answer", "counterexamples"))
        shapes = {"corners": (count, 4, 2), "answer": (count,), "margin": (count,)}
        shapes["counterexamples"] = (points // 2, 2)
        if any(name not in arrays or arrays[name].shape != shape for name, shape in shapes.items()):
            raise RunError(
                f"expected corners, answers and margins of boxes in {path}, found other arrays: "
                "certify the run again"
            )
        corners, answer, margin, states = (arrays[name].astype(float) for name in shapes)
        return cls(corners, answer.astype(int), margin, states, metadata.get("title", ""))
