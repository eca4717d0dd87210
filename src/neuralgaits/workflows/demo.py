"""Gaits that come with the package, to watch without training."""

from pathlib import Path

from neuralgaits._argument_types import type_checked
from neuralgaits.analysis.run import open_run
from neuralgaits.errors import RunError
from neuralgaits.runs.names import ROBOT
from neuralgaits.runs.shell_words import LATEST, command
from neuralgaits.viewer import live_server
from neuralgaits.workflows.view import LiveView

FOLDER = Path(__file__).parents[1] / "demo_run"
"""Shipped run folder, read-only; `tools/make_demo.py` makes it."""
TOLD = FOLDER.with_name("demo_speed_run")
"""Shipped run folder of a gait that takes speed commands; its proof is compressed."""


@type_checked
def demo(
    *, speed: bool = False, host: str = live_server.LOOPBACK, port: int | None = None
) -> LiveView:
    """Serve a live page of a shipped run; see `view`. With `speed`, its gait takes commands."""
    folder = TOLD if speed else FOLDER
    if not (folder / ROBOT).is_file():
        raise RunError(
            f"expected the shipped run in {folder}, found none: install the package again, or "
            f"view a run of your own, as with `{command('view', LATEST)}`"
        )
    live_server.refuse_no_port(port)
    return LiveView(open_run(folder), host, port)
