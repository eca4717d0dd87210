"""What a finished training says of itself: `summary.json` of a run."""

from typing import Any

from neuralgaits.errors import RunError
from neuralgaits.runs.commands import resuming
from neuralgaits.runs.folder import RunFolder, refuse_misshapen
from neuralgaits.runs.shape import COUNT, NUMBER, Shape, may, table_of

TRAINED: Shape = {
    "steps": COUNT,
    "loss": may(NUMBER),
    "wall_s": NUMBER,
    "conditions": table_of(
        {"mean_violation": NUMBER, "max_violation": NUMBER, "min_margin": NUMBER}
    ),
}
"""`summary.json` of a run."""


def trained(folder: RunFolder) -> dict[str, Any]:
    """The summary of a finished training.

    Raises: RunError if it is damaged; the last checkpoint can be finished again.
    """
    try:
        found = folder.summary
        refuse_misshapen(found, TRAINED, folder.path / "summary.json")
    except RunError as error:
        again = resuming(folder.path)
        raise RunError(f"{error}; deleted, it is written again by `{again}`") from None
    return found
