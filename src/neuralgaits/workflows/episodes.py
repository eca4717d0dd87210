"""Episodes: walk, learn what the model misses, refine the policy, and walk again.

Round 0 is the policy trained on the model alone. Every step of a round leaves a file, and a step
whose file is there is not done again, so what was interrupted goes on where it stopped.
"""

import shutil
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from neuralgaits._settings import check_rounds, check_seed
from neuralgaits.analysis.run import Run, open_run
from neuralgaits.errors import InputError, Interrupted, NonFiniteError
from neuralgaits.logs import read_all
from neuralgaits.report.rounds import draw_file
from neuralgaits.report.shapes import ERRORS, WALKED
from neuralgaits.robots import PlanarBiped, load_robot
from neuralgaits.rounds.folder import SUMMARY, EpisodeFolder, read, write
from neuralgaits.rounds.walks import Field, logged_round, nominal_momentum, walk_round
from neuralgaits.runs import RUNS_ROOT, plain
from neuralgaits.runs.commands import command, named
from neuralgaits.runs.folder import CONFIG
from neuralgaits.runs.names import FIT
from neuralgaits.simulation.disturbance import Disturbance, parse
from neuralgaits.simulation.walk import law_named
from neuralgaits.training.gradient_steps import Progress
from neuralgaits.workflows.fit import fit
from neuralgaits.workflows.refine import refine
from neuralgaits.workflows.train import train

FIGURE = "episodes.png"
ENOUGH = 0.9
"""Share of walks that must stay up for a policy to be said to walk."""
Tell = Callable[[int, str], None]
"""(round, what begins)."""


@dataclass(frozen=True)
class Episodes:
    """What became of the rounds.

    Attributes:
        path: folder with everything.
        run: of the last policy.
        summary: what `episodes --json` prints.
    """

    path: Path
    run: Run
    summary: dict[str, Any]

    @property
    def walks(self) -> bool | None:
        """Whether the last policy walks; None if only the robot's own logs tell."""
        if self.summary["diverged"] is not None:
            return False
        share = self.summary["rounds"][-1]["share_that_walks"]
        return None if share is None else share >= ENOUGH


def episodes(
    robot: PlanarBiped | None = None,
    *,
    plant: PlanarBiped | str | Path | None = None,
    disturb: str | Mapping[str, float] | Disturbance | None = None,
    controller: str | None = None,
    logs: str | Path | None = None,
    rounds: int | None = None,
    seed: int | None = None,
    resume: str | Path | None = None,
    out: str | Path | None = None,
    steps: int | None = None,
    progress: Progress | None = None,
    tell: Tell | None = None,
    root: Path = RUNS_ROOT,
) -> Episodes:
    """Train on the model, then learn and refine for some rounds.

    Args:
        robot: the model; with `resume` it need not be given, what goes on has its own.
        plant: robot that walks, in simulation.
        disturb: of the plant, see `simulation.disturbance`.
        controller: `pd` (if None) or `fblin`, with the nominal model.
        logs: folder of a real robot's logs in place of a plant: `round-0/*.csv`, and so on. The
            rounds stop where the next logs are missing, and go on once they are there.
        rounds: of learning and refining; 2 if None.
        seed: of everything random; 0 if None.
        resume: episodes to go on with (their folder, or `latest`) under their own settings, or a
            trained run to begin with.
        out: folder to make; `runs/episodes/ROBOT/<UTC time>-<seed>` if None.
        steps: gradient steps of training and of each refinement; the recipe's if None.
        progress: called with (step, steps, loss) now and then.
        tell: called when a step of a round begins.
        root: folder of the runs.

    Raises: InputError or RunError with one line; Interrupted for KeyboardInterrupt.
    """
    began = time.perf_counter()
    check_rounds(rounds)
    asked = {
        "robot": robot,
        "plant": load_robot(plant) if isinstance(plant, str | Path) else plant,
        "disturb": None if disturb is None else plain(vars(parse(disturb))),
        "controller": controller,
        "logs": None if logs is None else str(Path(logs).absolute()),
        "rounds": rounds,
        "seed": seed,
        "steps": steps,
    }
    old = None if resume is None else EpisodeFolder.find(resume, root)
    if old is None:
        folder = _begin(asked, resume, out=out, root=root)
    else:
        folder = old.gone_on_with(asked, out)
    session = _Session(folder, progress, tell or (lambda number, what: None), root)
    try:
        entries, run, stopped = session.run()
    except KeyboardInterrupt as stop:
        raise Interrupted(command("episodes", "--resume", named(folder.path))) from stop
    summary = {name: folder.config[name] for name in ("robot", "plant", "disturb", "controller")}
    summary |= {"logs": folder.config["logs"], "seed": folder.config["seed"]}
    summary |= {"episodes": str(folder.path), "run": str(run.path), "rounds": entries}
    summary |= {**stopped, "figure": str(folder.path / FIGURE)}
    summary = plain(summary | {"wall_s": time.perf_counter() - began})
    write(folder.path / SUMMARY, summary)
    draw_file(folder.path / SUMMARY, folder.path / FIGURE)
    return Episodes(folder.path, run, summary)


def _begin(
    asked: dict[str, Any], resume: str | Path | None, *, out: str | Path | None, root: Path
) -> EpisodeFolder:
    """Check what is asked, and make the folder."""
    usual: dict[str, Any] = {
        "disturb": plain(vars(Disturbance())),
        "controller": "pd",
        "rounds": 2,
        "seed": 0,
    }
    given = {name: value for name, value in asked.items() if value is not None}
    config: dict[str, Any] = dict.fromkeys(asked) | usual | given
    law_named(config["controller"])
    check_seed(config["seed"])
    plant, logs = asked["plant"], asked["logs"]
    if (plant is None) == (logs is None):
        found = "neither" if plant is None else "both"
        raise InputError(
            f"expected either a plant or a folder of logs, found {found}: give --plant ROBOT to "
            "walk in simulation, or --logs DIR with a robot's own logs"
        )
    if logs is not None:
        if resume is None:
            raise InputError(
                "expected the run whose policy walked the logs, found none: name it with "
                "--resume RUN"
            )
        if asked["disturb"] is not None:
            raise InputError("expected --disturb with a plant, found it with --logs: drop it")
        logs_of(Path(logs), 0)
    start = None if resume is None else _start(resume, asked["robot"])
    if asked["robot"] is None:
        if start is None:
            raise InputError(
                "expected ROBOT, found none: name the model, or what to go on with by --resume RUN"
            )
        config["robot"] = start.robot
    if logs is not None:
        # Logs that cannot be read leave no episodes behind.
        read_all(logs_of(Path(logs), 0), config["robot"])
    return EpisodeFolder.create(config, start, out=out, root=root)


def _start(run: str | Path, robot: PlanarBiped | None) -> Run:
    start = open_run(run)
    if robot is not None and start.robot.layout.xml != robot.layout.xml:
        raise InputError(
            f"expected a run of robot {robot.name}, found one of {start.robot.name} in "
            f"{start.path}: name its robot"
        )
    return start


def logs_of(logs: Path, number: int) -> list[Path]:
    """Logs of a round. Raises: InputError if there are none."""
    place = logs / f"round-{number}"
    if number == 0 and not place.is_dir():
        place = logs
    files = sorted(place.glob("*.csv"))
    if not files:
        found = "none" if place.is_dir() else "no such folder"
        raise InputError(f"expected logs *.csv in {place}, found {found}: put the robot's there")
    return files


@dataclass(frozen=True)
class _Session:
    """The rounds of one folder."""

    folder: EpisodeFolder
    progress: Progress | None
    tell: Tell
    root: Path

    def run(self) -> tuple[list[dict[str, Any]], Run, dict[str, str | None]]:
        """Go through all rounds. Returns: entries, the last run, and why the rounds stopped."""
        entries: list[dict[str, Any]] = []
        run, momentum = self._policy(0, None), None
        for number in range(self.folder.config["rounds"] + 1):
            try:
                run = run if number == 0 else self._policy(number, run)
            except NonFiniteError as error:
                # The answer is no: what was learned does not allow a gait nearby.
                return entries, run, {"waiting_for": None, "diverged": str(error)}
            if momentum is None and self.folder.plant is not None:
                momentum = nominal_momentum(run)
            missing = self._missing_logs(number)
            if missing is not None:
                return entries, run, {"waiting_for": missing, "diverged": None}
            walked = self._walk(number, run, momentum)
            learned = self._learn(number, run, walked)
            entries.append(_entry(number, run, walked, learned))
        return entries, run, {"waiting_for": None, "diverged": None}

    def _missing_logs(self, number: int) -> str | None:
        logs = self.folder.config["logs"]
        if logs is None:
            return None
        try:
            logs_of(Path(logs), number)
        except InputError:
            return str(Path(logs) / f"round-{number}")
        return None

    def _policy(self, number: int, before: Run | None) -> Run:
        """The policy of a round: trained, refined, or what a killed command left of it."""
        place, config = self.folder.round(number), self.folder.config
        if (place / SUMMARY).is_file():
            return open_run(place)
        robot, steps, seed = self.folder.robot, config["steps"], config["seed"]
        if (place / CONFIG).is_file():
            self.tell(number, "training on")
            return train(robot, resume=place, progress=self.progress, root=self.root)
        # Copies of a command that was killed before its config was written.
        shutil.rmtree(place, ignore_errors=True)
        settings: dict[str, Any] = {"seed": seed, "steps": steps, "out": place}
        settings |= {"progress": self.progress, "root": self.root}
        if before is None:
            self.tell(number, "training on the model")
            return train(robot, **settings)
        self.tell(number, "refining")
        return refine(before, **settings)

    def _walk(self, number: int, run: Run, momentum: float | None) -> dict[str, Any]:
        file = self.folder.walks(number)
        if file.is_file():
            return read(file, WALKED)
        config, plant = self.folder.config, self.folder.plant
        self.tell(number, "walking" if plant is not None else "reading logs")
        if plant is None or momentum is None:
            found = logged_round(run, logs_of(Path(config["logs"]), number))
        else:
            field = Field(plant, Disturbance(**config["disturb"]), config["controller"])
            found = walk_round(
                run, field, momentum=momentum, seed=config["seed"], folder=self.folder.logs(number)
            )
            if found["engine_note"] is not None:
                self.tell(number, found["engine_note"])
        write(file, found)
        return found

    def _learn(self, number: int, run: Run, walked: dict[str, Any]) -> dict[str, Any]:
        summary = run.path / FIT
        if summary.is_file():
            return read(summary, ERRORS)
        self.tell(number, "learning")
        last = number == self.folder.config["rounds"]
        files = [Path(file) for file in walked["logs"]]
        if self.folder.plant is not None:
            # The folder may have been moved, or the command be given from elsewhere.
            files = [self.folder.logs(number) / file.name for file in files]
        try:
            return fit(run, files, seed=self.folder.config["seed"]).summary
        except InputError as error:
            # Nothing is refined after the last round: its errors are a report.
            if not last:
                raise
            return {"reason": str(error)}


def _entry(
    number: int, run: Run, walked: dict[str, Any], learned: dict[str, Any]
) -> dict[str, Any]:
    """What the table has of a round."""
    told = ("heldout_error", "nominal_heldout_error", "binned_floor", "touchdowns", "error_bound")
    return {
        "round": number,
        "run": str(run.path),
        "loss": run.summary["loss"],
        **{name: value for name, value in walked.items() if name not in ("logs", "wall_s")},
        **{name: learned.get(name) for name in told},
        "reason": learned.get("reason"),
        "wall_s": {
            "train": run.summary["wall_s"],
            "walk": walked["wall_s"],
            "fit": learned.get("wall_s"),
        },
    }
