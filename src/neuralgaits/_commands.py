"""Commands that have a meaning: their units and their largest values.

Nothing here needs JAX, so that the command line can offer them at once. A new command is an entry
of `KNOWN_COMMANDS`.
"""

import math
from dataclasses import dataclass

FASTEST = 100.0
"""Largest speed [m/s]: no robot on legs walks faster, so more is a slip of the keyboard."""
ADAPTABLE = "speed", "lean", "slope"
"""Commands that can be adapted, in the order in which they are written."""


@dataclass(frozen=True)
class KnownCommand:
    """A command that has a meaning.

    Attributes:
        unit: unit of its values.
        most: largest value, either way, in that unit.
    """

    unit: str
    most: float

    @property
    def typed_unit(self) -> str:
        """Unit on the command line, where angles are in degrees."""
        return "degrees" if self.unit == "rad" else self.unit


KNOWN_COMMANDS = {
    "speed": KnownCommand("m/s", FASTEST),
    "step_length": KnownCommand("m", 100.0),
    "step_height": KnownCommand("m", 100.0),
    "slope": KnownCommand("rad", 0.5 * math.pi),
    "lean": KnownCommand("m", 0.5),
}
