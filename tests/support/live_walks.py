"""Live walks of a run's gait under `pd`, from the middle of its region."""

from neuralgaits.analysis.run import Run
from neuralgaits.control import Pd
from neuralgaits.simulation.live import LiveWalk
from neuralgaits.simulation.native.compiled_walk import Library
from neuralgaits.simulation.setup.starts import full_states, momentum_range


def live_walk(run: Run, library: Library | None) -> LiveWalk:
    """Return a walk that stands at its start; in JAX without a library."""
    start = full_states(run.zero_dynamics, run.gait, "centre", seed=0, episodes=1)[0]
    z2_range = momentum_range(run.trained)
    return LiveWalk(run.robot, run.trained.policy, Pd(), start, z2_range=z2_range, library=library)
