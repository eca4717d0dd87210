"""What `train` and `refine` found: `summary.json` of a run, `nan.json` of one that failed.

Of many seeds that were trained as one: `seeds.json` of the folder that holds their runs.
"""

from collections.abc import Collection, Mapping
from dataclasses import dataclass, field
from pathlib import Path

from neuralgaits.errors import RunError
from neuralgaits.records.record import Count, Pair, Record, Texts
from neuralgaits.records.training_config import Range, Seed
from neuralgaits.runs.names import SUMMARY
from neuralgaits.runs.shell_words import resuming


@dataclass(frozen=True)
class Violations:
    """What fresh samples say of a condition, in scales of it, like every margin that is shown.

    Attributes:
        mean_violation, max_violation: of margin >= 0 (scales).
        min_margin: the smallest margin seen (scales).
        scale: the size of one scale, in the condition's own unit.
    """

    mean_violation: float
    max_violation: float
    min_margin: float
    scale: float

    @property
    def broken(self) -> bool:
        """Whether some sample breaks it."""
        return self.max_violation > 0.0


@dataclass(frozen=True)
class TrainingProof:
    """The last certificate of a training that was to be proved.

    Attributes:
        verdict: of level 1.
        level: 1.
        repairs, repair_steps: further trainings, and gradient steps of all of them.
        smallest_margin: that is proved, in scales; None if a condition is not proved.
        open_boxes: boxes on which some condition is not proved.
        failing: such boxes by condition.
        wall_s: of proofs and repairs.
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
        """Whether every condition is."""
        return self.verdict == "proved"


@dataclass(frozen=True)
class ProofRound:
    """What one certificate of a training found.

    Attributes:
        number: repairs before it.
        steps: gradient steps before it.
        verdict: of the certificate.
        open_boxes: boxes on which some condition is not proved.
        failing: such boxes by condition.
        smallest_margin: that is proved, in scales; None if a condition is not.
        wall_s: time that the certificate took.
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
    """The certificates of a training so far: `rounds.json`."""

    rounds: tuple[ProofRound, ...]


@dataclass(frozen=True, eq=False, kw_only=True)
class Trained(Record):
    """What came of a training.

    Attributes:
        run, robot, spec, seed: as asked.
        steps: gradient steps taken, those of repairs included.
        loss: on fresh samples; None if it is not finite.
        conditions: what fresh samples say of each.
        provable: whether there is a Program of the spec's conditions.
        program_hash: of it.
        after_impact: what the real impact leaves of the outputs, at worst (units in the names).
        certificate: None if no proof was asked for.
        commands: what the gait is told at each touchdown, by name.
        aims: what fresh samples say of each.
        orbit_speeds_m_s: mean speeds of the orbits at both ends of the range of `speed`, other
            commands in the middle of theirs; None without that command, or without an orbit.
        speed_m_s, cost_of_transport, multiplier: of the orbit of a gait that was not trained: mean
            speed, mechanical cost of transport on the zero dynamics [1], slope of the Poincare map.
        step_size: share of the recipe's that the last step had, if it is less than all of it: where
            steps turn to NaN, smaller ones go on from the best weights before that.
        compile_s, train_s, wall_s: times; where many seeds were trained as one, of all of them.
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
    compile_s: float = 0.0
    train_s: float = 0.0
    wall_s: float

    def unsaid(self) -> Collection[str]:
        """The size of steps, where it is the recipe's; figures of an orbit that was not given."""
        orbit = ("speed_m_s", "cost_of_transport", "multiplier")
        silent = orbit if self.cost_of_transport is None else ()
        return (*silent, "step_size") if self.step_size == 1.0 else silent

    @property
    def broken(self) -> dict[str, Violations]:
        """The conditions that some sample breaks."""
        return {name: found for name, found in self.conditions.items() if found.broken}

    @property
    def proved(self) -> bool:
        """Whether there is every proof that was asked for."""
        return self.certificate is None or self.certificate.proved


@dataclass(frozen=True, eq=False, kw_only=True)
class EndedInNan(Record):
    """Where a training ended.

    Attributes:
        step: gradient steps by then.
        kept_step: of the last good state.
        conditions: that were not finite.
    """

    step: Count
    kept_step: int = 0
    conditions: Texts


@dataclass(frozen=True)
class TrainedSeed:
    """What became of one seed of many.

    Attributes:
        seed, run: its number and its run folder.
        loss: on fresh samples; None if it is not finite, or refused.
        broken: conditions that some fresh sample breaks; None if it is refused.
        refused: why, in one line; None if it is trained.
    """

    seed: Seed
    run: str
    loss: float | None = None
    broken: Texts | None = None
    refused: str | None = None


@dataclass(frozen=True, eq=False, kw_only=True)
class TrainedSeeds(Record):
    """What came of `train --seeds`: `seeds.json` of the folder that holds the runs.

    Attributes:
        folder: of the runs.
        robot, spec: names.
        conditions: how many there are.
        steps: gradient steps of each seed.
        seeds: in order.
        batch: seeds that were trained together.
        devices: that shared a batch.
        compile_s, train_s, wall_s: times of all of it.
    """

    folder: str
    robot: str
    spec: str
    conditions: Count
    steps: Count
    seeds: tuple[TrainedSeed, ...]
    batch: Count
    devices: Count
    compile_s: float
    train_s: float
    wall_s: float

    @property
    def holding(self) -> list[TrainedSeed]:
        """Those whose conditions all hold on fresh samples."""
        return [one for one in self.seeds if one.broken == ()]

    @property
    def refused(self) -> list[TrainedSeed]:
        """Those that could not be trained."""
        return [one for one in self.seeds if one.refused is not None]


def trained_of(run: Path) -> Trained:
    """The summary of a finished training.

    Raises: RunError if it is damaged; the last checkpoint can be finished again.
    """
    try:
        return Trained.read(run / SUMMARY)
    except RunError as error:
        again = resuming(run)
        raise RunError(f"{error}; deleted, it is written again by `{again}`") from None
