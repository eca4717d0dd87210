"""Table of control laws by name."""

from neuralgaits.control.clf_qp import ClfQp
from neuralgaits.control.fblin import Fblin
from neuralgaits.control.law import AbstractLaw
from neuralgaits.control.pd import PAPER, Pd
from neuralgaits.errors import InputError

EXPORTED = {"pd": Pd(), "fblin": Fblin(), "paper": PAPER}
"""Laws of exported controllers: `paper` is the PD of the paper's deployment."""
LAWS = {**EXPORTED, "clf-qp": ClfQp()}
"""Laws that a walk can use."""


def law_named(controller: str | AbstractLaw) -> AbstractLaw:
    """A control law by name, or the law itself. Raises: InputError listing the names."""
    if isinstance(controller, AbstractLaw):
        return controller
    if controller not in LAWS:
        raise InputError(f"unknown controller {controller!r}: expected one of {', '.join(LAWS)}")
    return LAWS[controller]
