"""Buttons for a live page's time: pause, single steps, speed, and what follows a fall."""

from collections.abc import Callable
from typing import Any

import viser

from neuralgaits.viewer.limited_sliders import LimitedSliders
from neuralgaits.viewer.player import SPEED, Player


def add_time_controls(
    gui: viser.GuiApi, player: Player[Any], sliders: LimitedSliders, reset: Callable[[], None]
) -> None:
    """Add the buttons; `reset` puts the robot back."""
    pause = gui.add_button("Pause", icon=viser.Icon.PLAYER_PAUSE)
    row = gui.add_button_group("time", ("Step 20 ms", "Reset"))
    speed = sliders.add(SPEED)

    def named() -> None:
        pause.label = "Go on" if player.paused else "Pause"
        pause.icon = viser.Icon.PLAYER_PLAY if player.paused else viser.Icon.PLAYER_PAUSE

    @pause.on_click
    def _(_event: object) -> None:
        player.paused = not player.paused
        named()

    @row.on_click
    def _(_event: object) -> None:
        if row.value == "Reset":
            reset()
        else:
            player.step()
            named()

    @speed.on_update
    def _(_event: object) -> None:
        value = SPEED.clip(speed.value)
        if value is not None:
            player.speed = value

    # Times from a fall to the reset [s], by the words for them.
    waits = {"wait for Reset": None, "reset after 2 s": 2.0, "reset after 5 s": 5.0}
    fall = gui.add_dropdown("after a fall", tuple(waits))

    @fall.on_update
    def _(_event: object) -> None:
        player.reset_after = waits.get(fall.value)
