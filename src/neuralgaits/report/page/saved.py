"""What a run folder holds, read as plain data; a part that is not there is None."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TypeVar

from neuralgaits.errors import RunError
from neuralgaits.records import episode_records
from neuralgaits.records.certified import PROOF, SUMMARY, CertificateRecord, ConditionVerdict
from neuralgaits.records.episode_records import EpisodesDone, WalkedRound
from neuralgaits.records.fitted import Fitted
from neuralgaits.records.inspected import RobotFacts
from neuralgaits.records.record import Record
from neuralgaits.records.report_walk import ShownWalk
from neuralgaits.records.simulated import SUMMARY as WALK
from neuralgaits.records.simulated import Simulated
from neuralgaits.records.trained import EndedInNan, Trained, Violations, trained_of
from neuralgaits.records.training_config import Range, TrainingConfig, asked_of
from neuralgaits.report.drawing.drawn import Drawn, Missing
from neuralgaits.runs import RunFolder
from neuralgaits.runs.folder import file_hashes
from neuralgaits.runs.names import FIT as LEARNING
from neuralgaits.runs.names import FITTED, NAN, RESIDUAL, ROBOT, SPEC, START, WEIGHTS
from neuralgaits.runs.shell_words import command, learning, named

Kind = TypeVar("Kind", bound=Record)
_HASHED = (
    WEIGHTS,
    ROBOT,
    SPEC,
    RESIDUAL,
    START,
    PROOF,
)


@dataclass(frozen=True)
class ProvedOfSome:
    """What is proved of some of the commands that a gait takes.

    Attributes:
        ranges: these commands, by name; empty where they are no ranges of each.
        conditions: how many are proved on all of their regions.
        level: up to which all is proved; 0 if some condition is not.
    """

    ranges: Mapping[str, Range]
    conditions: int
    level: int


@dataclass(frozen=True)
class Saved:
    """A run as its files say.

    Attributes:
        folder: of the run.
        asked: of the training.
        summary: what `train` or `refine` found; None if training has not ended.
        metrics: rows of the training's course.
        certificate: what `certify` found, as the run's proof files bear it out.
        simulation: what `simulate` found.
        disturbance: what may be added to dz at level 2 of the proof (m/s, N m).
        residual: what `fit` learned from the logs of this run.
        walks: of this run as a round of episodes.
        episodes: all rounds of them.
        hashes: sha256 of the files that count, by name.
        nan: that the training ended in NaN, and where, in a sentence; None if it did not.
        damaged: why a part could not be read, by file.
        of_some: what is proved of some commands; None if the proof is about all, or there is none.
    """

    folder: RunFolder
    asked: TrainingConfig
    summary: Trained | None
    metrics: list[dict[str, float]]
    certificate: CertificateRecord | None
    disturbance: tuple[float, ...]
    simulation: Simulated | None
    residual: Fitted | None
    walks: WalkedRound | None
    episodes: EpisodesDone | None
    hashes: dict[str, str]
    nan: str | None
    damaged: dict[str, str]
    of_some: ProvedOfSome | None = None

    @property
    def name(self) -> str:
        """The run as commands name it."""
        return named(self.folder.path)

    @property
    def robot(self) -> str:
        """Name of the robot."""
        return self.asked.robot

    @property
    def proved_level(self) -> int:
        """The highest level that is proved with all below it; 0 if not even the first."""
        return 0 if self.certificate is None else self.certificate.proved_level

    @property
    def conditions(self) -> Mapping[str, ConditionVerdict]:
        """The certificate's verdicts; none without one."""
        return {} if self.certificate is None else self.certificate.conditions

    @property
    def failing(self) -> list[str]:
        """Conditions that some state breaks: refuted, or broken on samples and not proved."""
        refuted = [name for name, one in self.conditions.items() if one.verdict == "refuted"]
        broken = [] if self.proved_level or self.summary is None else list(self.summary.broken)
        return refuted or broken

    @property
    def measured(self) -> Mapping[str, Violations]:
        """What fresh samples say of each condition; nothing before the training has ended."""
        return {} if self.summary is None else self.summary.conditions


@dataclass(frozen=True)
class Contents:
    """All that a page is made from.

    Attributes:
        saved: files of the run.
        robot: as `inspect` describes it.
        walk: of `report.shown_walk`; None if there is none.
        no_walk: why there is none, in a sentence.
        figures: drawn and missing.
        assumptions: of a proof, as `check-proof` lists them.
    """

    saved: Saved
    robot: RobotFacts
    walk: ShownWalk | None
    no_walk: str | None
    figures: list[Drawn | Missing]
    assumptions: tuple[str, ...]


def read(
    folder: RunFolder,
    certificate: CertificateRecord | None,
    no_certificate: str | None = None,
    disturbance: tuple[float, ...] = (),
    of_some: ProvedOfSome | None = None,
) -> Saved:
    """Read a run. A damaged part is left out and named.

    Args:
        folder: of the run.
        certificate: what `certify` found, as the run's proof files bear it out.
        no_certificate: why a certificate that is there says nothing of the run.
        disturbance: of level 2.
        of_some: what is proved of some commands.

    Raises: RunError if what was asked or found in training is damaged: pages are about these.
    """
    damaged: dict[str, str] = {}

    def part(file: str, kind: type[Kind], base: Path = folder.path) -> Kind | None:
        try:
            return kind.read(base / file) if (base / file).is_file() else None
        except RunError as error:
            damaged[file] = str(error)
            return None

    try:
        metrics = folder.read_metrics()
    except RunError as error:
        metrics, damaged["metrics.csv"] = [], str(error)
    above = folder.path.resolve().parent
    begun = (above / episode_records.ASKED).is_file()
    rounds = part(episode_records.SUMMARY, EpisodesDone, above) if begun else None
    found = file_hashes(folder.path, _HASHED)
    hashes = {file: digest for file, digest in found.items() if digest is not None}
    if no_certificate is not None:
        again = f"prove it again with `{command('certify', named(folder.path))}`"
        damaged[SUMMARY] = f"{no_certificate}: {again}"
    learned, simulation = part(LEARNING, Fitted), part(WALK, Simulated)
    if learned is not None and learned.residual_sha256 not in (None, *_learned(folder)):
        learned = None
        damaged[LEARNING] = (
            f"{LEARNING} is about another residual.safetensors than the run's: learn it again with "
            f"`{learning(folder.path)}`"
        )
    for file, digest in ({} if simulation is None else simulation.sha256).items():
        if digest != hashes.get(file):
            again = command("simulate", named(folder.path))
            simulation = None
            damaged[WALK] = f"{WALK} is about another {file} than the run's: walk with `{again}`"
            break
    return Saved(
        folder=folder,
        asked=asked_of(folder),
        summary=trained_of(folder.path) if folder.finished else None,
        metrics=metrics,
        certificate=certificate,
        disturbance=disturbance,
        simulation=simulation,
        residual=learned,
        walks=part(f"{episode_records.WALKS}/{episode_records.SUMMARY}", WalkedRound),
        episodes=rounds,
        hashes=hashes,
        nan=_nan(part(NAN, EndedInNan)) if folder.ended_in_nan else None,
        damaged=damaged,
        of_some=of_some,
    )


def _learned(folder: RunFolder) -> Iterable[str | None]:
    """The sha256 of what `fit` learned."""
    return file_hashes(folder.path, (FITTED,)).values()


def _nan(found: EndedInNan | None) -> str:
    """Where a training ended in NaN, as far as it is known."""
    if found is None:
        return "The training ended in NaN: its loss or its weights were no longer finite."
    names = ", ".join(found.conditions) or "no condition alone: the sum, or its gradient"
    return (
        f"The training ended in NaN at step {found.step}: its loss or its weights were no "
        f"longer finite (conditions: {names})."
    )
