"""What a sweep was asked, what became of each of its rows, and of all of them."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Annotated, Literal

from neuralgaits.records.certified import LEVELS, Verdict
from neuralgaits.records.record import Count, Disturb, Record, Texts
from neuralgaits.records.training_config import Seed, Steps
from neuralgaits.runs.shape import NUMBER, list_of, may, one_of, whole

FORMAT = 1
"""Version of the layout of a sweep's folder; others are refused."""
ASKED, SUMMARY = "sweep.json", "summary.json"
TABLE, PAGE = "table.csv", "sweep.html"
ROW = "row.json"
"""Of a row, in its run folder."""
UNDISTURBED = "none"
"""What walks without a disturbance are called where others have the name of one."""

Speed = Annotated[tuple[float, ...] | None, may(list_of(NUMBER, 1, 2))]
"""None for whatever comes, [V], or [LOW, HIGH] of a gait that is told (m/s)."""


@dataclass(frozen=True, eq=False, kw_only=True)
class SweepAsked(Record):
    """What a sweep was asked: `sweep.json`.

    Attributes:
        format: version of the layout.
        robots, specs: names; the folder `inputs` has copies of files.
        speeds: to walk at.
        seeds: the first, and the one after the last.
        steps: gradient steps of each training; the recipe's if None.
        certify: level to prove; None for no proof.
        budget: seconds for each proof; None for as long as it takes.
        controllers: that walk.
        disturbances: of the plant, by what the table calls them.
        walks, walk_steps: walks under each of them, and their steps.
        sha256: of the files in `inputs`, by name.
    """

    format: int
    robots: Texts
    specs: Texts
    speeds: tuple[Speed, ...]
    seeds: Annotated[tuple[int, int], list_of(whole(0, 2**31), 2)]
    steps: Steps | None
    certify: Annotated[int | None, may(one_of(*LEVELS))]
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
        controller, disturbance: that walked, and under what: `UNDISTURBED` for nothing.
        walks, stayed: how many there were, and how many of them stayed up.
        fewest_steps: of any.
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
        """Of the walks, those that stayed up."""
        return self.stayed / self.walks if self.walks else 0.0


@dataclass(frozen=True)
class RowTimes:
    """Seconds that the parts of a row took; None for one that was not done."""

    train: float | None = None
    prove: float | None = None
    walk: float | None = None


@dataclass(frozen=True, eq=False, kw_only=True)
class SweepRow(Record):
    """One combination of a sweep: `row.json`.

    Attributes:
        name: of the row, and of its run folder in `rows`.
        robot, spec, speed, seed: that it is of.
        failure: None; `refused` if a part said no and would again, `defect` for a mistake of the
            program, `lost` if it could not be carried out. `--resume` tries the last two again.
        reason: of a failure, in one line that begins with the part.
        steps: gradient steps.
        loss: on fresh samples.
        conditions, broken: how many there are, and how many some fresh sample breaks.
        verdict: of the certificate; None if none was asked for.
        proved_level: the highest level that is proved with all below it.
        margin: the least that is proved of all conditions, in scales; None if one has none.
        boxes: of the certificate.
        walks: under every disturbance.
        tries: workers that began it.
        wall_s: times.
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
        """The walks under a disturbance; None if there were none."""
        wanted = controller, disturbance
        return next((w for w in self.walks if (w.controller, w.disturbance) == wanted), None)

    @property
    def undisturbed(self) -> RowWalks | None:
        """The walks of the first controller without a disturbance."""
        return next((w for w in self.walks if w.disturbance == UNDISTURBED), None)

    def proved(self, level: int) -> bool:
        """Whether all is proved up to a level."""
        return self.proved_level is not None and self.proved_level >= level

    @property
    def final(self) -> bool:
        """Whether it would come out the same again."""
        return self.failure in (None, "refused")


@dataclass(frozen=True, eq=False, kw_only=True)
class Swept(Record):
    """What became of a sweep: `summary.json` of its folder.

    Attributes:
        sweep: the folder.
        rows: combinations.
        failed: those with a failure.
        lost: of these, those that `--resume` tries again.
        before: rows that were there when the command began.
        table, page: files.
        engine, workers: what carried it out.
        wall_s: time of this command.
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
