"""Gaits that come with the package, to watch without training."""

from pathlib import Path

from neuralgaits._argument_types import type_checked
from neuralgaits.analysis.run import open_run
from neuralgaits.errors import InputError, RunError
from neuralgaits.runs.names import ROBOT
from neuralgaits.runs.shell_words import LATEST, command
from neuralgaits.viewer import live_server
from neuralgaits.workflows.view import LiveView

FOLDER = Path(__file__).parents[1] / "demo_run"
"""Shipped run folder, read-only; `tools/make_demo.py` makes it."""
TOLD = FOLDER.with_name("demo_speed_run")
"""Shipped run folder of a gait that takes speed commands; its proof is compressed."""
BELIEVED = FOLDER.with_name("demo_lean_run")
"""Shipped run folder of a gait that learns a lean of the torso."""


@type_checked
def demo(
    *,
    speed: bool = False,
    lean: bool = False,
    host: str = live_server.LOOPBACK,
    port: int | None = None,
) -> LiveView:
    """Serve a live page of a shipped run; see `view`.

    Args:
        speed: show the gait that takes speed commands.
        lean: show the gait that learns where the torso's centre of mass is.
        host: address to bind to.
        port: port of the page; the next free one from 8080 if None.

    Raises: InputError for both gaits at once, RunError if the package lacks the run.
    """
    if speed and lean:
        raise InputError(
            "expected --speed or --lean, found both: each shows a gait of its own; leave one out"
        )
    folder = TOLD if speed else BELIEVED if lean else FOLDER
    if not (folder / ROBOT).is_file():
        raise RunError(
            f"expected the shipped run in {folder}, found none: install the package again, or "
            f"view a run of your own, as with `{command('view', LATEST)}`"
        )
    live_server.refuse_no_port(port)
    return LiveView(open_run(folder), host, port)
