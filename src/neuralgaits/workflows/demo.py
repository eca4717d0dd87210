"""A gait that came with the package, and its proof: something to see without training."""

from pathlib import Path

from neuralgaits.errors import RunError
from neuralgaits.runs.commands import LATEST, command
from neuralgaits.runs.names import ROBOT
from neuralgaits.viewer import page
from neuralgaits.workflows.view import LiveView, view

FOLDER = Path(__file__).parents[1] / "demo_run"
"""A run folder like any other, to be read only; `tools/make_demo.py` makes it."""


def demo(*, host: str = page.LOOPBACK, port: int | None = None) -> LiveView:
    """Serve a live page of the shipped run; see `view`."""
    if not (FOLDER / ROBOT).is_file():
        raise RunError(
            f"expected the shipped run in {FOLDER}, found none: install the package again, or "
            f"view a run of your own, as with `{command('view', LATEST)}`"
        )
    return view(FOLDER, host=host, port=port)
