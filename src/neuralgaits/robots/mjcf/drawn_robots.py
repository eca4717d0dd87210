"""Draw robots from a box around the one of a file, one for each walk."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from neuralgaits._types import Float
from neuralgaits.robots.biped import PlanarBiped
from neuralgaits.robots.mjcf.parameters import RobotFamily, axes_of, in_its_file
from neuralgaits.robots.parameter_box import checked_box

_STREAM = 0x0B0C5
"""First number of this file's seeds, by which they differ from those of other streams,
see `simulation.setup.streams`."""


@dataclass(frozen=True, eq=False)
class DrawnRobots:
    """Robots of a box, drawn uniformly; a walk's robot depends on its number alone.

    Attributes:
        robot: robot in the middle of the box.
        box: half widths by kind, see `robots.parameter_box`.
        seed: seed of the draws.
    """

    robot: PlanarBiped
    box: Mapping[str, float]
    seed: int

    @property
    def names(self) -> tuple[str, ...]:
        """Return the names of the errors."""
        return tuple(axis.name for axis in axes_of(self.robot, self.box))

    def errors(self, first: int, count: int) -> Float[np.ndarray, "B k"]:
        """Return errors of the robots of walks number `first` to `first + count - 1`."""
        halves = np.array([axis.half for axis in axes_of(self.robot, self.box)])
        rows = [
            np.random.default_rng((_STREAM, self.seed, number)).uniform(-1.0, 1.0, len(halves))
            for number in range(first, first + count)
        ]
        return halves * np.array(rows).reshape(count, len(halves))

    def errors_by_name(self, count: int) -> dict[str, tuple[float, ...]]:
        """Return the errors of the robots of the first walks, by name."""
        columns = self.errors(0, count).T.tolist()
        return {name: tuple(column) for name, column in zip(self.names, columns, strict=True)}

    def of(self, first: int, count: int) -> list[PlanarBiped]:
        """Return those robots. Raises: InputError if some point of the box is no robot."""
        if not self.names:
            return [self.robot] * count
        family = RobotFamily.of(self.robot, tuple(checked_box(self.box)))
        return [in_its_file(family, errors) for errors in self.errors(first, count)]
