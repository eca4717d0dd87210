"""Sliders of the live page whose numbers stay within their limits, whatever a visitor types."""

import time

import viser

from neuralgaits.viewer.slider import Slider

TYPED_S = 1.0
"""Time without a keystroke after which a number counts as typed [s]."""


class LimitedSliders:
    """Sliders of one page that clamp what is typed beside them."""

    def __init__(self, gui: viser.GuiApi):
        """Prepare to add sliders to this page."""
        self._gui = gui
        self._added: list[tuple[viser.GuiSliderHandle, Slider]] = []

    def add(self, slider: Slider) -> viser.GuiSliderHandle:
        """Add a slider to the folder that is open."""
        low, high, first = slider.shown
        handle = self._gui.add_slider(
            slider.label, low, high, slider.notch, first, hint=slider.hint
        )
        self._added.append((handle, slider))
        return handle

    def put_back(self) -> None:
        """Correct a slider if a number beyond its limits was typed, or what is no number was sent.

        It waits until the number is complete: a part of it may be beyond the limits.
        """
        for handle, slider in self._added:
            value = slider.clip(handle.value)
            value = slider.first if value is None else value
            if value != handle.value and time.time() - handle.update_timestamp > TYPED_S:
                handle.value = value
