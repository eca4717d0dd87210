"""Control laws by name: what each is called, where it is, and where it is written in C, too.

Nothing here needs JAX, so that the command line can offer the names at once. A new law that walks
in JAX is a file in `control/` and an entry of `CONTROL_LAWS`.
"""

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal


@dataclass(frozen=True)
class ControlLaw:
    """Entry of a control law.

    Attributes:
        words: its name in a sentence, as in "walked under ...".
        place: MODULE:OBJECT, a law or a class that makes one without arguments.
        compiled: whether compiled walks have it, see `simulation.native.native_scene`.
        exported: whether exported controllers have it, see `export.source` and
            `export.controller_prose`.
    """

    words: str
    place: str
    compiled: bool = False
    exported: bool = False


CONTROL_LAWS = {
    "pd": ControlLaw("joint PD control", "neuralgaits.control.pd:Pd", compiled=True, exported=True),
    "fblin": ControlLaw(
        "input-output linearisation",
        "neuralgaits.control.fblin:Fblin",
        compiled=True,
        exported=True,
    ),
    "paper": ControlLaw(
        "the PD control of the paper's deployment",
        "neuralgaits.control.pd:PAPER",
        compiled=True,
        exported=True,
    ),
    "clf-qp": ControlLaw(
        "a quadratic program with a control Lyapunov function",
        "neuralgaits.control.clf_qp:ClfQp",
        compiled=True,
    ),
    "scheduled-pd": ControlLaw(
        "gain-scheduled PD control",
        "neuralgaits.control.scheduled_pd:ScheduledPd",
        compiled=True,
        exported=True,
    ),
}

if TYPE_CHECKING:
    LawName = str
else:
    LawName = Literal[tuple(CONTROL_LAWS)]
"""Name of a control law."""


def names_of_laws(*, compiled: bool = False) -> str:
    """Return all names, or those of compiled walks, for a sentence: "pd, fblin or paper"."""
    *names, last = (name for name, law in CONTROL_LAWS.items() if law.compiled or not compiled)
    return f"{', '.join(names)} or {last}"
