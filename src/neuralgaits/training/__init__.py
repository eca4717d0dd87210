"""Training a gait until the conditions of its spec hold."""

from neuralgaits.training.loss import Loss, barrier_loss, lay_out, margin_matrix
from neuralgaits.training.posture_start import start_from_posture
from neuralgaits.training.repair import Boxes, Extra
from neuralgaits.training.sampling import Sampler
from neuralgaits.training.train_state import TrainState
from neuralgaits.training.trainer import VALIDATE_EVERY, Trainer

__all__ = [
    "VALIDATE_EVERY",
    "Boxes",
    "Extra",
    "Loss",
    "Sampler",
    "TrainState",
    "Trainer",
    "barrier_loss",
    "lay_out",
    "margin_matrix",
    "start_from_posture",
]
