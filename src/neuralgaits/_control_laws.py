"""Control laws by name: what each is called, where it is, and whether it is exported as C.

Nothing here needs JAX, so that the command line can offer the names at once. A new law is a file in
`control/` and an entry of `CONTROL_LAWS`.
"""

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal


@dataclass(frozen=True)
class ControlLaw:
    """Entry of a control law.

    Attributes:
        words: its name in a sentence, as in "walked under ...".
        place: MODULE:OBJECT, a law or a class that makes one without arguments.
        exported: whether the exported controller has it.
    """

    words: str
    place: str
    exported: bool = False


CONTROL_LAWS = {
    "pd": ControlLaw("joint PD control", "neuralgaits.control.pd:Pd", exported=True),
    "fblin": ControlLaw(
        "input-output linearisation", "neuralgaits.control.fblin:Fblin", exported=True
    ),
    "paper": ControlLaw(
        "the PD control of the paper's deployment",
        "neuralgaits.control.pd:PAPER",
        exported=True,
    ),
    "clf-qp": ControlLaw(
        "a quadratic program with a control Lyapunov function", "neuralgaits.control.clf_qp:ClfQp"
    ),
}

if TYPE_CHECKING:
    LawName = str
else:
    LawName = Literal[tuple(CONTROL_LAWS)]
"""Name of a control law."""


def names_of_laws() -> str:
    """Return all names for a sentence, as in "pd, fblin or paper"."""
    *names, last = CONTROL_LAWS
    return f"{', '.join(names)} or {last}"
