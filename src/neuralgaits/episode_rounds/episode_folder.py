"""Episodes on disk: their settings, and one folder for each round.

episodes.json   the settings          robot.xml, plant.xml   the models
summary.json    the results           start/                 the initial run, if any
round-K/        the run of the round's policy, with its residual
round-K/walks/  summary.json and logs/*.csv of its walks
"""

import shutil
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, TypeVar

from neuralgaits.analysis.run import Run
from neuralgaits.control.measurement import SensedRobot
from neuralgaits.errors import InputError, RunError, reason
from neuralgaits.records.episode_records import (
    CONFIG_FILE,
    EPISODES_SUMMARY,
    WALKS,
    EpisodesConfig,
    FormatVersion,
)
from neuralgaits.records.record import Record
from neuralgaits.robots.mjcf.loader import robot_from_text
from neuralgaits.robots.robot_file import RobotFile
from neuralgaits.runs import from_json, write_text
from neuralgaits.runs.claim import claimed
from neuralgaits.runs.file_content import file_content
from neuralgaits.runs.latest import LATEST
from neuralgaits.runs.plain import to_json

ROBOT, PLANT = "robot.xml", "plant.xml"
FORMAT = 1
"""Version of this layout; folders of other versions are refused."""
Kind = TypeVar("Kind", bound=Record)
HOME = "episodes"
"""Name of the episodes' folder below the root of the runs."""


@dataclass(frozen=True)
class EpisodeFolder:
    """Episodes that have been started.

    Attributes:
        path: the folder.
        config: their settings.
        robot: the model.
        plant: robot that walks in simulation; None if the logs come from a real robot.
    """

    path: Path
    config: EpisodesConfig
    robot: RobotFile
    plant: SensedRobot | None

    @classmethod
    def create(
        cls,
        settings: Mapping[str, Any],
        start: Run | None,
        *,
        out: str | Path | None,
        root: Path,
    ) -> "EpisodeFolder":
        """Make a new folder; `episodes.json` is written last.

        Args:
            settings: every setting; robots as loaded objects.
            start: run to start from, or None.
            out: the folder; `root/episodes/ROBOT/<UTC time>-<seed>` if None.
            root: folder of the runs.

        Raises: RunError if `out` is taken.
        """
        robot, plant = settings["robot"], settings["plant"]
        place = None if out is None else Path(out)
        names = {"robot": robot.name, "plant": plant and plant.name}
        start_path = None if start is None else str(start.path)
        config = EpisodesConfig(**{"format": FORMAT, **settings, **names, "start": start_path})
        home, what = root / HOME, "the episodes"
        with claimed(
            place, home, robot.name, settings["seed"], what=what, config=CONFIG_FILE
        ) as path:
            write_text(path / ROBOT, robot.layout.xml)
            if plant is not None:
                write_text(path / PLANT, plant.layout.xml)
            if start is not None:
                _copy_run(start.path, path / "round-0")
            write(path / CONFIG_FILE, config)
        return cls(path, config, robot, plant)

    @classmethod
    def find(cls, place: str | Path, root: Path) -> "EpisodeFolder | None":
        """Open the episodes at `place`; `latest` means those that were started last.

        Returns: None if the place holds something else. Raises: RunError if they are damaged.
        """
        if str(place) == LATEST:
            folders = [*(root / HOME).glob(f"*/*/{CONFIG_FILE}")]
            if not folders:
                raise RunError(
                    f"expected episodes below {root / HOME}, found none: leave --resume out"
                )
            place = max(folders, key=lambda file: file.stat().st_mtime_ns).parent
        path = Path(place)
        if not (path / CONFIG_FILE).is_file():
            return None
        version = read(path / CONFIG_FILE, FormatVersion).format
        if version != FORMAT:
            raise RunError(
                f"expected episodes of format {FORMAT} in {path}, found {version!r}: begin new ones"
            )
        config = EpisodesConfig.read(path / CONFIG_FILE)
        robot = load_robot_of(path / ROBOT, config.robot)
        plant = None if config.plant is None else load_robot_of(path / PLANT, config.plant)
        return cls(path, config, robot, plant)

    def gone_on_with(self, settings: Mapping[str, Any], out: str | Path | None) -> "EpisodeFolder":
        """Return these episodes, extended to more rounds if `settings` requests more.

        Args:
            settings: settings; None where the caller gave none.
            out: must be None.

        Raises: InputError if a setting differs from the one that the episodes started with.
        """
        if out is not None:
            raise InputError(f"expected --resume without --out, found {out}: drop one of the two")
        rounds = settings["rounds"]
        for name, value in settings.items():
            own = getattr(self.config, name)
            if isinstance(value, RobotFile):
                recorded = {"robot": self.robot, "plant": self.plant}[name]
                same, value = recorded and recorded.layout.xml == value.layout.xml, value.name
            elif name == "rounds":
                same = value is None or value >= own
            else:
                same = value is None or value == own
            if not same:
                raise InputError(
                    f"expected the {name} that {self.path} was begun with, {own}, found {value}: "
                    "episodes go on with their own settings; leave it out, or begin new ones"
                )
        if rounds is None or rounds == self.config.rounds:
            return self
        config = replace(self.config, rounds=rounds)
        write(self.path / CONFIG_FILE, config)
        return replace(self, config=config)

    def round(self, number: int) -> Path:
        """Return the run folder of a round."""
        return self.path / f"round-{number}"

    def walks(self, number: int) -> Path:
        """Return the path of the summary of a round's walks."""
        return self.round(number) / WALKS / EPISODES_SUMMARY

    def logs(self, number: int) -> Path:
        """Return the folder that holds the logs of a round's walks on a plant."""
        return self.round(number) / WALKS / "logs"


def write(path: Path, value: Any) -> None:
    """Save JSON atomically: the file is written whole or not at all."""
    write_text(path, to_json(value))


def load_robot_of(path: Path, name: str) -> SensedRobot:
    """Load a robot of the episodes.

    Raises: RunError or RobotError if its file is missing or damaged.
    """
    try:
        return robot_from_text(file_content(path).decode(), name)
    except (OSError, UnicodeDecodeError) as error:
        raise RunError(
            f"expected the robot file {path}, found none to read ({reason(error)}): restore it"
        ) from None


def read(path: Path, kind: type[Kind]) -> Kind:
    """Read a record that `write` saved. Raises: RunError if it is damaged."""
    try:
        return kind.of(from_json(file_content(path)))
    except (OSError, ValueError) as error:
        raise RunError(
            f"expected JSON in {path}, found a damaged file ({reason(error)}): "
            "delete its round and resume"
        ) from None


def _copy_run(source: Path, place: Path) -> None:
    """Copy the files of a trained run, without the folders that later verbs added."""

    def folders(folder: str, names: list[str]) -> list[str]:
        return [name for name in names if (Path(folder) / name).is_dir()]

    # What a killed command copied is copied again.
    shutil.copytree(source, place, ignore=folders, dirs_exist_ok=True)
