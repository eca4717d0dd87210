"""Verbs on bipeds in three dimensions. Their arguments are the options that each has for them."""

from collections.abc import Callable
from pathlib import Path

from neuralgaits.errors import InputError
from neuralgaits.runs import RUNS_ROOT
from neuralgaits.systems.family_run import open_family_run
from neuralgaits.systems.family_training import train_family
from neuralgaits.systems.family_verbs import FileVerbs
from neuralgaits.systems.system_family import ProgressCallbacks, VerbResult
from neuralgaits.systems.walker3d.spatial_screens import screen_of_gait, screen_of_walks
from neuralgaits.systems.walker3d.spatial_system import SpatialSystem
from neuralgaits.systems.walker3d.spatial_walks import (
    LAWS,
    WalkPlan,
    simulate_walks,
    starts_of,
)

SYSTEM = SpatialSystem()


def train(
    robot: str | Path,
    *,
    progress: ProgressCallbacks,
    seed: int = 0,
    steps: int | None = None,
    out: Path | None = None,
    root: Path = RUNS_ROOT,
) -> VerbResult:
    """Find a periodic gait and the inlet about it."""
    total = SYSTEM.steps if steps is None else steps
    run = train_family(
        SYSTEM,
        str(robot),
        seed=seed,
        steps=steps,
        out=out,
        root=root,
        progress=lambda step, loss: progress.trained(step, total, loss),
    )
    done = run.summary
    return VerbResult(done, done.holds, screen_of_gait(done), run=run)


def simulate(
    run: str | Path,
    *,
    progress: ProgressCallbacks,
    controller: str = "pd",
    episodes: int = 1,
    steps: int = 50,
    seed: int = 0,
    push: float | None = None,
) -> VerbResult:
    """Walk in MuJoCo. A push is sideways, positive to the left."""
    if controller not in LAWS:
        raise InputError(
            f"controller: expected {' or '.join(LAWS)} for a walker in three dimensions, found "
            f"{controller}: choose one of these"
        )
    opened = open_family_run(SYSTEM, run)
    progress.begun()
    gait = opened.controller
    plan = WalkPlan(controller, starts_of(gait, episodes, seed), steps, opened.summary.step_s, push)
    record = simulate_walks(opened, plan)
    good = record.walked == record.episodes
    return VerbResult(record, good, screen_of_walks(record))


FILES = FileVerbs(SYSTEM)
VERBS: dict[str, Callable[..., VerbResult]] = {
    "train": train,
    "simulate": simulate,
    "inspect": FILES.inspect,
    "robots": FILES.robots,
}
