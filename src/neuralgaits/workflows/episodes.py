"""Episodes: walk, learn the model's error, refine the policy, and walk again.

Round 0 is the policy trained on the model alone. Every stage of a round leaves a file, and a stage
whose file exists is not repeated, so interrupted episodes resume where they stopped.
"""

import shutil
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

from neuralgaits._checks import check_seed
from neuralgaits._printable import printable
from neuralgaits.analysis.run import Run, open_run
from neuralgaits.control.law_by_name import law_named
from neuralgaits.episode_rounds.episode_folder import EpisodeFolder, read, write
from neuralgaits.episode_rounds.round_walks import (
    Field,
    logged_round,
    logs_of,
    nominal_momentum,
    walk_round,
)
from neuralgaits.errors import InputError, Interrupted, NonFiniteError
from neuralgaits.logs import read_all
from neuralgaits.records.episode_records import (
    EPISODES_SUMMARY,
    EpisodesSummary,
    Round,
    WalkedRound,
)
from neuralgaits.records.fitted import FitSummary
from neuralgaits.report.figures.rounds import draw_file
from neuralgaits.robots.mjcf.loader import robot_from_text
from neuralgaits.runs import plain
from neuralgaits.runs.atomic import refuse_unwritable
from neuralgaits.runs.names import CONFIG, FIT_SUMMARY
from neuralgaits.runs.shell_words import command, named
from neuralgaits.settings import EpisodesSettings, called_with
from neuralgaits.simulation.setup.disturbance import PlantChanges, parse
from neuralgaits.training.training_loop import Progress
from neuralgaits.workflows.fit import fit
from neuralgaits.workflows.planarise import robot_from
from neuralgaits.workflows.refine import refine
from neuralgaits.workflows.train import train

Tell = Callable[[int, str], None]
"""Callback that gets the round and the stage that begins."""


class StopReason(NamedTuple):
    """Reason why the rounds stopped before the last one, if they did."""

    waiting_for: str | None = None
    """Folder of the logs that are missing."""
    diverged: str | None = None
    """Message of a training that diverged."""


@dataclass(frozen=True)
class Episodes:
    """Result of the rounds.

    Attributes:
        path: folder with everything.
        run: run of the last policy.
        summary: what `episodes --json` prints.
    """

    path: Path
    run: Run
    summary: EpisodesSummary

    @property
    def walks(self) -> bool | None:
        """Return whether the last policy walks; None if only the robot's own logs could tell."""
        if self.summary.diverged is not None:
            return False
        share = self.summary.rounds[-1].share_that_walks
        least = 0.9  # Share of walks that stay up under a policy that counts as walking.
        return None if share is None else share >= least


@called_with(EpisodesSettings)
def episodes(settings: EpisodesSettings) -> Episodes:
    """Train on the model, then learn and refine for some rounds.

    Raises: InputError or RunError with one line; Interrupted for KeyboardInterrupt.
    """
    start_time = time.perf_counter()
    config = _config_of(settings)
    resume = settings.resume
    root = settings.root
    old = None if resume is None else EpisodeFolder.find(resume, root)
    if old is None:
        folder = _begin(config, resume, out=settings.out, root=root)
    else:
        folder = old.gone_on_with(config, settings.out)
    figure_file = "episodes.png"
    refuse_unwritable(folder.path / EPISODES_SUMMARY, folder.path / figure_file, own=True)
    tell = settings.tell or (lambda number, what: None)
    session = _Session(folder, settings.progress, tell, root)
    try:
        entries, run, stopped = session.run()
    except KeyboardInterrupt as stop:
        raise Interrupted(command("episodes", "--resume", named(folder.path))) from stop
    names = ("robot", "plant", "disturb", "controller", "logs", "seed")
    summary = EpisodesSummary(
        **{name: getattr(folder.config, name) for name in names},
        episodes=str(folder.path),
        run=str(run.path),
        rounds=tuple(entries),
        waiting_for=stopped.waiting_for,
        diverged=stopped.diverged,
        figure=str(folder.path / figure_file),
        wall_s=time.perf_counter() - start_time,
    )
    write(folder.path / EPISODES_SUMMARY, summary)
    draw_file(summary, folder.path / figure_file)
    return Episodes(folder.path, run, summary)


def _config_of(settings: EpisodesSettings) -> dict[str, Any]:
    """Return the settings that the folder's config records; None for what was not given."""
    disturb = settings.disturb
    logs = settings.logs
    columns = settings.columns
    return {
        "robot": None if settings.robot is None else robot_from(settings.robot),
        "plant": None if settings.plant is None else robot_from(settings.plant),
        "disturb": None if disturb is None else plain(vars(parse(disturb))),
        "controller": settings.controller,
        "logs": None if logs is None else str(Path(logs).absolute()),
        "columns": None if columns is None else str(Path(columns).absolute()),
        "rounds": settings.rounds,
        "seed": settings.seed,
        "steps": settings.steps,
    }


def _begin(
    settings: dict[str, Any], resume: str | Path | None, *, out: str | Path | None, root: Path
) -> EpisodeFolder:
    """Check the settings, and make the folder."""
    usual: dict[str, Any] = {
        "disturb": plain(vars(PlantChanges())),
        "controller": "pd",
        "rounds": 2,
        "seed": 0,
    }
    changes = {name: value for name, value in settings.items() if value is not None}
    config: dict[str, Any] = dict.fromkeys(settings) | usual | changes
    law_named(config["controller"])
    check_seed(config["seed"])
    plant, logs = settings["plant"], settings["logs"]
    if (plant is None) == (logs is None):
        number_given = "neither" if plant is None else "both"
        raise InputError(
            f"expected either a plant or a folder of logs, found {number_given}: give --plant "
            "ROBOT to walk in simulation, or --logs DIR with a robot's own logs"
        )
    for path in filter(None, (logs, settings["columns"])):
        if printable(path) != path:
            raise InputError(
                f"expected logs and columns whose path is UTF-8, found {printable(path)}: rename "
                "what is not; episodes are gone on with by that path"
            )
    if settings["columns"] is not None and logs is None:
        raise InputError("expected --columns with --logs, found it with a plant: drop it")
    if logs is not None:
        if resume is None:
            raise InputError(
                "expected the run whose policy walked the logs, found none: name it with "
                "--resume RUN"
            )
        if settings["disturb"] is not None:
            raise InputError("expected --disturb with a plant, found it with --logs: drop it")
        logs_of(Path(logs), 0)
    start, robot = None if resume is None else open_run(resume), settings["robot"]
    if start is not None and robot is not None and start.robot.layout.xml != robot.layout.xml:
        raise InputError(
            f"expected a run of robot {robot.name}, found one of {start.robot.name} in "
            f"{start.path}: name its robot"
        )
    if robot is None:
        if start is None:
            raise InputError(
                "expected ROBOT, found none: name the model, or what to go on with by --resume RUN"
            )
        config["robot"] = start.robot
    if logs is not None and start is not None:
        # Logs that cannot be read leave no episodes behind.
        read_all(
            logs_of(Path(logs), 0),
            config["robot"],
            columns=settings["columns"],
            policy=start.gait.policy,
        )
    return EpisodeFolder.create(config, start, out=out, root=root)


@dataclass(frozen=True)
class _Session:
    """Runner for the rounds of one folder."""

    folder: EpisodeFolder
    progress: Progress | None
    tell: Tell
    root: Path

    def run(self) -> tuple[list[Round], Run, StopReason]:
        """Carry out all rounds. Returns: entries, the last run, and why the rounds stopped."""
        entries: list[Round] = []
        run, momentum = self._policy(0, None), None
        for number in range(self.folder.config.rounds + 1):
            try:
                run = run if number == 0 else self._policy(number, run)
            except NonFiniteError as error:
                # The answer is no: what was learned does not allow a gait nearby.
                return entries, run, StopReason(diverged=str(error))
            if momentum is None and self.folder.plant is not None:
                momentum = nominal_momentum(run)
            missing = self._missing_logs(number)
            if missing is not None:
                return entries, run, StopReason(waiting_for=missing)
            walks = self._walk(number, run, momentum)
            learned = self._learn(number, run, walks)
            entries.append(Round.of_parts(number, str(run.path), run.summary, walks, learned))
        return entries, run, StopReason()

    def _missing_logs(self, number: int) -> str | None:
        logs = self.folder.config.logs
        if logs is None:
            return None
        try:
            logs_of(Path(logs), number)
        except InputError:
            return str(Path(logs) / f"round-{number}")
        return None

    def _policy(self, number: int, before: Run | None) -> Run:
        """Return the policy of a round: trained, refined, or resumed after a killed command."""
        place, config = self.folder.round(number), self.folder.config
        if (place / EPISODES_SUMMARY).is_file():
            return open_run(place)
        robot = robot_from_text(self.folder.robot.layout.xml, self.folder.robot.name)
        if (place / CONFIG).is_file():
            self.tell(number, "training on")
            return train(robot, resume=place, progress=self.progress, root=self.root)
        # Copies of a command that was killed before its config was written.
        shutil.rmtree(place, ignore_errors=True)
        settings: dict[str, Any] = {"seed": config.seed, "steps": config.steps, "out": place}
        settings |= {"progress": self.progress, "root": self.root}
        if before is None:
            self.tell(number, "training on the model")
            return train(robot, **settings)
        self.tell(number, "refining")
        return refine(before, **settings)

    def _walk(self, number: int, run: Run, momentum: float | None) -> WalkedRound:
        file = self.folder.walks(number)
        if file.is_file():
            return read(file, WalkedRound)
        config, plant = self.folder.config, self.folder.plant
        self.tell(number, "walking" if plant is not None else "reading logs")
        if plant is None or momentum is None:
            assert config.logs is not None  # There is a plant, or there are logs.
            walks = logged_round(run, logs_of(Path(config.logs), number), config.columns)
        else:
            field = Field(plant, PlantChanges(**(config.disturb or {})), config.controller)
            walks = walk_round(
                run, field, momentum=momentum, seed=config.seed, folder=self.folder.logs(number)
            )
            if walks.engine_note is not None:
                self.tell(number, walks.engine_note)
        write(file, walks)
        return walks

    def _learn(self, number: int, run: Run, walks: WalkedRound) -> FitSummary | str:
        """Return the learned residual's summary, or the reason why nothing was learned."""
        summary = run.path / FIT_SUMMARY
        if summary.is_file():
            return read(summary, FitSummary)
        self.tell(number, "learning")
        last = number == self.folder.config.rounds
        files = [Path(file) for file in walks.logs]
        if self.folder.plant is not None:
            # The folder may have been moved, or the command be given from elsewhere.
            files = [self.folder.logs(number) / file.name for file in files]
        try:
            config = self.folder.config
            return fit(run, files, columns=config.columns, seed=config.seed).summary
        except InputError as error:
            # Nothing is refined after the last round: its errors are a report.
            if not last:
                raise
            return str(error)
