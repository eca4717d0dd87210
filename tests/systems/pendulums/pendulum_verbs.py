"""Verbs on pendulums."""

from dataclasses import dataclass
from pathlib import Path
from types import SimpleNamespace

from neuralgaits.records.record import Record
from neuralgaits.runs import RUNS_ROOT, RunFolder, finish, resolve
from neuralgaits.systems.family_run import FamilyConfig
from neuralgaits.systems.system_family import ProgressCallbacks, Screen, VerbResult


@dataclass(frozen=True, eq=False, kw_only=True)
class Angle(Record):
    """Where it hangs."""

    angle: float


def train(
    robot: str,
    *,
    progress: ProgressCallbacks,
    seed: int = 0,
    out: Path | None = None,
    root: Path = RUNS_ROOT,
) -> VerbResult:
    """Leave a run."""
    config = FamilyConfig(family="pendulum", robot=robot, spec="hanging", seed=seed, steps=1)
    folder = RunFolder.create(config, {"robot.xml": ""}, name=robot, seed=seed, root=root, out=out)
    progress.trained(1, 1, 0.0)
    done = Angle(angle=0.1 * seed)
    finish(folder, done, root)
    return VerbResult(
        done, True, Screen("hangs", ": it does not move"), run=SimpleNamespace(path=folder.path)
    )


def simulate(run: str, *, progress: ProgressCallbacks) -> VerbResult:
    """Look at it."""
    progress.begun()
    found = Angle(angle=round(0.1 * int(resolve(run).config["seed"]), 3))
    return VerbResult(found, False, Screen("swings"))


VERBS = {"train": train, "simulate": simulate}
