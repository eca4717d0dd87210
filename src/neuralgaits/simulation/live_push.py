"""Push on the robot of a live walk: an impulse, spread over some ticks."""

import numpy as np

from neuralgaits._types import Float
from neuralgaits.errors import InputError
from neuralgaits.simulation.setup.plant import PERIOD_S
from neuralgaits.simulation.setup.push import DURATION_S

"""Time of one tick [s]."""


class LivePush:
    """The present push, if there is one.

    Attributes:
        impulse_given: impulse of all pushes so far, along x and z (N s). [2]
    """

    def __init__(self):
        self.impulse_given = np.zeros(2)
        self._force = np.zeros(2)
        self._ticks_left = 0

    @property
    def force(self) -> Float[np.ndarray, "2"]:
        """Return the present force, along x and z (N); zero without a push. [2]."""
        return self._force if self._ticks_left else np.zeros(2)

    def begin(self, impulse: Float[np.ndarray, "2"]) -> None:
        """Begin a push along x and z, spread over `push.DURATION_S` (N s). [2].

        The rest of an earlier push is dropped. Raises: InputError if it is not finite.
        """
        impulse = np.asarray(impulse, dtype=np.float64)
        if impulse.shape != (2,) or not np.all(np.isfinite(impulse)):
            raise InputError(f"push: expected a finite impulse along x and z, found {impulse}")
        self._ticks_left = round(DURATION_S / PERIOD_S)
        self._force = impulse / (self._ticks_left * PERIOD_S)

    def advance(self) -> None:
        """Count one tick under the present force."""
        if self._ticks_left:
            self._ticks_left -= 1
            self.impulse_given += PERIOD_S * self._force

    def drop(self) -> None:
        """Drop the rest of the push."""
        self._ticks_left = 0
