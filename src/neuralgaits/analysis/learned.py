"""Corrections of a robot's model as one file: residuals of flow and reset, and an error bound.

Sizes of the networks are read off the arrays' names and shapes, so a file needs no other.
"""

from pathlib import Path

import equinox as eqx
import numpy as np

from neuralgaits._types import Array, Float
from neuralgaits.errors import RunError
from neuralgaits.gait import Residuals
from neuralgaits.gait.flow_residual import Residual
from neuralgaits.gait.reset_residual import ResetResidual
from neuralgaits.runs import read_arrays, read_tree, write_tree


class LearnedResiduals(eqx.Module):
    """Corrections of a robot's model, learned from logs.

    Attributes:
        flow: residual of dz.
        reset: residual of the reset map; None if too few touchdowns were seen.
        error_bound: remaining error bound on dz, from held-out strides (m/s, N m). [2]
    """

    flow: Residual
    reset: ResetResidual | None
    error_bound: Float[Array, "2"]

    @property
    def residuals(self) -> Residuals:
        """Both residuals, in the form that zero dynamics take."""
        return Residuals(self.flow, self.reset)

    def write(self, path: Path) -> None:
        """Save the corrections, whole or not at all."""
        write_tree(path, self)

    @classmethod
    def read(cls, path: Path, joints: int) -> "LearnedResiduals":
        """Read a file of `write` for a robot with so many actuated joints.

        Raises: RunError if it is missing, damaged, no residual, or of a robot with other joints.
        """
        try:
            arrays, _ = read_arrays(path)
        except RunError:
            kind = "another file" if path.is_file() else "a folder" if path.is_dir() else "none"
            raise RunError(
                f"expected a residual in {path}, found {kind}: give a file that `fit` wrote"
            ) from None
        sizes: list[int] = []
        layer = "flow.network.biases[{}]"
        while layer.format(len(sizes)) in arrays:
            sizes.append(arrays[layer.format(len(sizes))].size)
        if not sizes:
            raise RunError(
                f"expected a residual in {path}, found other arrays: give a file that `fit` wrote"
            )
        has_reset = any(name.startswith("reset.") for name in arrays)
        like = cls(
            Residual.like(tuple(sizes[:-1])),
            ResetResidual.like(joints) if has_reset else None,
            np.zeros(2),
        )
        return read_tree(path, like)
