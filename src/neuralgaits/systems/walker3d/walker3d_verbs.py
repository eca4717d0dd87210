"""Verbs on bipeds in three dimensions. Their arguments are the options that each has for them."""

from collections.abc import Callable, Mapping
from pathlib import Path

import jax
import numpy as np

from neuralgaits.errors import InputError
from neuralgaits.runs import RUNS_ROOT
from neuralgaits.settings.forms import Interval
from neuralgaits.simulation.setup.command_schedule import schedule_of
from neuralgaits.simulation.setup.disturbance import PlantChanges
from neuralgaits.systems.family_run import open_family_run
from neuralgaits.systems.family_verbs import FamilyVerbs
from neuralgaits.systems.system_family import ProgressCallbacks, Screen, VerbResult
from neuralgaits.systems.walker3d.spatial_changes import changes_of
from neuralgaits.systems.walker3d.spatial_screens import screen_of_walks
from neuralgaits.systems.walker3d.spatial_system import SYSTEM
from neuralgaits.systems.walker3d.spatial_walks import (
    LAWS,
    STEPS,
    WalkPlan,
    simulate_walks,
    starts_of,
)
from neuralgaits.viewer.live_server import LOOPBACK

SHARED = FamilyVerbs(SYSTEM)


def train(
    robot: str | Path,
    *,
    progress: ProgressCallbacks,
    seed: int = 0,
    steps: int | None = None,
    speed: float | Interval | None = None,
    out: Path | None = None,
    certify: bool = False,
    budget: float | None = None,
    root: Path = RUNS_ROOT,
) -> VerbResult:
    """Find a gait and its tube, at a speed if one is given, and prove it if asked for."""
    config = SYSTEM.new_config(seed=seed, steps=steps, speed=speed)
    return SHARED.train_as(
        config, robot, progress=progress, out=out, certify=certify, budget=budget, root=root
    )


def simulate(
    run: str | Path,
    *,
    progress: ProgressCallbacks,
    controller: str = "pd",
    episodes: int = 1,
    steps: int = STEPS,
    seed: int = 0,
    push: float | None = None,
    push_left: float | None = None,
    command: str | Mapping[str, float] | None = None,
    commands: str | Path | None = None,
    disturb: str | Mapping[str, float] | PlantChanges | None = None,
    sensing: str | None = None,
) -> VerbResult:
    """Walk in MuJoCo, pushed forward and to the left, disturbed as walkers in the plane."""
    if controller not in LAWS:
        raise InputError(
            f"controller: expected {' or '.join(LAWS)} for a walker in three dimensions, found "
            f"{controller}: choose one of these"
        )
    changes = changes_of(disturb, sensing)
    opened = open_family_run(SYSTEM, run)
    gait = opened.controller
    told = None
    if gait.command is not None or command is not None or commands is not None:
        known = () if gait.command is None else (gait.command,)
        told = schedule_of(known, command, commands, seed)
        gait = jax.tree.map(np.asarray, gait.step(np.repeat(told.first, 2)))
    progress.begun()
    plan = WalkPlan(
        controller=controller,
        starts=starts_of(gait, episodes, seed),
        steps=steps,
        told=told,
        step_s=opened.summary.step_s,
        push=push,
        push_left=push_left,
        changes=changes,
        seed=seed,
    )
    record = simulate_walks(opened, plan)
    good = record.walked == record.episodes
    return VerbResult(record, good, screen_of_walks(record))


def view(run: str | Path, *, host: str = LOOPBACK, port: int | None = None) -> VerbResult:
    """Serve a live page of a run."""
    from neuralgaits.systems.walker3d.spatial_page import SpatialPage  # Brings the server.

    page = SpatialPage(open_family_run(SYSTEM, run), host, port)
    return VerbResult(page.summary, True, Screen(), run=page)


VERBS: dict[str, Callable[..., VerbResult]] = {
    "train": train,
    **SHARED.by_name(),
    "simulate": simulate,
    "view": view,
}
