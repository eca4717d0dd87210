"""Which conditions a state of a training breaks, for a training that ends in NaN."""

from collections.abc import Mapping

import numpy as np

from neuralgaits._checks import SEEDS
from neuralgaits.training.train_state import TrainState
from neuralgaits.training.trainer import Trainer

TORQUE_CONDITIONS = (
    "torque-lower",
    "torque-upper",
    "ankle-torque-lower",
    "ankle-torque-upper",
)
"""Names of the built-in conditions that fail where motors are too weak."""
_NAMED = 3
"""Conditions that a message names."""


def failing_conditions(trainer: Trainer, state: TrainState) -> dict[str, float]:
    """Return by how many of its scales each broken condition is missed, worst first.

    Margins are those on fresh samples; conditions with a margin that is not finite are left out.

    Args:
        trainer: trainer of the run.
        state: state whose present weights are measured.
    """
    report = trainer.report(trainer.gait(state.parameters), seed=SEEDS)
    scales = {condition.name: condition.scale for condition in trainer.spec.conditions}
    least = {name: float(np.min(report.margins[name])) / scale for name, scale in scales.items()}
    broken = {name: -one for name, one in least.items() if np.isfinite(one) and one < 0.0}
    return dict(sorted(broken.items(), key=lambda item: -item[1]))


def missed_in_words(missed: Mapping[str, float]) -> str:
    """Write failing conditions for a message: how many, and the worst ones with their numbers."""
    words = [f"{name} by {by:.3g}" for name, by in list(missed.items())[:_NAMED]]
    more = len(missed) - len(words)
    rest = f" and {more} more" if more > 0 else ""
    verb = "condition fails" if len(missed) == 1 else "conditions fail"
    return f"{len(missed)} {verb} on samples, in scales, worst first: {', '.join(words)}{rest}"
