"""A folder of inputs to alter: kept whole beside it, and put back after every case."""

import json
import os
import shutil
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

from neuralgaits.analysis.run import Run, open_run
from neuralgaits.certificate.levels.level_search import find_sets
from neuralgaits.certificate.levels.problems import (
    condition_problems,
    premise_problems,
    trace_certificate,
)
from neuralgaits.certificate.search.problem import Problem
from neuralgaits.robots import PlanarBiped, load_robot, registry
from neuralgaits.training import Trainer, TrainState
from support import amber3m_files, brief_spec, small_proof
from support.random_biped import catalogue

OUTPUTS = ("report.html", "figures", "report", "episodes.png", "MUJOCO_LOG.TXT")
"""Of a run: what readers may write again, being made from the rest."""
RUN, EPISODES, FILES = "run", "episodes", "files"
Signature = dict[str, tuple[int, int, int]]


@dataclass(frozen=True)
class Place:
    """Inputs under `root`, and the same inputs untouched under `kept`."""

    root: Path
    kept: Path

    @classmethod
    def make(cls, folder: Path, run: Path, episodes: Path | None = None) -> "Place":
        """Gather a run, episodes, and files of every other kind in a folder."""
        kept = folder / "kept"
        shutil.copytree(run, kept / RUN)
        if episodes is not None:
            shutil.copytree(episodes, kept / EPISODES)
        files = kept / FILES
        files.mkdir()
        _small_proof(files / "small.json")
        for name in registry.built_in():
            (files / f"{name}.xml").write_bytes(registry.model_file(name).read_bytes())
        _random_robots(files)
        shutil.copy(brief_spec.__file__, files / "brief.py")
        log = kept / RUN / "simulation" / "walk.csv"
        if log.is_file():
            _logs(log, files)
            shutil.copy(files / "walk.csv", log)
        (kept / "latest").write_text(f"{RUN}\n")
        shutil.copytree(kept, folder / "inputs")
        return cls(folder / "inputs", kept)

    @cached_property
    def robot(self) -> PlanarBiped:
        """The default robot."""
        return load_robot("amber3m")

    @cached_property
    def run(self) -> Run:
        """The run as it was."""
        return open_run(self.kept / RUN)

    @cached_property
    def state(self) -> TrainState:
        """What a checkpoint of the run must be like."""
        run = self.run
        config = run.folder.config
        trainer = Trainer.build(
            run.robot, run.spec, run.gait, steps=config["steps"], seed=config["seed"]
        )
        return trainer.init(run.gait)

    @cached_property
    def problems(self) -> list[Problem]:
        """What the boxes of the run's certificate are about, in their order."""
        sets = find_sets(self.run.spec, self.run.gait, self.run.zero_dynamics, 4, (0.0, 0.0))
        run = self.run
        program = trace_certificate(run.spec, run.robot, run.gait, sets, run.residuals)
        return [*condition_problems(run.spec, program), *premise_problems(run.spec, sets, program)]

    @cached_property
    def names(self) -> list[str]:
        """Every input, relative to the root."""
        return sorted(str(p.relative_to(self.kept)) for p in self.kept.rglob("*") if p.is_file())

    def signature(self) -> Signature:
        """Size, time and identity of every file that nobody may write."""
        return {name: found for name, found in self._stats() if not _is_output(name)}

    def _stats(self) -> Iterator[tuple[str, tuple[int, int, int]]]:
        top = len(str(self.root)) + 1
        for folder, _, files in os.walk(self.root):
            for file in files:
                path = f"{folder}/{file}"
                stat = os.stat(path)
                yield path[top:], (stat.st_size, stat.st_mtime_ns, stat.st_ino)

    @cached_property
    def times(self) -> dict[str, int]:
        """When the inputs were last written, by name."""
        return {name: (self.kept / name).stat().st_mtime_ns for name in self.names}

    def put_back(self, altered: str | None) -> None:
        """Make the inputs what they were."""
        if altered is not None:
            shutil.copy2(self.kept / altered, self.root / altered)
        found = dict(self._stats())
        for name in found.keys() - self.times.keys():
            (self.root / name).unlink()
        for name, time in self.times.items():
            if name not in found or found[name][1] != time:
                (self.root / name).parent.mkdir(parents=True, exist_ok=True)
                shutil.copy2(self.kept / name, self.root / name)


def _is_output(name: str) -> bool:
    parts = Path(name).parts
    made = parts[-1] in OUTPUTS or any(part in OUTPUTS for part in parts[1:-1])
    return made or parts == (EPISODES, "summary.json")


def _small_proof(path: Path) -> None:
    path.write_text(json.dumps(small_proof.proof()))


def _random_robots(folder: Path) -> None:
    for name, text in catalogue(6).items():
        (folder / f"{name}.xml").write_text(text)


def _logs(log: Path, folder: Path) -> None:
    """The first steps of a walk, in both formats."""
    from neuralgaits import logs

    header, *rows = log.read_text().splitlines()
    (folder / "walk.csv").write_text("\n".join([header, *rows[:2400:4]]) + "\n")
    read = logs.read(folder / "walk.csv", load_robot("amber3m")).log
    amber3m_files.write(folder / "amber.csv", amber3m_files.rows(read))
