"""The controls beside a biped's scene, and what they say: what is proved, and what is simulated."""

import html
import math
from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
import viser

from neuralgaits.systems.walker3d.live_drawings import TubeSlices, draw_prints
from neuralgaits.systems.walker3d.live_moment import SpatialMoment
from neuralgaits.systems.walker3d.live_stage import VIEWS, SpatialStage
from neuralgaits.systems.walker3d.live_walk import SpatialLive
from neuralgaits.viewer.limited_sliders import LimitedSliders
from neuralgaits.viewer.page_style import GOOD, QUIET, TIGHT, line, note
from neuralgaits.viewer.plant_sliders import HEARD, add_plant_sliders
from neuralgaits.viewer.player import Picture, Player
from neuralgaits.viewer.slider import Slider
from neuralgaits.viewer.time_controls import add_time_controls
from neuralgaits.viewer.walk_status import walk_line

PUSH = Slider("impulse [N s]", 0.0, 20.0, 4.0, 0.5, "on the torso, for 0.1 s")
"""Impulse of a push [N s]."""
WAYS = {"◄ left": (0, 1), "right ►": (0, -1), "forward": (1, 0), "back": (-1, 0)}
"""Directions of a push, forward and to the left."""
WAITING = "Getting ready: the controller is being compiled"


class StatedProof(NamedTuple):
    """Statement of a run's proof file, in words.

    Attributes:
        line: one line of text.
        words: the whole in Markdown.
        of_tube: whether it states what follows for the tube's trajectories.
    """

    line: str
    words: str
    of_tube: bool


class SpatialPanel:
    """Buttons, words and drawings beside the scene."""

    def __init__(
        self,
        server: viser.ViserServer,
        player: Player[SpatialLive],
        stage: SpatialStage,
        robot: SpatialLive,
        title: str,
    ):
        """Build the panel of a robot; `title` is one line of Markdown."""
        self._player = player
        self._stage = stage
        self._count = 0
        self._tube_name = "tube"
        gui = server.gui
        self._sliders = LimitedSliders(gui)
        gui.add_markdown(title)
        self._verdict = gui.add_html(_kept_apart("reading the proof file"))
        self._status = gui.add_html(line(WAITING, QUIET))
        self._add_push(gui)
        self._add_commands(gui, robot.commands)

        def disturb(name: str, value: float) -> None:
            player.ask(lambda robot: robot.disturb(name, value))

        add_time_controls(gui, player, self._sliders, self.reset)
        views = gui.add_button_group("look from", tuple(VIEWS))
        add_plant_sliders(gui, self._sliders, robot.settings, disturb)
        with gui.add_folder("The tube, and where the robot is"):
            self._slices, drawn = TubeSlices(robot.run.controller.typical), gui.add_html("")
            self._tube = drawn
            slices = (
                "Green: the tube's extent, less its middle, from touchdown to touchdown. Inside "
                "the tube a state is within all three bands; the tube's sections are ellipsoids "
                "and hold less."
            )
            gui.add_html(note(slices))
        with gui.add_folder("Footprints"):
            self._prints = gui.add_html("")
            prints = (
                "Seen from above, forward to the right. Blue: right foot, orange: left; line: the "
                "hips."
            )
            gui.add_html(note(prints))
        with gui.add_folder("What is proved, and what is not"):
            self._proof = gui.add_markdown("Reading the proof file.")

        @views.on_click
        def _(event: viser.GuiEvent) -> None:
            if event.client is not None and views.value in VIEWS:
                stage.look(event.client, views.value)

    def reset(self) -> None:
        """Put the robot back into the tube's middle at the next tick."""

        def back(robot: SpatialLive) -> None:
            robot.reset()
            self._stage.restart()

        self._player.ask(back)

    def show(self, picture: Picture) -> None:
        """Update words and drawings."""
        self._count += 1
        self._sliders.put_back()
        if self._count % 8 != 1:  # Words and drawings change in every eighth frame.
            return
        shown: SpatialMoment = picture.shown
        self._status.content = self.status(picture)
        self._tube.content = self._slices.render(shown)
        self._prints.content = draw_prints(shown)

    def tell_proof(self, found: StatedProof) -> None:
        """Show what is proved: a line that stays in view, and the whole in Markdown."""
        self._tube_name = "proved tube" if found.of_tube else "tube"
        self._verdict.content = _kept_apart(found.line)
        self._proof.content = found.words

    def status(self, picture: Picture) -> str:
        """Return the lines about the walk and the tube as HTML."""
        shown: SpatialMoment = picture.shown
        if math.isnan(shown.share):
            return line(WAITING, QUIET)
        lines = walk_line(picture, shown, self._player.speed) + told_line(shown)
        return lines + tube_line(self._tube_name, shown)

    def _add_commands(self, gui: viser.GuiApi, commands: Mapping[str, Slider]) -> None:
        if not commands:
            return
        with gui.add_folder("Commands"):
            for name, slider in commands.items():
                handle = self._sliders.add(slider._replace(hint=HEARD))

                def tell(_event: object, name=name, handle=handle, slider=slider):
                    value = slider.clip(handle.value)
                    if value is not None:
                        self._player.ask(lambda robot: robot.tell(name, value * slider.unit))

                handle.on_update(tell)

    def _add_push(self, gui: viser.GuiApi) -> None:
        with gui.add_folder("Push"):
            size = self._sliders.add(PUSH)
            ways = gui.add_button_group("push", tuple(WAYS))
            gui.add_html(note("Keys J, L, I and K push left, right, forward and back."))

        def push(way: str | None) -> None:
            impulse = PUSH.clip(size.value)
            if impulse is not None and way in WAYS:
                self._player.ask(lambda robot: robot.push(impulse * np.array(WAYS[way])))

        @ways.on_click
        def _(_event: object) -> None:
            push(ways.value)

        for key, way in zip(("J", "L", "I", "K"), WAYS, strict=True):
            command = gui.add_command(f"push {way.strip('◄► ')}", hotkey=key)
            command.on_trigger(lambda _event, way=way: push(way))


def told_line(shown: SpatialMoment) -> str:
    """Return the line about the speed of a gait that is told one; "" of any other."""
    if not shown.told:
        return ""
    way = abs(shown.requested - shown.told) > 5e-4
    goal = f", on the way to {shown.requested:.3f}" if way else ""
    return line(f"This step was told {shown.told:.3f} m/s{goal}", QUIET)


def tube_line(tube: str, shown: SpatialMoment) -> str:
    """Return the line that says whether the state is in the tube now, and how often it was."""
    inside = shown.distance <= 1.0
    # Rounded down: not all ticks are inside unless all are.
    share = math.floor(1000.0 * shown.share) / 10.0
    words = (
        f"Inside the {tube} now: {'yes' if inside else 'no'}, "
        f"{shown.distance:.2f} half axes from its middle · {share:.1f} % of ticks so far"
    )
    return line(words, GOOD if inside else TIGHT)


def _kept_apart(proved: str) -> str:
    """Return two lines of HTML: what is proved, and what is only simulated."""
    rows = (("Proved", proved), ("Simulated", "all that you see; the robot may fall."))
    lines = (f"<div><b>{name}</b> {html.escape(words)}</div>" for name, words in rows)
    return f'<div style="padding:2px 10px 6px;font-size:12.5px">{"".join(lines)}</div>'
