"""State of a training, and what its steps and evaluations return."""

from typing import Any, NamedTuple

import numpy as np

from neuralgaits._types import Array, Float


class TrainState(NamedTuple):
    """Everything a training needs to continue. Arrays only."""

    step: Array
    """Number of gradient steps done. int32 scalar."""
    parameters: Float[Array, " P"]
    """Current trainable parameters, flat. float32."""
    optimizer: Any
    """State of the optimiser, as a tree."""
    best: Float[Array, " P"]
    """Parameters with the lowest validation loss so far."""
    best_loss: Array
    """Lowest validation loss so far. float64 scalar."""
    rate: Array
    """Share of the recipe's step size; less than 1 after steps that turned to NaN. float32."""


class FreshMargins(NamedTuple):
    """Margins of conditions on fresh samples, inside the regions, in float64."""

    loss: float
    margins: dict[str, Float[np.ndarray, "N k"]]
    """Margins of each condition on the samples of its region, in its own units."""
