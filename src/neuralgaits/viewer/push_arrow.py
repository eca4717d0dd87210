"""The arrow of a push in the scene, which stays for a while after it."""

import numpy as np
import viser

from neuralgaits._types import Float

RED = (214, 39, 40)
"""Colour of a push and of the moving point [RGB]."""


class PushArrow:
    """An arrow, shown while there is a push and shortly after it."""

    def __init__(self, server: viser.ViserServer):
        """Prepare the arrow, out of sight."""
        self._arrow = server.scene.add_arrows(
            "/push",
            # Until there is a push, where nobody looks.
            np.full((1, 2, 3), -99.0, dtype=np.float32),
            RED,
            shaft_radius=0.016,
            head_radius=0.04,
            head_length=0.09,
            visible=False,
        )
        self._until = -1.0

    def show(
        self, place: Float[np.ndarray, "3"], force: Float[np.ndarray, "3"], time: float
    ) -> None:
        """Show a force [N] at a place [m], at a simulated time [s]; hide what is over."""
        if np.any(force):
            gap = 0.06  # Distance of the tip from the place that is pushed, along each axis [m].
            tip = place - np.sign(force) * gap
            m_per_n = 0.0022
            points = np.stack([tip - m_per_n * force, tip])
            self._arrow.points = points[None].astype(np.float32)
            self._arrow.visible = True
            self._until = time + 0.5  # The push lasts a fifth of that.
        elif self._arrow.visible and not time < self._until:
            self.hide()

    def hide(self) -> None:
        """Hide the arrow."""
        self._arrow.visible = False
