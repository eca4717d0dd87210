"""The controls beside the scene. A visitor sets numbers within limits, or presses buttons."""

import time
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import Literal

import numpy as np
import viser

from neuralgaits.viewer import bars, page_style, scheme
from neuralgaits.viewer.player import SPEED, Picture, Player
from neuralgaits.viewer.readouts import SETTING_WORDS, ended, few_digits, line, notch, note
from neuralgaits.viewer.walker import SliderRange, SliderReach, Walker

PUSH = SliderReach(0.0, 40.0, 8.0)
"""Impulse of a push [N s]."""
WAYS = {
    "◄ back": (-1.0, 0.0),
    "forward ►": (1.0, 0.0),
    "up": (0.0, 1.0),
    "down": (0.0, -1.0),
}
"""Directions of a push along x and z."""
AFTER_FALL = {"wait for Reset": None, "reset after 2 s": 2.0, "reset after 5 s": 5.0}
Key = Literal["U", "J", "I", "K", "O", "L"]
KEYS: tuple[tuple[Key, Key], ...] = (("U", "J"), ("I", "K"), ("O", "L"))
"""Keys that move a slider up and down, for the sliders of commands and stones in their order."""
_A_KEY = 0.1
"""Distance that a key moves a slider, as a share of its range."""
_ANSWER_FRAMES = 240
"""Frames for which a message stays visible: six seconds."""
TYPED_S = 1.0
"""Time without a keystroke after which a number counts as typed [s]."""
_QUIET, _GOOD = scheme.colour("#5b6770", "#a3b0bb"), scheme.colour("#2e7d53", "#6fd09a")
_BAD, _SAID = scheme.colour("#c0392b", "#ff8f83"), scheme.colour("#7a3e9d", "#cf9df0")
_STATUS_EVERY = 10
"""Frames between two updates of the status line."""


class Panel:
    """Buttons, sliders and bars beside the scene."""

    def __init__(
        self,
        server: viser.ViserServer,
        player: Player,
        *,
        title: str,
        settings: Mapping[str, SliderReach],
        conditions: Sequence[str] | Mapping[str, str],
        restarted: Callable[[], None],
        commands: Mapping[str, SliderRange] | None = None,
        sizes: Mapping[str, SliderRange] | None = None,
    ):
        """Build the panel.

        Args:
            server: server of the page.
            player: player that the controls act on.
            title: one line of Markdown.
            settings: limits of the plant's adjustable settings, by name.
            conditions: names of the conditions, in the order of the margins, or what they state
                by name; empty if there are none.
            restarted: called in the player's thread after the robot was put back.
            commands: ranges of the commands that the gait takes at each touchdown, by name.
            sizes: ranges of the sizes of the blocks ahead, by name.
        """
        self._player, self._conditions, self._restarted = player, tuple(conditions), restarted
        self._words = conditions if isinstance(conditions, Mapping) else {}
        self._answer, self._answer_left, self._count = "", 0, 0
        self._laps = 0
        self._sliders: dict[str, tuple[viser.GuiSliderHandle, SliderReach]] = {}
        self._limited: list[tuple[viser.GuiSliderHandle, SliderReach]] = []
        gui = server.gui
        gui.add_html(scheme.FOLLOW + page_style.STYLE)
        gui.add_markdown(title)
        self._verdict = gui.add_html(note("reading the certificate"))
        self._status = gui.add_html(line("getting ready: compiling the controller", _QUIET))
        self._add_time(gui)
        self._keys = iter(KEYS)
        if commands:
            heard = "heard at the next touchdown; large changes take several steps"
            self._add_told(gui, "Commands", commands, heard, _tell)
        if sizes:
            ahead = "of the stones that the robot has not heard of yet"
            self._add_told(gui, "Stones ahead", sizes, ahead, _resize)
        self._add_push(gui)
        self._add_plant(gui, settings)
        with gui.add_folder("Margins at the robot's state"):
            self._bars = gui.add_html(note("no margins yet"))
        with gui.add_folder("How sure we are"):
            self._sure = gui.add_markdown("reading the certificate")
            self._theorem = gui.add_folder(
                "The theorem in its own words", expand_by_default=False, visible=False
            )
            with self._theorem:
                self._statements = gui.add_markdown("")

    def show(self, picture: Picture) -> None:
        """Update the status and the bars."""
        self._count += 1
        answer = self._of_lap(picture) or picture.answer
        if answer is not None:
            self.say(answer)
        if picture.margins is not None and self._conditions:
            self._bars.content = bars.render(self._conditions, picture.margins, self._words)
        if self._count % _STATUS_EVERY == 0 or answer is not None:
            self._status.content = self._lines(picture)
        self._answer_left = max(0, self._answer_left - 1)
        self._put_back()

    def say(self, answer: str) -> None:
        """Show a message for a while."""
        self._answer, self._answer_left = answer, _ANSWER_FRAMES

    def tell_how_sure(self, verdict: str, words: str, theorem: str = "") -> None:
        """Show the evidence for the gait.

        Args:
            verdict: one line, which stays in view.
            words: the evidence in Markdown.
            theorem: the theorem's own words in Markdown, which are folded.
        """
        self._verdict.content = note(verdict)
        self._sure.content = words
        self._statements.content = theorem
        self._theorem.visible = bool(theorem)

    def explain_margins(self, why: str) -> None:
        """Show why there are no bars; the certificate is not read either."""
        self._conditions = ()
        self._verdict.content = note("The certificate was not read.")
        self._sure.content = "The certificate was not read."
        self._bars.content = note(why)

    def _add_time(self, gui: viser.GuiApi) -> None:
        player = self._player
        pause = gui.add_button("Pause", icon=viser.Icon.PLAYER_PAUSE)
        row = gui.add_button_group("time", ("Step 20 ms", "Reset"))
        speed = self._slider(gui, "playback ×", SPEED, 0.1, "speed, × real time")

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
                self.reset()
            else:
                player.step()
                named()

        @speed.on_update
        def _(_event: object) -> None:
            value = SPEED.clip(speed.value)
            if value is not None:
                player.speed = value

        fall = gui.add_dropdown("after a fall", tuple(AFTER_FALL))

        @fall.on_update
        def _(_event: object) -> None:
            player.reset_after = AFTER_FALL.get(fall.value)

    def reset(self) -> None:
        """Put the robot back; the plant keeps its settings."""

        def back(walker: Walker) -> None:
            walker.reset()
            self._restarted()

        self._player.ask(back)

    def _add_push(self, gui: viser.GuiApi) -> None:
        with gui.add_folder("Push"):
            size = self._slider(gui, "impulse [N s]", PUSH, 1.0, "at the hip, for 0.1 s")
            ways = gui.add_button_group("push", tuple(WAYS))

        @ways.on_click
        def _(_event: object) -> None:
            impulse, way = PUSH.clip(size.value), WAYS.get(ways.value)
            if impulse is not None and way is not None:
                self._player.ask(lambda walker: walker.push(impulse * np.array(way)))

    def _add_told(
        self,
        gui: viser.GuiApi,
        title: str,
        told: Mapping[str, SliderRange],
        hint: str,
        tell: Callable[[Walker, str, float], None],
    ) -> None:
        """Add a slider for each entry, with two keys as long as keys are left."""
        with gui.add_folder(title):
            for name, (limits, unit) in told.items():
                stride = notch(limits)
                keys = next(self._keys, None)
                by_key = "" if keys is None else f"; keys {keys[0]} and {keys[1]}"
                slider = self._slider(gui, f"{name} [{unit}]", limits, stride, hint + by_key)

                def ask(_event: object, step=0.0, name=name, slider=slider, limits=limits):
                    value = _moved(slider, limits, step)
                    if value is not None:
                        self._player.ask(lambda walker: tell(walker, name, value))

                slider.on_update(ask)
                for key, way in zip(keys or (), (1.0, -1.0), strict=False):
                    word = f"{name} {'up' if way > 0.0 else 'down'}"
                    step = way * _A_KEY * (limits.high - limits.low)
                    gui.add_command(word, hotkey=key).on_trigger(partial(ask, step=step))

    def _add_plant(self, gui: viser.GuiApi, settings: Mapping[str, SliderReach]) -> None:
        with gui.add_folder("Robot and floor"):
            for name, limits in settings.items():
                label, step, hint = SETTING_WORDS[name]
                slider = self._slider(gui, label, limits, step, hint)
                self._sliders[name] = (slider, limits)
                slider.on_update(lambda _event, name=name: self._set(name))
            usual = gui.add_button("Restore robot and floor", icon=viser.Icon.RESTORE)

        @usual.on_click
        def _(_event: object) -> None:
            for name, (slider, limits) in self._sliders.items():
                slider.value = limits.first
                self._set(name)

    def _slider(
        self, gui: viser.GuiApi, label: str, limits: SliderReach, step: float, hint: str
    ) -> viser.GuiSliderHandle:
        low, high, first = map(few_digits, (limits.low, limits.high, limits.first))
        slider = gui.add_slider(label, low, high, step, first, hint=hint)
        self._limited.append((slider, limits))
        return slider

    def _put_back(self) -> None:
        """Correct a slider if a number beyond its limits was typed, or what is no number was sent.

        It waits until the number is complete: a part of it may be beyond the limits.
        """
        for slider, limits in self._limited:
            value = limits.clip(slider.value)
            value = limits.first if value is None else value
            if value == slider.value:
                continue
            if time.time() - slider.update_timestamp > TYPED_S:
                slider.value = value

    def _set(self, name: str) -> None:
        slider, limits = self._sliders[name]
        value = limits.clip(slider.value)
        if value is not None:
            self._player.ask(lambda walker: walker.disturb(name, value))

    def _lines(self, picture: Picture) -> str:
        shown = picture.shown
        facts = f"{shown.steps} steps · {shown.speed:.2f} m/s · {shown.time:.1f} s"
        if shown.fall is not None:
            lines = line(ended(shown, picture.reset_in), _BAD, strong=True)
        elif picture.paused:
            lines = line(f"Paused · {facts}", _QUIET)
        else:
            slow = f" · plays at ×{picture.pace:.2f}" if self._lags(picture) else ""
            lines = line(f"Walks · {facts}{slow}", _GOOD)
        said = line(self._answer, _SAID) if self._answer_left else ""
        return lines + said

    def _of_lap(self, picture: Picture) -> str | None:
        """Return a message when the robot has reached the end of the ground, once for each time."""
        laps = picture.shown.laps
        if len(laps) == self._laps:
            return None
        self._laps = len(laps)
        return f"End of the ground after {laps[-1]} steps: the robot is back at its beginning."

    def _lags(self, picture: Picture) -> bool:
        return picture.pace < 0.9 * self._player.speed


def _moved(slider: viser.GuiSliderHandle, limits: SliderReach, step: float) -> float | None:
    """Return a slider's number, after moving it by a step; None if it is no number."""
    value = limits.clip(slider.value)
    if value is not None and step:
        slider.value = value = min(max(value + step, limits.low), limits.high)
    return value


def _tell(walker: Walker, name: str, value: float) -> None:
    walker.tell(name, value)


def _resize(walker: Walker, name: str, value: float) -> None:
    walker.resize(name, value)
