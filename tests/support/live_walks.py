"""Live walks of a run's gait under `pd`, from the middle of its region."""

from neuralgaits.analysis.run import Run
from neuralgaits.simulation.live import LiveWalk
from neuralgaits.simulation.native.compiled_walk import Library
from neuralgaits.simulation.setup.starts import controlled_gait, full_states


def live_walk(run: Run, library: Library | None) -> LiveWalk:
    """Return a walk that stands at its start; in JAX without a library."""
    start = full_states(run.zero_dynamics, run.gait, "centre", seed=0, episodes=1)[0]
    return LiveWalk(controlled_gait(run).under("pd"), start, library=library)
