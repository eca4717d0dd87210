"""Verbs on cart-poles. Their arguments are the options that each has for a cart-pole."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

from neuralgaits.errors import InputError
from neuralgaits.runs import RUNS_ROOT
from neuralgaits.systems.cartpole import cartpole_screen as screen
from neuralgaits.systems.cartpole.cartpole_certify import HIGHEST, certify_cartpole
from neuralgaits.systems.cartpole.cartpole_export import export_cartpole
from neuralgaits.systems.cartpole.cartpole_inspect import inspect_cartpole, write_cartpole
from neuralgaits.systems.cartpole.cartpole_report import report_cartpole
from neuralgaits.systems.cartpole.cartpole_run import open_cartpole
from neuralgaits.systems.cartpole.cartpole_simulate import simulate_cartpole
from neuralgaits.systems.cartpole.cartpole_train import STEPS, train_cartpole
from neuralgaits.systems.system_family import ProgressCallbacks, VerbResult


def train(
    robot: str | Path,
    *,
    progress: ProgressCallbacks,
    seed: int = 0,
    steps: int | None = None,
    hidden: tuple[int, ...] | None = None,
    out: Path | None = None,
    certify: bool = False,
    budget: float | None = None,
    root: Path = RUNS_ROOT,
) -> VerbResult:
    """Train a controller and its set, and prove it if asked for."""
    if hidden is not None and len(hidden) != 1:
        raise InputError(
            f"expected one hidden layer, found {len(hidden)}: give one width, as in --hidden 16"
        )
    total = steps or STEPS
    run = train_cartpole(
        str(robot),
        seed=seed,
        steps=steps,
        width=None if hidden is None else hidden[0],
        out=out,
        root=root,
        progress=lambda step, loss: progress.trained(step, total, loss),
    )
    done = run.summary
    if certify:
        proof = certify_cartpole(run, budget=budget, progress=progress.proved)
        done = replace(done, proof=proof.verdict)
    good = done.holds and done.proof in (None, "proved")
    undecided = done.holds and done.proof == "undecided"
    return VerbResult(done, good, screen.of_training(done), undecided, run=run)


def certify(
    run: str | Path,
    *,
    progress: ProgressCallbacks,
    level: int | None = None,
    budget: float | None = None,
) -> VerbResult:
    """Prove a run, to level 3 if no other is asked for."""
    level = HIGHEST if level is None else level
    if level > HIGHEST:
        raise InputError(
            f"expected a level from 1 to {HIGHEST}, found {level}: a cart-pole's levels 2 and 3 "
            "are about the full order already"
        )
    opened = open_cartpole(run)
    done = certify_cartpole(opened, level=level, budget=budget, progress=progress.proved)
    undecided = done.verdict == "undecided"
    return VerbResult(done, done.verdict == "proved", screen.of_proof(done), undecided)


def simulate(
    run: str | Path, *, progress: ProgressCallbacks, episodes: int = 1, seed: int = 0
) -> VerbResult:
    """Balance in MuJoCo."""
    opened = open_cartpole(run)
    progress.begun()
    done = simulate_cartpole(opened, episodes=episodes, seed=seed)
    return VerbResult(done, done.stayed == done.episodes, screen.of_episodes(done))


def export(
    run: str | Path, out: Path, *, progress: ProgressCallbacks, force: bool = False
) -> VerbResult:
    """Write the controller as C."""
    opened = open_cartpole(run)
    progress.begun()
    done = export_cartpole(opened, out, force=force)
    return VerbResult(done, done.checked, screen.of_export(done), undecided=not done.checked)


def report(run: str | Path, out: Path | None = None, *, progress: ProgressCallbacks) -> VerbResult:
    """Write the page of a run."""
    opened = open_cartpole(run)
    progress.begun()
    done = report_cartpole(opened, out)
    return VerbResult(done, True, screen.of_report(done))


def inspect(robot: str | Path, *, progress: ProgressCallbacks) -> VerbResult:
    """Describe a file."""
    del progress
    done = inspect_cartpole(robot)
    return VerbResult(done, True, screen.of_robot(done))


def robots(robot: str, out: Path | None = None, *, progress: ProgressCallbacks) -> VerbResult:
    """Write the built-in cart-pole's file."""
    del robot, progress
    done = write_cartpole(out)
    return VerbResult(done, True, screen.of_written(done))


VERBS: dict[str, Callable[..., VerbResult]] = {
    "train": train,
    "certify": certify,
    "simulate": simulate,
    "export": export,
    "report": report,
    "inspect": inspect,
    "robots": robots,
}
