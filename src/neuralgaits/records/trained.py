"""Result of `train` and `refine`: `summary.json` of a run, `nan.json` of one that failed.

The result of `train --seeds` is `seeds.json` of the folder that holds the runs.
"""

from collections.abc import Collection, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path

from neuralgaits._printable import printable
from neuralgaits.errors import RunError
from neuralgaits.records.record import Count, Pair, Record, Texts
from neuralgaits.records.training_config import Range, Seed
from neuralgaits.runs.hashes import file_hashes
from neuralgaits.runs.names import RESIDUAL, ROBOT, SPEC, TRAINING_SUMMARY, WEIGHTS
from neuralgaits.runs.shell_words import command, named, resuming


@dataclass(frozen=True)
class Violations:
    """Violations of a condition on fresh samples, in its scales, like every margin that is shown.

    Attributes:
        mean_violation, max_violation: mean and largest violation of margin >= 0 (scales).
        min_margin: smallest margin of the samples (scales).
        scale: size of one scale, in the condition's own unit.
    """

    mean_violation: float
    max_violation: float
    min_margin: float
    scale: float

    @property
    def broken(self) -> bool:
        """Whether some sample violates the condition."""
        return self.max_violation > 0.0


@dataclass(frozen=True)
class TrainingProof:
    """Last certificate of a training that includes proofs.

    Attributes:
        verdict: verdict on level 1.
        level: always 1.
        repairs, repair_steps: number of further trainings, and of their gradient steps in all.
        smallest_margin: smallest proved margin, in scales; None if a condition is not proved.
        open_boxes: number of boxes on which some condition is not proved.
        failing: number of open boxes by condition.
        wall_s: elapsed time of proofs and repairs.
    """

    verdict: str
    level: int
    repairs: int
    repair_steps: int
    smallest_margin: float | None
    open_boxes: int
    failing: Mapping[str, int]
    wall_s: float

    @property
    def proved(self) -> bool:
        """Whether every condition is proved at level 1."""
        return self.verdict == "proved"


@dataclass(frozen=True)
class ProofRound:
    """Result of one certificate of a training.

    Attributes:
        number: number of repairs before it.
        steps: number of gradient steps before it.
        verdict: verdict of the certificate.
        open_boxes: number of boxes on which some condition is not proved.
        failing: number of open boxes by condition.
        smallest_margin: smallest proved margin, in scales; None if a condition is not proved.
        wall_s: elapsed time of the certificate.
    """

    number: Count
    steps: Count
    verdict: str
    open_boxes: Count
    failing: Mapping[str, int]
    smallest_margin: float | None
    wall_s: float


@dataclass(frozen=True, eq=False)
class ProofHistory(Record):
    """Certificates of a training so far: `rounds.json`."""

    rounds: tuple[ProofRound, ...]


@dataclass(frozen=True, eq=False, kw_only=True)
class TrainingSummary(Record):
    """Result of a training.

    Attributes:
        run, robot, spec, seed: run folder, and its settings.
        steps: gradient steps taken, those of repairs included.
        loss: loss on fresh samples; None if it is not finite.
        conditions: violations on fresh samples, by condition.
        provable: whether there is a Program of the spec's conditions.
        program_hash: hash of the Program.
        after_impact: largest errors that the real impact leaves in outputs, their rates and
            the foot's height (units in the names).
        certificate: last certificate; None if no proof was requested.
        commands: ranges of the commands that the gait takes at each touchdown, by name.
        aims: violations of the training's aims on fresh samples, by aim.
        orbit_speeds_m_s: mean speeds of the orbits at both ends of the range of `speed`, other
            commands in the middle of theirs; None without that command, or without an orbit.
        speed_m_s, cost_of_transport, multiplier: mean speed, mechanical cost of transport on the
            zero dynamics [1] and slope of the Poincaré map of the orbit, for a gait that was not
            trained.
        step_size: last step size, as a share of that of the recipe. It is below 1 if gradient steps
            turned to NaN and smaller ones continued from the best weights before that.
        sha256: hashes of the files that the figures were measured on, by file; empty in runs of
            earlier versions.
        left_out: why the figures are left out, which are of other files than the run's; None if
            they are not.
        compile_s, train_s, wall_s: durations; for seeds trained as one program, those of all seeds.
    """

    run: str = ""
    robot: str = ""
    spec: str = ""
    seed: int = 0
    steps: Count
    loss: float | None
    conditions: Mapping[str, Violations]
    provable: bool = True
    program_hash: str | None = None
    after_impact: Mapping[str, float] | None = None
    certificate: TrainingProof | None = None
    commands: Mapping[str, Range] = field(default_factory=dict)
    aims: Mapping[str, Violations] = field(default_factory=dict)
    orbit_speeds_m_s: Pair | None = None
    speed_m_s: float | None = None
    cost_of_transport: float | None = None
    multiplier: float | None = None
    step_size: float = 1.0
    sha256: Mapping[str, str | None] = field(default_factory=dict)
    left_out: str | None = None
    compile_s: float = 0.0
    train_s: float = 0.0
    wall_s: float

    def omitted(self) -> Collection[str]:
        """Return the fields that `--json` omits: what is as usual, figures of a missing orbit."""
        usual = {"step_size": self.step_size == 1.0, "left_out": self.left_out is None}
        names = [name for name, is_usual in usual.items() if is_usual]
        if self.cost_of_transport is None:
            names += ["speed_m_s", "cost_of_transport", "multiplier"]
        return names

    @property
    def tied(self) -> bool:
        """Whether it records the files that its figures were measured on."""
        return bool(self.sha256)

    @property
    def broken(self) -> dict[str, Violations]:
        """Violated conditions on fresh samples, by name."""
        return {name: condition for name, condition in self.conditions.items() if condition.broken}

    @property
    def proved(self) -> bool:
        """Whether the requested proof succeeded, or none was requested."""
        return self.certificate is None or self.certificate.proved


@dataclass(frozen=True, eq=False, kw_only=True)
class EndedInNan(Record):
    """Place where a training ended in NaN.

    Attributes:
        step: number of gradient steps by then.
        kept_step: gradient step of the last good state.
        conditions: names of the conditions that were not finite.
    """

    step: Count
    kept_step: int = 0
    conditions: Texts


@dataclass(frozen=True)
class SeedSummary:
    """Result of one seed of many.

    Attributes:
        seed, run: its number and its run folder.
        loss: loss on fresh samples; None if it is not finite, or the seed is refused.
        broken: conditions that some fresh sample violates; None if the seed is refused.
        refused: why the seed was refused, in one line; None if it is trained.
    """

    seed: Seed
    run: str
    loss: float | None = None
    broken: Texts | None = None
    refused: str | None = None

    @property
    def failing(self) -> Texts:
        """Conditions that some fresh sample violates, none for a seed that is refused."""
        return self.broken or ()


@dataclass(frozen=True, eq=False, kw_only=True)
class SeedsSummary(Record):
    """Result of `train --seeds`: `seeds.json` of the folder that holds the runs.

    Attributes:
        folder: folder of the runs.
        robot, spec: names.
        conditions: number of conditions.
        steps: gradient steps of each seed.
        seeds: results of the seeds, in order.
        batch: number of seeds that were trained together.
        devices: number of devices that shared a batch.
        compile_s, train_s, wall_s: durations for all seeds.
    """

    folder: str
    robot: str
    spec: str
    conditions: Count
    steps: Count
    seeds: tuple[SeedSummary, ...]
    batch: Count
    devices: Count
    compile_s: float
    train_s: float
    wall_s: float

    @property
    def holding(self) -> list[SeedSummary]:
        """Seeds whose conditions all hold on fresh samples."""
        return [one for one in self.seeds if one.broken == ()]

    @property
    def refused(self) -> list[SeedSummary]:
        """Seeds that could not be trained."""
        return [one for one in self.seeds if one.refused is not None]


def measured_hashes(run: Path) -> dict[str, str | None]:
    """Return the sha256 of the files that decide a run's figures; None for a missing file."""
    return file_hashes(run, (WEIGHTS, ROBOT, SPEC, RESIDUAL))


def trained_of(run: Path) -> TrainingSummary:
    """Return the summary of a finished training, without figures of other files than the run's.

    The hashes show a mix-up of files, no forgery: who edits the figures can edit the hashes.

    Raises: RunError if it is damaged; the last checkpoint can be finished again.
    """
    try:
        summary = TrainingSummary.read(run / TRAINING_SUMMARY)
    except RunError as error:
        again = resuming(run)
        raise RunError(f"{error}; deleted, it is written again by `{again}`") from None
    if summary.run == printable(run):
        # JSON holds no path that is not UTF-8, and commands name it byte by byte.
        summary = replace(summary, run=str(run))
    now = measured_hashes(run)
    other = next((file for file in now if summary.sha256.get(file) != now[file]), None)
    if not summary.tied or other is None:
        return replace(summary, left_out=None)
    proof = command("certify", named(run))
    remedy = f"look at these with `{proof}`" if summary.provable else "train again"
    return replace(
        summary,
        loss=None,
        conditions={},
        program_hash=None,
        after_impact=None,
        certificate=None,
        aims={},
        orbit_speeds_m_s=None,
        speed_m_s=None,
        cost_of_transport=None,
        multiplier=None,
        left_out=f"{TRAINING_SUMMARY} has figures of another {other} than the run's: restore that "
        f"file, or {remedy}",
    )
