"""The contents of a run folder, read as plain data; a missing part is None."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TypeVar

from neuralgaits.errors import RunError
from neuralgaits.records import episode_records
from neuralgaits.records.certified import PROOF, SUMMARY, CertificateRecord, ConditionVerdict
from neuralgaits.records.episode_records import EpisodesSummary, WalkedRound
from neuralgaits.records.fitted import FitSummary
from neuralgaits.records.inspected import RobotFacts
from neuralgaits.records.record import Record
from neuralgaits.records.report_walk import ShownWalk
from neuralgaits.records.simulated import WALK_SUMMARY, SimulationSummary
from neuralgaits.records.trained import EndedInNan, TrainingSummary, Violations, trained_of
from neuralgaits.records.training_config import Range, TrainingConfig, config_of
from neuralgaits.report.drawing.figure_files import FigureFiles, MissingFigure
from neuralgaits.runs import RunFolder
from neuralgaits.runs.hashes import file_hashes, other_file
from neuralgaits.runs.names import (
    FIT_SUMMARY,
    LEARNED_RESIDUAL,
    NAN,
    RESIDUAL,
    ROBOT,
    SPEC,
    START,
    TRAINING_SUMMARY,
    WEIGHTS,
)
from neuralgaits.runs.shell_words import command, learning, named

Kind = TypeVar("Kind", bound=Record)


@dataclass(frozen=True)
class ProvedOfSome:
    """Proof for a part of the commands that a gait takes.

    Attributes:
        ranges: these commands, by name; empty if they are not a range of each command.
        conditions: number of conditions that are proved on their whole regions.
        level: highest level that is proved with all below it; 0 if some condition is not.
    """

    ranges: Mapping[str, Range]
    conditions: int
    level: int


@dataclass(frozen=True)
class RunContents:
    """A run as its files describe it.

    Attributes:
        folder: folder of the run.
        config: settings of the training.
        summary: result of `train` or `refine`; None if training has not ended.
        metrics: rows of `metrics.csv`, in the order of training.
        certificate: result of `certify`, as far as the run's proof files support it.
        simulation: result of `simulate`.
        disturbance: bounds on the disturbance of dz at level 2 of the proof (m/s, N m).
        residual: result of `fit` on the logs of this run.
        walks: walks of this run, if it is a round of episodes.
        episodes: all rounds of these episodes.
        hashes: sha256 of the relevant files, by name.
        nan: sentence that says where the training ended in NaN; None if it did not.
        damaged: why a part could not be read, by file.
        of_some: proof for a part of the commands; None if the proof covers all, or there is none.
    """

    folder: RunFolder
    config: TrainingConfig
    summary: TrainingSummary | None
    metrics: list[dict[str, float]]
    certificate: CertificateRecord | None
    disturbance: tuple[float, ...]
    simulation: SimulationSummary | None
    residual: FitSummary | None
    walks: WalkedRound | None
    episodes: EpisodesSummary | None
    hashes: dict[str, str]
    nan: str | None
    damaged: dict[str, str]
    of_some: ProvedOfSome | None = None

    @property
    def name(self) -> str:
        """Return the run's folder as commands name it."""
        return named(self.folder.path)

    @property
    def robot(self) -> str:
        """Return the name of the robot."""
        return self.config.robot

    @property
    def proved_level(self) -> int:
        """Return the highest level that is proved with all below it; 0 if level 1 is not."""
        return 0 if self.certificate is None else self.certificate.proved_level

    @property
    def confirmed_level(self) -> int:
        """Return the highest level that the proof file confirms; 0 if it confirms none.

        It is of the part of the commands that the proof is about. The level that a summary says
        was requested is not: nothing confirms it.
        """
        if self.of_some is not None:
            return self.of_some.level
        above = () if self.certificate is None else self.certificate.levels
        return max([self.proved_level, *(one.level for one in above if one.proved)])

    @property
    def conditions(self) -> Mapping[str, ConditionVerdict]:
        """Return the certificate's verdicts by condition; empty without a certificate."""
        return {} if self.certificate is None else self.certificate.conditions

    @property
    def failing(self) -> list[str]:
        """Return violated conditions: refuted ones, else those broken on samples if unproved."""
        refuted = [name for name, one in self.conditions.items() if one.verdict == "refuted"]
        broken = [] if self.proved_level or self.summary is None else list(self.summary.broken)
        return refuted or broken

    @property
    def measured(self) -> Mapping[str, Violations]:
        """Return each condition's violations on fresh samples, as training recorded them.

        Empty before training has ended, and if the record is of other files than the run's.
        """
        return {} if self.summary is None else self.summary.conditions


@dataclass(frozen=True)
class Contents:
    """Everything that a page is made from.

    Attributes:
        saved: contents of the run's files.
        robot: as `inspect` describes it.
        walk: walk of `report.shown_walk`; None if there is none.
        no_walk: why there is none, in a sentence.
        figures: figures, drawn and missing.
        assumptions: assumptions of a proof, as `check-proof` lists them.
    """

    saved: RunContents
    robot: RobotFacts
    walk: ShownWalk | None
    no_walk: str | None
    figures: list[FigureFiles | MissingFigure]
    assumptions: tuple[str, ...]


def read(
    folder: RunFolder,
    certificate: CertificateRecord | None,
    no_certificate: str | None = None,
    disturbance: tuple[float, ...] = (),
    of_some: ProvedOfSome | None = None,
) -> RunContents:
    """Read a run. A damaged part is left out, and its name is kept.

    Args:
        folder: folder of the run.
        certificate: result of `certify`, as far as the run's proof files support it.
        no_certificate: why an existing certificate does not apply to the run.
        disturbance: bounds on the disturbance at level 2 (m/s, N m).
        of_some: proof for a part of the commands.

    Raises: RunError if settings or results of the training are damaged: every page needs them.
    """
    damaged: dict[str, str] = {}

    def part(file: str, kind: type[Kind], base: Path = folder.path) -> Kind | None:
        try:
            return kind.read(base / file) if (base / file).is_file() else None
        except RunError as error:
            damaged[file] = str(error)
            return None

    above = folder.path.resolve().parent
    has_config = (above / episode_records.CONFIG_FILE).is_file()
    rounds = part(episode_records.EPISODES_SUMMARY, EpisodesSummary, above) if has_config else None
    files = file_hashes(folder.path, (WEIGHTS, ROBOT, SPEC, RESIDUAL, START, PROOF))
    hashes = {file: digest for file, digest in files.items() if digest is not None}
    if no_certificate is not None:
        again = f"prove it again with `{command('certify', named(folder.path))}`"
        file = PROOF if no_certificate.startswith(PROOF) else SUMMARY
        damaged[file] = f"{no_certificate}: {again}"
    learned, simulation = part(FIT_SUMMARY, FitSummary), part(WALK_SUMMARY, SimulationSummary)
    outdated = _outdated(folder, learned, simulation, hashes)
    damaged |= outdated
    summary = trained_of(folder.path) if folder.finished else None
    if summary is not None and summary.left_out is not None:
        damaged[TRAINING_SUMMARY] = summary.left_out
    return RunContents(
        folder=folder,
        config=config_of(folder),
        summary=summary,
        metrics=_metrics(folder, damaged),
        certificate=certificate,
        disturbance=disturbance,
        simulation=None if WALK_SUMMARY in outdated else simulation,
        residual=None if FIT_SUMMARY in outdated else learned,
        walks=part(f"{episode_records.WALKS}/{episode_records.EPISODES_SUMMARY}", WalkedRound),
        episodes=rounds,
        hashes=hashes,
        nan=_nan(part(NAN, EndedInNan)) if folder.ended_in_nan else None,
        damaged=damaged,
        of_some=of_some,
    )


def _metrics(folder: RunFolder, damaged: dict[str, str]) -> list[dict[str, float]]:
    """Return the rows of the training's metrics; none if the file is damaged, which is noted."""
    try:
        return folder.read_metrics()
    except RunError as error:
        damaged["metrics.csv"] = str(error)
        return []


def _outdated(
    folder: RunFolder,
    learned: FitSummary | None,
    simulation: SimulationSummary | None,
    hashes: Mapping[str, str],
) -> dict[str, str]:
    """Return the parts that are about other files than the run's, with what to do."""
    reasons: dict[str, str] = {}
    if learned is not None:
        about = dict(learned.sha256)
        if learned.residual_sha256 is not None:
            about[LEARNED_RESIDUAL] = learned.residual_sha256
        other = other_file(folder.path, about, (LEARNED_RESIDUAL, ROBOT, WEIGHTS))
        if other is not None:
            reasons[FIT_SUMMARY] = (
                f"{FIT_SUMMARY} is about another {Path(other).name} than the run's: learn it again "
                f"with `{learning(folder.path)}`"
            )
    hashes_of_walk = {} if simulation is None else simulation.sha256
    other = next(
        (file for file, digest in hashes_of_walk.items() if digest != hashes.get(file)), None
    )
    if other is not None:
        again = command("simulate", named(folder.path))
        reasons[WALK_SUMMARY] = (
            f"{WALK_SUMMARY} is about another {other} than the run's: walk with `{again}`"
        )
    return reasons


def _nan(ending: EndedInNan | None) -> str:
    """Return a sentence that says where a training ended in NaN, as far as that is recorded."""
    if ending is None:
        return "The training ended in NaN: its loss or its weights were no longer finite."
    names = ", ".join(ending.conditions) or "no condition alone: the sum, or its gradient"
    return (
        f"The training ended in NaN at step {ending.step}: its loss or its weights were no "
        f"longer finite (conditions: {names})."
    )
