"""The controls beside the scene. A visitor sets numbers within limits, or presses buttons."""

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import Literal

import numpy as np
import viser

from neuralgaits._printable import counted
from neuralgaits.control.command_belief import SETTLED
from neuralgaits.viewer import bars
from neuralgaits.viewer.believed_lean import lean_html
from neuralgaits.viewer.limited_sliders import LimitedSliders
from neuralgaits.viewer.live_monitor import membership_lines
from neuralgaits.viewer.page_style import (
    QUIET,
    SAID,
    TIGHT,
    line,
    note,
    reset_button,
    status_block,
)
from neuralgaits.viewer.phase_chart import PhaseChart
from neuralgaits.viewer.plant_sliders import HEARD, add_plant_sliders
from neuralgaits.viewer.player import Picture, Player
from neuralgaits.viewer.slider import Slider
from neuralgaits.viewer.time_controls import add_time_controls
from neuralgaits.viewer.walk_status import walk_line
from neuralgaits.viewer.walker import Walker, WalkFrame

PUSH = Slider("impulse [N\u00a0s]", 0.0, 40.0, 8.0, 1.0, "at the hip, for 0.1 s")
"""Impulse of a push [N s]."""
Key = Literal["U", "J", "I", "K", "O", "L"]
_STATUS_EVERY = 10
"""Frames between two updates of the status line."""


class Panel:
    """Buttons, sliders, chart and bars beside the scene.

    Attributes:
        chart: phase portrait with the robot's state on it.
    """

    def __init__(
        self,
        server: viser.ViserServer,
        player: Player[Walker],
        *,
        title: str,
        settings: Mapping[str, Slider],
        conditions: Sequence[str] | Mapping[str, str],
        restarted: Callable[[], None],
        commands: Mapping[str, Slider] | None = None,
        sizes: Mapping[str, Slider] | None = None,
        adaptable: Sequence[str] = (),
        adapts: bool = False,
    ):
        """Build the panel.

        Args:
            server: server of the page.
            player: player that the controls act on.
            title: one line of Markdown.
            settings: sliders of the plant's adjustable settings, by name.
            conditions: names of the conditions, in the order of the margins, or what they state
                by name; empty if there are none.
            restarted: called in the player's thread after the robot was put back.
            commands: sliders of the commands that the gait takes at each touchdown, by name.
            sizes: sliders of the sizes of the blocks ahead, by name.
            adaptable: names of the commands that can be adapted.
            adapts: whether they are from the start.
        """
        self._player = player
        self._conditions = tuple(conditions)
        self._restarted = restarted
        self._words = conditions if isinstance(conditions, Mapping) else {}
        self._answer = ""
        self._answer_left = 0
        self._count = 0
        self._laps = 0
        gui = server.gui
        self._sliders = LimitedSliders(gui)
        gui.add_markdown(title)
        self._verdict = gui.add_html(note("reading the certificate"))
        ready = line("getting ready: compiling the controller", QUIET)
        self._status = gui.add_html(status_block(ready))
        self.chart = PhaseChart(gui)
        add_time_controls(gui, player, self._sliders, self.reset)
        # Each pair moves a slider up and down.
        keys: tuple[tuple[Key, Key], ...] = (("U", "J"), ("I", "K"), ("O", "L"))
        self._keys = iter(keys)
        self._add_commands(gui, commands or {}, adaptable, adapts)
        self._add_sizes(gui, sizes or {})
        self._add_push(gui)

        def disturb(name: str, value: float) -> None:
            player.ask(lambda walker: walker.disturb(name, value))

        add_plant_sliders(gui, self._sliders, settings, disturb)
        with gui.add_folder("Margins at the robot's state"):
            self._bars = gui.add_html(note("no margins yet"))
        self._add_certificate(gui)

    def show(self, picture: Picture) -> None:
        """Update the status and the bars."""
        self._count += 1
        answer = self._of_lap(picture) or picture.answer
        if answer is not None:
            self.say(answer)
        if picture.margins is not None and self._conditions:
            self._bars.content = bars.render(
                self._conditions, picture.margins, self._words, changed=picture.shown.changed
            )
        if self._count % _STATUS_EVERY == 0 or answer is not None:
            self._status.content = status_block(self.status(picture))
        self._answer_left = max(0, self._answer_left - 1)
        self._sliders.put_back()

    def say(self, answer: str) -> None:
        """Show a message for a while."""
        # Six seconds of frames.
        self._answer, self._answer_left = answer, 240

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

    def reset(self) -> None:
        """Put the robot back; the plant keeps its settings."""

        def back(walker: Walker) -> None:
            walker.reset()
            self._restarted()

        self._player.ask(back)

    def _add_certificate(self, gui: viser.GuiApi) -> None:
        with gui.add_folder("How sure we are"):
            self._sure = gui.add_markdown("reading the certificate")
            self._theorem = gui.add_folder(
                "The theorem in its own words", expand_by_default=False, visible=False
            )
            with self._theorem:
                self._statements = gui.add_markdown("")

    def _add_push(self, gui: viser.GuiApi) -> None:
        along = {"◄ back": (-1, 0), "forward ►": (1, 0), "up": (0, 1), "down": (0, -1)}
        with gui.add_folder("Push"):
            size = self._sliders.add(PUSH)
            ways = gui.add_button_group("push", tuple(along))

        @ways.on_click
        def _(_event: object) -> None:
            impulse, way = PUSH.clip(size.value), along.get(ways.value)
            if impulse is not None and way is not None:
                self._player.ask(lambda walker: walker.push(impulse * np.array(way)))
                if self._player.paused:
                    self.say("The push comes with Go on.")

    def _add_commands(
        self,
        gui: viser.GuiApi,
        commands: Mapping[str, Slider],
        adaptable: Sequence[str],
        adapts: bool,
    ) -> None:
        """Add sliders of the commands, and the switch that adapts them, if there are any."""
        handles: dict[str, viser.GuiSliderHandle] = {}
        if commands:
            handles = self._add_told(gui, "Commands", commands, HEARD, lambda walker: walker.tell)
        if adaptable:
            learned = [handles[name] for name in adaptable if name in SETTLED and name in handles]
            self._add_adaptation(gui, adaptable, learned, adapts)

    def _add_sizes(self, gui: viser.GuiApi, sizes: Mapping[str, Slider]) -> None:
        """Add sliders of the blocks ahead, if there are any."""
        if sizes:
            ahead = "of the stones that the robot has not heard of yet"
            self._add_told(gui, "Stones ahead", sizes, ahead, lambda walker: walker.resize)

    def _add_told(
        self,
        gui: viser.GuiApi,
        title: str,
        sliders: Mapping[str, Slider],
        hint: str,
        verb: Callable[[Walker], Callable[[str, float], None]],
    ) -> dict[str, viser.GuiSliderHandle]:
        """Add a slider for each entry, with two keys as long as keys are left, and return them."""
        handles = {}
        with gui.add_folder(title):
            for name, slider in sliders.items():
                keys = next(self._keys, None)
                by_key = "" if keys is None else f"; keys {keys[0]} and {keys[1]}"
                handle = self._sliders.add(slider._replace(hint=hint + by_key))
                handles[name] = handle

                def ask(_event: object, step=0.0, name=name, handle=handle, slider=slider):
                    value = slider.clip(handle.value)
                    if value is None:
                        return
                    if step:
                        handle.value = value = min(max(value + step, slider.low), slider.high)
                    self._player.ask(lambda walker: verb(walker)(name, value * slider.unit))

                handle.on_update(ask)
                for key, way in zip(keys or (), (1.0, -1.0), strict=False):
                    word = f"{name} {'up' if way > 0.0 else 'down'}"
                    step = 0.1 * way * (slider.high - slider.low)
                    gui.add_command(word, hotkey=key).on_trigger(partial(ask, step=step))
        return handles

    def _add_adaptation(
        self,
        gui: viser.GuiApi,
        names: Sequence[str],
        learned: Sequence[viser.GuiSliderHandle],
        active: bool,
    ) -> None:
        """Add the switch; sliders of what is learned rest while it is."""
        hint = "at each touchdown, until the robot walks as told"
        label = f"adapt {', '.join(names)}"
        switch = gui.add_checkbox(label, active, hint=hint)

        def rest() -> None:
            for handle in learned:
                handle.disabled = switch.value is True

        @switch.on_update
        def _(_event: object) -> None:
            active = switch.value is True
            rest()
            self._player.ask(lambda walker: walker.adapt(active))

        rest()

    def status(self, picture: Picture) -> str:
        """Return the lines about the walk, as HTML."""
        shown: WalkFrame = picture.shown
        lines = walk_line(picture, shown, self._player.speed)
        if shown.fall is not None:
            lines += reset_button()
        # What answers the visitor comes first: the block may be too low for all lines.
        if self._answer_left:
            lines += line(self._answer, SAID)
        if shown.off_proof:
            lines += line(shown.off_proof, TIGHT)
        lines += _speeds(shown) + lean_html(shown.lean)
        return lines + membership_lines(shown.memberships, off_proof=bool(shown.off_proof))

    def _of_lap(self, picture: Picture) -> str | None:
        """Return a message when the robot has reached the end of the ground, once for each time."""
        laps = picture.shown.laps
        if len(laps) == self._laps:
            return None
        self._laps = len(laps)
        steps = counted(laps[-1], "step")
        return f"End of the ground after {steps}: the robot is back at its beginning."


def _speeds(shown: WalkFrame) -> str:
    """Return a line of HTML with the speeds of the last step, if it had a commanded one."""
    if shown.speeds is None:
        return ""
    told, commanded, walked = shown.speeds
    text = f"Last step: told {told:.3f}, commanded {commanded:.3f}, walked {walked:.3f} m/s"
    return line(text, QUIET)
