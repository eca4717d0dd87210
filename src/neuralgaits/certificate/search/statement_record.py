"""A statement that a search has proved, with the boxes that show it."""

from collections.abc import Mapping
from dataclasses import dataclass

from neuralgaits.certificate.search.halving import LEAF


@dataclass(frozen=True)
class StatementRecord:
    """A statement: every element of every condition is at least bound x scale on the root box.

    Attributes:
        conditions: outputs of the Program.
        region: the box's name in the spec.
        scales, bounds: by condition; the bound of a spec's condition is not negative.
        degree: degree of the Taylor models of the search.
        low, high: corners of the root in the chart. [n]
        tree: see `search.halving`.
    """

    conditions: tuple[str, ...]
    region: str
    scales: Mapping[str, float]
    bounds: Mapping[str, float]
    degree: int
    low: tuple[float, ...]
    high: tuple[float, ...]
    tree: str

    @property
    def boxes(self) -> int:
        """Number of leaves of the tree."""
        return self.tree.count(LEAF)
