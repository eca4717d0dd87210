"""Settings of a sweep, and the results of each of its rows and of all of them."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Annotated, Literal

from neuralgaits._checks import SEEDS
from neuralgaits.records.certified import Verdict
from neuralgaits.records.level_words import WORDS
from neuralgaits.records.record import Count, Disturb, Record, Texts
from neuralgaits.records.training_config import Seed, Steps
from neuralgaits.runs.shape import NUMBER, list_of, may, one_of, whole

FORMAT = 1
"""Version of the layout of a sweep's folder; other versions are refused."""
CONFIG_FILE, SWEEP_SUMMARY = "sweep.json", "summary.json"
TABLE, PAGE = "table.csv", "sweep.html"
ROW = "row.json"
"""File of a row, in its run folder."""
UNDISTURBED = "none"
"""Name of walks without a disturbance, used in place of a disturbance's name."""

Speed = Annotated[tuple[float, ...] | None, may(list_of(NUMBER, 1, 2))]
"""Requested speed: None (free), [V], or [LOW, HIGH] of a gait with speed commands (m/s)."""


@dataclass(frozen=True, eq=False, kw_only=True)
class SweepConfig(Record):
    """Settings of a sweep: `sweep.json`.

    Attributes:
        format: version of the layout.
        robots, specs: names; the folder `inputs` has copies of files.
        speeds: speeds to walk at.
        seeds: first seed, and the one after the last.
        steps: gradient steps of each training; those of the recipe if None.
        certify: level to prove; None for no proof.
        budget: seconds for each proof; None for no limit.
        controllers: names of the control laws to walk with.
        disturbances: disturbances of the plant, by their names in the table.
        walks, walk_steps: number of walks under each disturbance, and their steps.
        sha256: hashes of the files in `inputs`, by name.
    """

    format: int
    robots: Texts
    specs: Texts
    speeds: tuple[Speed, ...]
    seeds: Annotated[tuple[int, int], list_of(whole(0, SEEDS), 2)]
    steps: Steps | None
    certify: Annotated[int | None, may(one_of(*WORDS))]
    budget: float | None
    controllers: Texts
    disturbances: Mapping[str, Disturb]
    walks: Annotated[int, whole(1, 10**6)]
    walk_steps: Annotated[int, whole(1, 10**6)]
    sha256: Mapping[str, str]


@dataclass(frozen=True)
class RowWalks:
    """Walks of one gait under one disturbance.

    Attributes:
        controller, disturbance: control law, and name of the disturbance, or `UNDISTURBED`.
        walks, stayed: number of walks, and number of those that stayed up.
        fewest_steps: least number of steps of any walk.
        speed_m_s, cost_of_transport: means; None if no walk was long enough.
        peak_torque_nm, min_normal_force_n: extremes.
    """

    controller: str
    disturbance: str
    walks: Count
    stayed: Count
    fewest_steps: Count
    speed_m_s: float | None
    cost_of_transport: float | None
    peak_torque_nm: float | None
    min_normal_force_n: float | None

    @property
    def share(self) -> float:
        """Share of the walks that stayed up."""
        return self.stayed / self.walks if self.walks else 0.0


@dataclass(frozen=True)
class RowTimes:
    """Duration of each part of a row [s]; None for a part that was not done."""

    train: float | None = None
    prove: float | None = None
    walk: float | None = None


@dataclass(frozen=True, eq=False, kw_only=True)
class SweepRow(Record):
    """One combination of a sweep: `row.json`.

    Attributes:
        name: name of the row, and of its run folder in `rows`.
        robot, spec, speed, seed: the combination.
        failure: None; `refused` if a part refused and would do so again, `defect` for an internal
            error, `lost` if it could not be carried out. `--resume` tries the last two again.
        reason: reason of a failure, in one line that begins with the part.
        steps: gradient steps.
        loss: loss on fresh samples.
        conditions, broken: number of conditions, and number that some fresh sample violates.
        verdict: verdict of the certificate; None if none was requested.
        proved_level: highest level that is proved with all below it.
        margin: least proved margin of all conditions, in scales; None if a condition has none.
        boxes: number of boxes of the certificate.
        walks: results under every disturbance.
        tries: number of workers that started it.
        wall_s: duration of its parts.
    """

    name: str
    robot: str
    spec: str
    speed: Speed = None
    seed: Seed
    failure: Literal["refused", "defect", "lost"] | None = None
    reason: str | None = None
    steps: Count | None = None
    loss: float | None = None
    conditions: Count | None = None
    broken: Count | None = None
    verdict: Verdict | None = None
    proved_level: Count | None = None
    margin: float | None = None
    boxes: Count | None = None
    walks: tuple[RowWalks, ...] = ()
    tries: Count = 1
    wall_s: RowTimes = field(default_factory=RowTimes)

    def under(self, controller: str, disturbance: str) -> RowWalks | None:
        """Return the walks under a disturbance; None if there are none."""
        key = controller, disturbance
        return next((w for w in self.walks if (w.controller, w.disturbance) == key), None)

    @property
    def undisturbed(self) -> RowWalks | None:
        """Walks of the first controller without a disturbance."""
        return next((w for w in self.walks if w.disturbance == UNDISTURBED), None)

    def proved(self, level: int) -> bool:
        """Return whether everything is proved up to a level."""
        return self.proved_level is not None and self.proved_level >= level

    @property
    def final(self) -> bool:
        """Whether another try would give the same result."""
        return self.failure in (None, "refused")


@dataclass(frozen=True, eq=False, kw_only=True)
class SweepSummary(Record):
    """Results of a sweep: `summary.json` of its folder.

    Attributes:
        sweep: the folder.
        rows: number of combinations.
        failed: number of rows with a failure.
        lost: number of failed rows that `--resume` tries again.
        before: number of rows that existed when the command started.
        table, page: paths of the files.
        engine, workers: engine that carried it out, and its number of workers.
        wall_s: elapsed time of this command.
    """

    sweep: str
    rows: Count
    failed: Count
    lost: Count
    before: Count
    table: str
    page: str
    engine: str
    workers: Count
    wall_s: float
