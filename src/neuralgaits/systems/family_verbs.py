"""Verbs of a family beside walkers. Their arguments are the options that each has for a family."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

from neuralgaits.errors import InputError
from neuralgaits.runs import RUNS_ROOT
from neuralgaits.systems import family_screens as screens
from neuralgaits.systems.controller_export import export_family
from neuralgaits.systems.family_certificate import certify_family
from neuralgaits.systems.family_files import inspect_robot, write_robot
from neuralgaits.systems.family_page import report_family
from neuralgaits.systems.family_run import FamilyConfig, open_family_run
from neuralgaits.systems.family_training import train_family
from neuralgaits.systems.network_system import NetworkSystem
from neuralgaits.systems.proved_system import ExportedSystem, ProvedSystem
from neuralgaits.systems.system_family import ProgressCallbacks, VerbResult
from neuralgaits.systems.trained_system import TrainedSystem


@dataclass(frozen=True)
class FileVerbs:
    """Verbs on a family's robot files. Attributes: system: the family's own part."""

    system: TrainedSystem

    def inspect(self, robot: str | Path) -> VerbResult:
        """Describe a robot file (`inspect`)."""
        inspected = inspect_robot(self.system, robot)
        return VerbResult(inspected, True, self.system.robot_screen(inspected))

    def robots(self, robot: str, out: Path | None = None) -> VerbResult:
        """Write a built-in robot's file (`robots`)."""
        written = write_robot(self.system, robot, out)
        return VerbResult(written, True, screens.screen_of_written(written))


@dataclass(frozen=True)
class FamilyVerbs(FileVerbs):
    """Verbs on a family's systems, and on their robot files."""

    system: ProvedSystem

    def train_as(
        self,
        config: FamilyConfig,
        robot: str | Path,
        *,
        progress: ProgressCallbacks,
        out: Path | None = None,
        certify: bool = False,
        budget: float | None = None,
        root: Path = RUNS_ROOT,
    ) -> VerbResult:
        """Train a controller and its set as configured, and prove it if asked for."""
        run = train_family(
            self.system,
            str(robot),
            config,
            out=out,
            root=root,
            progress=lambda step, loss: progress.trained(step, config.steps, loss),
            begun=progress.begun,
        )
        trained = run.summary
        if certify:
            proof = certify_family(run, budget=budget, progress=progress.proved)
            trained = replace(trained, proof=proof.verdict)
        good = trained.holds and trained.proof in (None, "proved")
        undecided = trained.holds and trained.proof == "undecided"
        screen = screens.screen_of_training(self.system, trained)
        return VerbResult(trained, good, screen, undecided, run=run)

    def certify(
        self,
        run: str | Path,
        *,
        progress: ProgressCallbacks,
        level: int | None = None,
        budget: float | None = None,
    ) -> VerbResult:
        """Prove a run, to the highest level if no other is asked for."""
        highest = self.system.highest
        if level is not None and level > highest:
            raise InputError(
                f"expected a level from 1 to {highest}, found {level}: {self.system.why_highest}"
            )
        opened = open_family_run(self.system, run)
        certificate = certify_family(opened, level=level, budget=budget, progress=progress.proved)
        screen = screens.screen_of_proof(self.system, certificate)
        return VerbResult(
            certificate, certificate.verdict == "proved", screen, certificate.verdict == "undecided"
        )

    def simulate(
        self, run: str | Path, *, progress: ProgressCallbacks, episodes: int = 1, seed: int = 0
    ) -> VerbResult:
        """Simulate episodes in MuJoCo from random states of the set."""
        opened = open_family_run(self.system, run)
        progress.begun()
        walks, good = self.system.episodes(opened, episodes, seed)
        return VerbResult(walks, good, self.system.episodes_screen(walks))

    def export(
        self, run: str | Path, out: Path, *, progress: ProgressCallbacks, force: bool = False
    ) -> VerbResult:
        """Export the controller as C, and compare it with Python."""
        system = self.system
        if not isinstance(system, ExportedSystem):
            raise InputError(f"expected a controller with an export, found {system.family.words}")
        opened = open_family_run(system, run)
        progress.begun()
        exported = export_family(system, opened, out, force=force)
        screen = screens.screen_of_export(system.header(opened).unit, exported)
        return VerbResult(exported, exported.checked, screen, undecided=not exported.checked)

    def report(
        self, run: str | Path, out: Path | None = None, *, progress: ProgressCallbacks
    ) -> VerbResult:
        """Write the page of a run."""
        opened = open_family_run(self.system, run)
        progress.begun()
        written = report_family(opened, out)
        exports = isinstance(self.system, ExportedSystem)
        return VerbResult(written, True, screens.screen_of_report(written, exports=exports))

    def by_name(self) -> dict[str, Callable[..., VerbResult]]:
        """Return the verbs that the family has by name."""
        exports = isinstance(self.system, ExportedSystem)
        return {
            "certify": self.certify,
            "simulate": self.simulate,
            **({"export": self.export} if exports else {}),
            "report": self.report,
            "inspect": self.inspect,
            "robots": self.robots,
        }


@dataclass(frozen=True)
class NetworkVerbs(FamilyVerbs):
    """Verbs on systems whose training finds networks."""

    system: NetworkSystem

    def train(
        self,
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
        config = self.system.new_config(seed=seed, steps=steps, hidden=hidden)
        return self.train_as(
            config, robot, progress=progress, out=out, certify=certify, budget=budget, root=root
        )

    def by_name(self) -> dict[str, Callable[..., VerbResult]]:
        """Return the verbs that the family has by name."""
        return {"train": self.train} | super().by_name()
