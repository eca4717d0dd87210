"""The live page of a biped's run: it walks under `pd` in MuJoCo, and visitors push it."""

from typing import Any

from typing_extensions import override

from neuralgaits.runs.shell_words import command, named
from neuralgaits.systems.family_run import FamilyRun
from neuralgaits.systems.run_statements import stated_bounds, why_nothing_is_stated
from neuralgaits.systems.walker3d.live_controllers import controller_of
from neuralgaits.systems.walker3d.live_panel import SpatialPanel, StatedProof
from neuralgaits.systems.walker3d.live_stage import SpatialStage
from neuralgaits.systems.walker3d.live_walk import SpatialLive
from neuralgaits.viewer import markdown
from neuralgaits.viewer.live_page import LivePage
from neuralgaits.viewer.player import Picture, Player

NOT_COVERED = (
    "**What is not covered.** The theorem is about the model: the yaw held, the stance foot "
    "pinned, outputs exactly as the policy says. Nothing is proved of the law `pd`, of MuJoCo's "
    "soft floor, or of pushes. **Inside the tube** compares the measured (x, y, L_y, n) "
    "with the tube: inside, this robot may still fall, and outside, nothing is proved."
)


class SpatialPage(LivePage):
    """A live page of a biped in three dimensions.

    Attributes:
        robot: simulated robot.
        player: player that moves it.
        url: address of the page.
        port: port that the server listens on.
        host: address that the server is bound to.
    """

    player: Player[SpatialLive]

    def __init__(self, run: FamilyRun, host: str, port: int | None):
        """Serve the page with the robot standing, and start the threads that complete it."""
        super().__init__(f"Neural Gaits: {run.config.robot}", host, port)
        self._run = run
        try:
            self.robot = SpatialLive(run)
            self.player = Player(self.robot, self._show)
            self._stage = SpatialStage(self._server, run.data)
            self._stage.show(self.robot.shown())
            title = f"**{markdown.text(run.config.robot)}**, seed {run.config.seed}, law `pd`"
            self._panel = SpatialPanel(self._server, self.player, self._stage, self.robot, title)
        except BaseException:
            self.close()
            raise
        self._complete_with(self._complete)
        self.player.start()

    @property
    @override
    def summary(self) -> dict[str, Any]:
        return super().summary | {"run": str(self._run.path)}

    def _complete(self) -> None:
        """Give the robot its controller, then read the proof file."""
        controller = controller_of(self._run)
        self.player.ask(lambda robot: robot.control_with(controller))
        stated = proof_in_words(self._run)
        self._if_open(lambda: self._panel.tell_proof(stated))

    def _show(self, picture: Picture) -> None:
        self._stage.show(picture.shown)
        self._panel.show(picture)


def proof_in_words(run: FamilyRun) -> StatedProof:
    """Return what a run's proof file states in words."""
    bounds, system = stated_bounds(run), run.system
    again = markdown.code(command("certify", named(run.path)))
    if bounds is None:
        why = why_nothing_is_stated(run)
        words = "**Nothing is proved of this gait.** " + (
            f"{markdown.text(why)}." if why else f"{again} looks for a proof."
        )
        return StatedProof("nothing of this gait.", f"{words}\n\n{NOT_COVERED}", False)
    levels = system.conclude(bounds, run.config, system.highest)
    proved = [one for one in levels if one.proved]
    names = [name for name in run.table.conditions if name in bounds]
    highest = max((one.level for one in proved), default=1)
    first = proved[0].words[0] if proved else f"{len(names)} conditions hold on their regions"
    check = markdown.code(command("check-proof", named(run.path), "--run", named(run.path)))
    rows = [f"- Level {one.level}: {markdown.text(s)}." for one in proved for s in one.words]
    rows.insert(0, f"- Level 1: {len(names)} conditions hold at every state of their regions.")
    words = (
        "**According to the proof file**, which this page has not checked; "
        f"{check} does:\n\n" + "\n".join(rows) + f"\n\n{NOT_COVERED}"
    )
    return StatedProof(f"of the model, to level {highest}: {first}.", words, bool(proved))
