"""Controllers as pure step functions: simulated and exported from here."""

from neuralgaits.control.clf_qp import ClfQp
from neuralgaits.control.controller import (
    Controller,
    ControllerState,
    TickResult,
    start,
    step,
    tell,
)
from neuralgaits.control.fblin import Fblin
from neuralgaits.control.law import AbstractLaw
from neuralgaits.control.measurement import Measurement
from neuralgaits.control.pd import PAPER, Pd
from neuralgaits.control.scheduled_pd import ScheduledPd
from neuralgaits.control.touchdown import TouchdownThresholds

__all__ = [
    "PAPER",
    "AbstractLaw",
    "ClfQp",
    "Controller",
    "ControllerState",
    "Fblin",
    "Measurement",
    "Pd",
    "ScheduledPd",
    "TickResult",
    "TouchdownThresholds",
    "start",
    "step",
    "tell",
]
