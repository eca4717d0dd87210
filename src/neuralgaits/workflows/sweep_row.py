"""One row of a sweep, as a task: train, prove, walk. Settings and files in, a run's files out."""

import tempfile
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

from neuralgaits.analysis.run import Run
from neuralgaits.engine import Files, Settings
from neuralgaits.errors import NeuralGaitsError, is_full
from neuralgaits.records.record import build
from neuralgaits.records.simulated import WalkFigures
from neuralgaits.records.swept import ROW, UNDISTURBED, RowTimes, RowWalks, SweepRow
from neuralgaits.records.trained import TrainingSummary
from neuralgaits.robots.mjcf.loader import robot_from_text
from neuralgaits.runs import to_json
from neuralgaits.runs.names import ROBOT, SPEC
from neuralgaits.simulation.metrics import summary
from neuralgaits.simulation.native_walk import engine_of_trained
from neuralgaits.simulation.setup.command_schedule import on_slope, schedule_of
from neuralgaits.simulation.setup.disturbance import PlantChanges
from neuralgaits.simulation.trained_walks import TrainedWalks, at_first
from neuralgaits.sweeps.grid import speed_of
from neuralgaits.workflows.certify import certify
from neuralgaits.workflows.simulate import simulate
from neuralgaits.workflows.train import train


def carry_out(settings: Settings, files: Files) -> Files:
    """Make the run of a row in a temporary folder of its own.

    Args:
        settings: those of a `SweepRow`'s first fields, and: `spec_file`, the original path of a
            spec's file; `place`, where the run folder will be; `steps`, `certify`, `budget`,
            `controllers`, `disturbances`, `walks`, `walk_steps` of a `SweepConfig`.
        files: `robot.xml`, and `spec.py` for a spec that is in a file.

    Returns: the run's files by their paths in its folder, and `row.json`.
    """
    with tempfile.TemporaryDirectory(prefix="neuralgaits-row-") as folder:
        base = Path(folder)
        row = _Row(settings, files, base)
        finished = row.all_parts()
        contents = {
            str(path.relative_to(row.run)): path.read_bytes()
            for path in sorted(row.run.rglob("*"))
            if path.is_file()
        }
        replaced = {str(row.run): settings["place"], str(base / SPEC): settings["spec_file"] or ""}
        contents = {
            name: _with_final_paths(name, content, replaced) for name, content in contents.items()
        }
    return contents | {ROW: to_json(finished).encode()}


class _Row:
    """Stages of a row, and their results so far."""

    def __init__(self, settings: Settings, files: Files, base: Path):
        self.settings = settings
        self.files = files
        self.base = base
        self.run = base / "run"
        self.values: dict[str, Any] = {
            name: settings[name] for name in ("name", "robot", "spec", "seed")
        }
        self.values["speed"] = None if settings["speed"] is None else tuple(settings["speed"])
        self.times: dict[str, float] = {}

    def all_parts(self) -> SweepRow:
        """Train, prove and walk, until a stage fails."""
        self.run.mkdir()
        part, trained = "train", None
        try:
            trained = self._run_part("train", self._train)
            if self.settings["certify"] is not None:
                part = "prove"
                self._run_part("prove", lambda: self._prove(trained))
            part = "walk"
            self._run_part("walk", lambda: self._walk(trained))
        except NeuralGaitsError as error:
            if is_full(error):
                # The machine's fault, not the row's: it may come out well elsewhere.
                raise
            line = " ".join(str(error).replace(str(self.base), "").split())
            self.values |= {"failure": "refused", "reason": f"{part}: {line}"}
        return SweepRow(**self.values, wall_s=RowTimes(**self.times))

    def _run_part(self, part: str, do: Callable[[], Any]) -> Any:
        start_time = time.perf_counter()
        try:
            return do()
        finally:
            self.times[part] = time.perf_counter() - start_time

    def _train(self) -> Run:
        settings = self.settings
        robot = robot_from_text(self.files[ROBOT].decode(), settings["robot"])
        spec = settings["spec"]
        if SPEC in self.files:
            (self.base / SPEC).write_bytes(self.files[SPEC])
            spec = f"{self.base / SPEC}:{spec.rpartition(':')[2]}"
        trained = train(
            robot,
            spec,
            seed=settings["seed"],
            steps=settings["steps"],
            speed=speed_of(settings["speed"]),
            out=self.run,
            root=self.base,
        )
        summary: TrainingSummary = trained.summary
        self.values |= {
            "steps": summary.steps,
            "loss": summary.loss,
            "conditions": len(summary.conditions),
            "broken": len(summary.broken),
        }
        return trained

    def _prove(self, run: Run) -> None:
        certificate = certify(
            run, level=self.settings["certify"], budget=self.settings["budget"]
        ).summary
        self.values |= {
            "verdict": certificate.verdict,
            "proved_level": certificate.proved_level,
            "margin": certificate.least_margin,
            "boxes": certificate.boxes,
        }

    def _walk(self, run: Run) -> None:
        settings, schedule = self.settings, schedule_of(run.trained.commands)
        run_at_first = at_first(run, schedule.first)
        walks = TrainedWalks(
            run=run_at_first,
            library=engine_of_trained(run_at_first).library,
            plant=None,
            controller="",
            steps=settings["walk_steps"],
            start="region",
            push=0.0,
            disturbance=PlantChanges(),
            seed=settings["seed"],
            schedule=schedule,
            threads=1,
        )
        rows = []
        for controller in settings["controllers"]:
            walks_under_law = replace(walks, controller=controller)
            for name, changes in ((UNDISTURBED, {}), *settings["disturbances"].items()):
                disturbance = on_slope(PlantChanges(**changes), schedule)
                disturbed = replace(walks_under_law, disturbance=disturbance)
                figures = summary(disturbed.walk(0, settings["walks"]))
                rows.append(_walks(controller, name, figures))
        self.values["walks"] = tuple(rows)
        # What the run itself keeps of walks, as after `simulate`.
        simulate(
            run,
            controller=settings["controllers"][0],
            steps=settings["walk_steps"],
            start="region",
            seed=settings["seed"],
            episodes=settings["walks"],
        )


def _walks(controller: str, disturbance: str, figures: WalkFigures) -> RowWalks:
    """Return a row's entry about walks."""
    return RowWalks(
        controller=controller,
        disturbance=disturbance,
        walks=len(figures.fell),
        stayed=figures.stayed,
        fewest_steps=min(figures.steps_walked),
        speed_m_s=figures.speed_m_s,
        cost_of_transport=figures.cost_of_transport,
        peak_torque_nm=figures.peak_torque_nm,
        min_normal_force_n=figures.min_normal_force_n,
    )


def row_of(content: bytes) -> SweepRow:
    """Parse `row.json` of a task's files."""
    from neuralgaits.runs import from_json

    return build(SweepRow, from_json(content))


def _with_final_paths(name: str, content: bytes, places: dict[str, str]) -> bytes:
    """Replace paths in a JSON file of the run by those of its final place."""
    if not name.endswith(".json"):
        return content
    text = content.decode()
    for old, new in places.items():
        text = text.replace(to_json(old).strip()[1:-1], to_json(new).strip()[1:-1])
    return text.encode()
