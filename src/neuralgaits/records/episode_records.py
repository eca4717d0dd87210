"""Results of episodes: the walks of a round, and the summary of all rounds."""

from collections.abc import Collection, Mapping
from dataclasses import dataclass, field, fields
from typing import Annotated, Any, Self

from neuralgaits._checks import MOST_ROUNDS
from neuralgaits._control_laws import LawName
from neuralgaits.records.fitted import FitSummary, TouchdownErrors
from neuralgaits.records.record import Count, Disturb, Pair, Record, Texts
from neuralgaits.records.trained import TrainingSummary
from neuralgaits.records.training_config import Seed, Steps
from neuralgaits.runs.shape import NUMBER, may, table_of, whole

CONFIG_FILE, EPISODES_SUMMARY = "episodes.json", "summary.json"
WALKS = "walks"
"""Folder in a round's run that holds `EPISODES_SUMMARY` and the logs of its walks."""


@dataclass(frozen=True, eq=False)
class FormatVersion(Record):
    """Record of a format's version, which may be another version than this program's."""

    format: Any = None


@dataclass(frozen=True, eq=False, kw_only=True)
class EpisodesConfig(Record):
    """Settings of episodes: `episodes.json`.

    Attributes:
        format: version of the layout.
        robot, plant: names of the model, and of the robot that walks in simulation.
        disturb, controller: disturbance and control law of the plant.
        logs: folder of a robot's own logs in place of a plant.
        columns: file that describes the columns of these logs.
        rounds: number of rounds of learning and refining.
        seed: seed of everything random.
        steps: gradient steps of each training; those of the recipe if None.
        start: run that the episodes started from.
    """

    format: int
    robot: str
    plant: str | None
    disturb: Disturb | None
    controller: LawName
    logs: str | None
    rounds: Annotated[int, whole(1, MOST_ROUNDS)]
    seed: Seed
    steps: Steps | None
    start: str | None
    columns: str | None = None


@dataclass(frozen=True, kw_only=True)
class Shares:
    """Shares of the judged rows of logs; see `logs.satisfaction`.

    Attributes:
        rows: number of judged rows.
        tube: share inside the tube.
        all: share inside the tube where every condition that a log can judge also holds.
        conditions: share of rows, at the phases of a condition's region, where it holds.
    """

    rows: int = 0
    tube: float | None
    all: float | None
    conditions: Annotated[Mapping[str, float], table_of(may(NUMBER))]


@dataclass(frozen=True, eq=False, kw_only=True)
class RoundWalks(Record):
    """Walks of a round; fields are None or empty if a robot's own logs do not show them.

    Attributes:
        steps_walked, fall_reasons: outcome of each walk from a random state of the tube.
        share_that_walks: share of these walks that stayed up.
        steps_walked_at: steps of each walk that starts at a share of the nominal momentum.
        share_of_speeds: share of these walks, from 0.8 to 1.2, that stayed up.
        momentum_range: longest range of such shares in which all walks stayed up.
        speed_range_m_s: that range as speeds of the hip at mid-step.
        speed_m_s: mean speed.
        barriers: shares of the logged time at which barriers hold.
        walked_s: logged time.
        logs_left_out: number of walks that nothing can be learned from.
        engine, engine_note: engine that ran, and why it is not compiled code.
    """

    steps_walked: tuple[Count, ...]
    share_that_walks: float | None
    fall_reasons: tuple[str | None, ...] | None = ()
    steps_walked_at: Mapping[str, int] = field(default_factory=dict)
    share_of_speeds: float | None = None
    momentum_range: Pair | None = None
    speed_range_m_s: Pair | None
    speed_m_s: float | None = None
    barriers: Shares
    walked_s: float | None = None
    logs_left_out: int = 0
    engine: str | None = None
    engine_note: str | None = None

    def omitted(self) -> Collection[str]:
        """Return the fields that `--json` omits: those that a robot's own logs do not show."""
        simulated = ("fall_reasons", "steps_walked_at", "speed_m_s", "logs_left_out", "engine")
        return (*simulated, "engine_note") if self.engine is None else ()


@dataclass(frozen=True, eq=False, kw_only=True)
class WalkedRound(RoundWalks):
    """`walks/summary.json` of a round. Attributes: logs: to learn from; wall_s: elapsed time."""

    logs: Texts
    wall_s: float


@dataclass(frozen=True)
class RoundTimes:
    """Duration of each part of a round [s]; None for a part that was not done."""

    train: float | None = None
    walk: float | None = None
    fit: float | None = None


@dataclass(frozen=True, eq=False, kw_only=True)
class _RoundPolicy(Record):
    """Number of a round, its run, and the loss of its policy."""

    round: Count
    run: str = ""
    loss: float | None


@dataclass(frozen=True, eq=False, kw_only=True)
class Round(RoundWalks, _RoundPolicy):
    """A round: its policy, its walks, and what was learned from them; see `FitSummary`.

    Attributes:
        reason: why nothing was learned.
        wall_s: duration of its parts.
    """

    heldout_error: float | None
    nominal_heldout_error: float | None
    binned_floor: float | None
    touchdowns: TouchdownErrors | None = None
    error_bound: Pair | None = None
    reason: str | None = None
    wall_s: RoundTimes = RoundTimes()

    @classmethod
    def of_parts(
        cls,
        number: int,
        run: str,
        trained: TrainingSummary,
        walks: WalkedRound,
        learned: FitSummary | str,
    ) -> Self:
        """Combine a round's training, its walks, and the fit, or the reason why there is none."""
        values = {part.name: getattr(walks, part.name) for part in fields(RoundWalks)}
        for name in ("heldout_error", "nominal_heldout_error", "binned_floor", "touchdowns"):
            values[name] = getattr(learned, name, None)
        fit_s = None if isinstance(learned, str) else learned.wall_s
        return cls(
            round=number,
            run=run,
            loss=trained.loss,
            **values,
            error_bound=None if isinstance(learned, str) else learned.error_bound,
            reason=learned if isinstance(learned, str) else None,
            wall_s=RoundTimes(trained.wall_s, walks.wall_s, fit_s),
        )


@dataclass(frozen=True, eq=False, kw_only=True)
class EpisodesSummary(Record):
    """Results of all rounds: `summary.json` of episodes.

    Attributes:
        robot, plant, disturb, controller, logs, seed: as requested.
        episodes: the folder.
        run: run of the last policy.
        rounds: rounds that were walked.
        waiting_for: folder of the logs that are needed to continue.
        diverged: why a training stopped.
        figure: path of the figure.
        wall_s: elapsed time.
    """

    robot: str
    plant: str | None
    disturb: Disturb | None = None
    controller: str
    logs: str | None
    seed: int = 0
    episodes: str = ""
    run: str = ""
    rounds: tuple[Round, ...]
    waiting_for: str | None = None
    diverged: str | None = None
    figure: str = ""
    wall_s: float = 0.0
