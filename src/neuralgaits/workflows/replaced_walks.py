"""Which simulation a new one takes the place of: a run folder has room for one."""

from neuralgaits.analysis.run import Run
from neuralgaits.errors import RunError
from neuralgaits.records.simulated import WALK_SUMMARY, SimulationSummary


def replaces_undisturbed(run: Run, result: SimulationSummary) -> bool:
    """Return whether disturbed walks replace undisturbed ones of the same gait in the run."""
    if not _disturbed(result):
        return False
    try:
        before = SimulationSummary.read(run.path / WALK_SUMMARY)
    except RunError:
        return False  # There are none, or they are damaged.
    return not _disturbed(before) and before.sha256 == result.sha256


def _disturbed(walks: SimulationSummary) -> bool:
    """Return whether walks met anything that the gait was not trained for."""
    return bool(walks.met or walks.parameters or walks.terrain)
