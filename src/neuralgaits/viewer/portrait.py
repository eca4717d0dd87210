"""Phase portrait of the zero dynamics: its data, and where a state is on its plane."""

from dataclasses import dataclass

import numpy as np

from neuralgaits._types import Float
from neuralgaits.analysis.box_map import BoxAnswer, BoxMap
from neuralgaits.gait.zero_coordinates import momentum_of, position_of


@dataclass(frozen=True)
class Portrait:
    """Data of the phase plane, complete before the robot moves.

    Attributes:
        z1, z2: grid of the flow [m], [kg m^2/s]. [A], [B]
        dz: rates on the grid (m/s, N m). [B, A, 2]
        fence_z1: z1 along both fences [m]. [P]
        fence_z2: lower and upper fence [kg m^2/s]. [2, P]
        orbit: orbit from landing to landing; no rows if there is none. [T, 2]
        boxes: what is known of the region, box by box.
        title: one line that says where the margins are from.
    """

    z1: Float[np.ndarray, " A"]
    z2: Float[np.ndarray, " B"]
    dz: Float[np.ndarray, "B A 2"]
    fence_z1: Float[np.ndarray, " P"]
    fence_z2: Float[np.ndarray, "2 P"]
    orbit: Float[np.ndarray, "T 2"]
    boxes: BoxMap
    title: str

    @property
    def low(self) -> Float[np.ndarray, "2"]:
        """Return the least z in view. [2]."""
        return np.array([self.z1[0], self.z2[0]])

    @property
    def high(self) -> Float[np.ndarray, "2"]:
        """Return the largest z in view. [2]."""
        return np.array([self.z1[-1], self.z2[-1]])

    @property
    def darkest_margin(self) -> float:
        """Return the margin from which on green is darkest [scale of its condition].

        A tenth of the boxes have more: a few that are far wider would leave all others pale.
        """
        margins = self.boxes.margin[(self.boxes.answer == BoxAnswer.PROVED) & ~self.boxes.curved]
        return max(float(np.quantile(margins, 0.9)), 1e-6) if len(margins) else 1e-6

    def place(self, z: Float[np.ndarray, "... 2"]) -> Float[np.ndarray, "... 2"]:
        """Return places of states on the plane, as shares of it from its lower left corner."""
        return (z - self.low) / (self.high - self.low)

    def clip(self, z: Float[np.ndarray, "... 2"]) -> Float[np.ndarray, "... 2"]:
        """Return the nearest states in view."""
        return np.clip(z, self.low, self.high)

    def in_view(self, z: Float[np.ndarray, "... 2"]) -> np.ndarray:
        """Return whether states are on the plane. [...]."""
        return np.all((z >= self.low) & (z <= self.high), axis=-1)

    def beyond(self, z: Float[np.ndarray, "2"]) -> str | None:
        """Return in words on which side a state is off the plane; None if it is in view."""
        sides = (
            (momentum_of(z) > momentum_of(self.high), "▲ above the chart"),
            (momentum_of(z) < momentum_of(self.low), "▼ below the chart"),
            (position_of(z) < position_of(self.low), "◄ left of the chart"),
            (position_of(z) > position_of(self.high), "► right of the chart"),
        )
        return next((words for is_there, words in sides if is_there), None)
