"""A live page of a run: the robot walks in MuJoCo, and visitors can disturb it."""

from pathlib import Path
from typing import Any

import numpy as np
import viser
from typing_extensions import override

from neuralgaits._argument_types import type_checked
from neuralgaits.analysis.point_evaluator import PointEvaluator, quantities
from neuralgaits.analysis.run import Run, open_run
from neuralgaits.errors import SpecError
from neuralgaits.gait.zero_coordinates import momentum_of, position_of
from neuralgaits.report.page.phrases import told_apart
from neuralgaits.systems.family_tasks import task_with
from neuralgaits.systems.system_family import ProgressCallbacks
from neuralgaits.viewer import live_server, markdown
from neuralgaits.viewer.live_gait import LiveGait
from neuralgaits.viewer.live_monitor import LiveMonitor
from neuralgaits.viewer.live_page import LivePage
from neuralgaits.viewer.panel import Panel
from neuralgaits.viewer.player import Picture, Player
from neuralgaits.viewer.portrait_of_run import portrait
from neuralgaits.viewer.stage import Stage
from neuralgaits.viewer.walker import Walker


class LiveView(LivePage):
    """A live page that is being served.

    Attributes:
        gait: gait that walks.
        player: player that moves the gait.
        url: address of the page.
        port: port that the server listens on.
        host: address that the server is bound to.
    """

    player: Player[Walker]

    def __init__(self, run: Run, host: str, port: int | None, terrain: str | None = None):
        """Serve the page with the robot standing, and start the threads that complete it."""
        super().__init__(f"Neural Gaits: {run.robot.name}", host, port)
        self._terrain = terrain
        try:
            self.gait = LiveGait(run, terrain)
            self._run = self.gait.run
            self.player = Player(self.gait, self._show)
            self._stage = Stage(self._server, run.robot.layout)
            self._stage.show(self.gait.shown())
            self._panel = self._build_panel()
        except BaseException:
            self.close()
            raise
        self._complete_with(self._bring_to_life)
        self.player.start()

    @property
    @override
    def summary(self) -> dict[str, Any]:
        return super().summary | {"run": str(self._run.path), "terrain": self._terrain}

    @property
    def _words(self) -> dict[str, str]:
        """Return what the run's conditions state, by name."""
        return told_apart({one.name: one.data for one in self._run.config.conditions})

    def _build_panel(self) -> Panel:
        config = self._run.config
        words = self._words
        told = ", ".join(command.name for command in self._run.trained.commands)
        commands = f", commands: {markdown.text(told)}" if told else ""
        return Panel(
            self._server,
            self.player,
            title=f"**{markdown.text(config.robot)}**, spec {markdown.code(config.spec)}, "
            f"seed {markdown.text(str(config.seed))}{commands}",
            settings=self.gait.settings,
            conditions={one.name: words.get(one.name, "") for one in self._run.spec.conditions},
            restarted=self._stage.restart,
            commands=self.gait.commands,
            sizes=self.gait.sizes,
            adaptable=self.gait.adaptable,
            adapts=self.gait.adapts_at_first,
        )

    def _bring_to_life(self) -> None:
        """Add certificate, margins and portrait to the page, while the robot walks."""
        # Its imports would hold up the first frame.
        from neuralgaits.viewer.sureness import how_sure

        run = self._run
        try:
            evaluate = PointEvaluator(quantities(run.zero_dynamics, run.gait, run.spec))
            self.gait.look_with(evaluate)
            sure = how_sure(run, self._words)
            plane = portrait(run, evaluate, certified=sure.certified and sure.map_fits)
        except SpecError as error:
            why = f"no margins and no phase portrait: {error}"
            self._if_open(lambda: self._panel.explain_margins(why))
            return

        def complete() -> None:
            watched = None if sure.monitor is None else LiveMonitor(run, sure.monitor)
            self.gait.watch_with(watched, sure.beliefs_within, sure.proved_of)
            self._panel.tell_how_sure(sure.verdict, sure.words, sure.theorem)
            self._panel.chart.fill(plane, self._clicked)

        self._if_open(complete)

    def _show(self, picture: Picture) -> None:
        self._stage.show(picture.shown)
        self._panel.chart.show(picture.shown.z, picture.shown.trail)
        self._panel.show(picture)

    def _clicked(self, client: viser.ClientHandle | None, z: np.ndarray) -> None:
        def go(walker: Walker) -> str | None:
            refused = walker.jump(z)
            if refused is None:
                self._stage.restart()
                return f"Put to z = ({position_of(z):.3f} m, {momentum_of(z):.2f} kg m²/s)."
            if client is not None:
                client.add_notification(
                    "Not there", refused, auto_close_seconds=5.0, color="orange"
                )
            return refused

        self.player.ask(go)


@type_checked
def view(
    run: Run | str | Path,
    *,
    host: str = live_server.LOOPBACK,
    port: int | None = None,
    terrain: str | Path | None = None,
) -> LivePage:
    """Serve a live page of a run.

    Args:
        run: a run, its folder, or `latest`.
        host: address to bind to; with any other than loopback, other machines reach the page.
        port: port to listen on; None takes a free one.
        terrain: blocks in place of the floor, as in `simulate`.

    Returns: the page, already serving. `wait` until it ends, then `close` it, or use it as a
        context manager.
    Raises: InputError, RobotError or RunError with one line.
    """
    live_server.refuse_no_port(port)
    options = {"run": run, "port": port, "terrain": terrain}
    options = {name: value for name, value in options.items() if value is not None}
    if (task := task_with("view", options | {"host": host})) is not None:
        page: LivePage = task(ProgressCallbacks()).returned
        return page
    return LiveView(open_run(run), host, port, None if terrain is None else str(terrain))
