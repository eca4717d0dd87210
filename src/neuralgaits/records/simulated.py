"""What `simulate` found: `simulation/summary.json` of a run."""

from collections.abc import Collection, Mapping
from dataclasses import dataclass, field
from typing import Any

from neuralgaits.records.certified import box_in_words
from neuralgaits.records.record import Count, Disturb, Record, Texts

FOLDER = "simulation"
SUMMARY, PLANT, LOG = f"{FOLDER}/summary.json", f"{FOLDER}/plant.xml", f"{FOLDER}/walk.csv"
MUJOCO = "mujoco"
STEPS_BEFORE = 5
"""Touchdowns before a push of `simulate`, or half of a shorter walk: transients have died out."""
LOCKSTEP = "lock-step"
"""How a controller's process is reached where it is waited for."""
_OF_FLOOR = {"floor": "floor_height", "friction": "friction"}
"""Kinds of a box that a walk has from its floor, and what they change there."""
_SHOWN = (
    ("speed_m_s", "speed", "m/s"),
    ("step_time_s", "time of a step", "s"),
    ("cost_of_transport", "mechanical cost of transport", ""),
    ("peak_torque_nm", "largest torque", "N m"),
    ("steady_peak_torque_nm", "largest torque, away from touchdowns", "N m"),
    ("max_joint_rate_rad_s", "largest joint rate", "rad/s"),
    ("max_output_error_rad", "largest distance of a joint from its target", "rad"),
    ("min_normal_force_n", "smallest force on the standing foot, away from touchdowns", "N"),
    ("hip_speed_error_m_s", "error of the estimated hip speed, rms", "m/s"),
    ("saturated_fraction", "share of time at a torque limit", ""),
)


@dataclass(frozen=True, eq=False, kw_only=True)
class ModelOrbit(Record):
    """The periodic orbit of the model's zero dynamics; Nones if there is none.

    Attributes:
        multiplier: slope of the Poincaré map [1].
        period_s, step_length_m: of a step.
        result: why there is none; None if it was found.
    """

    multiplier: float | None
    period_s: float | None = None
    step_length_m: float | None
    result: str | None = None

    def unsaid(self) -> Collection[str]:
        """No reason where there is an orbit."""
        return () if self.result is not None else ("result",)


@dataclass(frozen=True)
class Percentiles:
    """Of many times, in microseconds."""

    p50: float
    p99: float


@dataclass(frozen=True)
class LinkTimes(Percentiles):
    """The same of the messages of a link, and the largest."""

    largest: float


@dataclass(frozen=True, eq=False, kw_only=True)
class LinkFigures(Record):
    """What the connection to a controller's process did.

    Attributes:
        law, mode: what it computes, and how it is reached.
        loss, jitter_ms, blend_s: as asked.
        ticks: control ticks.
        packets_sent, packets_lost, packets_late, deadline_misses, overruns: counts.
        faults: of each controller.
        round_trip_us, controller_step_us: times; None if there are none.
    """

    law: str
    mode: str
    loss: float | None = None
    jitter_ms: float | None = None
    blend_s: float | None = None
    ticks: int = 0
    packets_sent: int = 0
    packets_lost: int = 0
    packets_late: int = 0
    deadline_misses: int = 0
    overruns: int = 0
    faults: tuple[int, ...] = ()
    round_trip_us: LinkTimes | None = None
    controller_step_us: LinkTimes | None = None

    @property
    def missed_share(self) -> float:
        """Return the share of ticks, of all walks, for which no answer was there in time."""
        ticks = self.ticks * max(1, len(self.faults))
        return self.deadline_misses / ticks if ticks else 0.0


@dataclass(frozen=True)
class Relaxed:
    """Shares of ticks at which a law with a quadratic program gave something up.

    Attributes:
        decrease: of the ticks, those at which its Lyapunov function may fall too slowly.
        contact: those at which it asks forces of the floor that this does not give.
    """

    decrease: float
    contact: float


@dataclass(frozen=True)
class CommandError:
    """How far walks were from what they were told, in the unit of the command; None if unknown.

    Attributes:
        mean: of walks (speed: of each one's mean) or of their steps (footholds).
        worst: of the same.
    """

    mean: float | None
    worst: float | None


@dataclass(frozen=True, eq=False, kw_only=True)
class WalkFigures(Record):
    """How walks went; see `simulation.metrics` for what is averaged over what.

    Attributes:
        steps_walked, fell, fall_reasons: of each walk.
        speed_m_s, step_time_s: means.
        cost_of_transport: mechanical [1].
        max_output_error_rad, peak_torque_nm, steady_peak_torque_nm, max_joint_rate_rad_s,
            min_normal_force_n: extremes.
        saturated_fraction: share of time at a torque limit.
        relaxed: of a law that has a quadratic program; None of others.
        poincare: None if it was not looked for.
        sim_steps_per_s, real_time_factor: of the simulation itself.
        command_error: of every command that can be measured; empty for a gait that takes none.
        foothold_error_m: how far feet came down from the middle of their stones; None without.
        hip_speed_error_m_s: rms, between the estimated forward speed of the hip that a torque is
            for and the one that it meets; None where it is measured.
    """

    SAME_LENGTH = ("steps_walked", "fell", "fall_reasons")

    steps_walked: tuple[Count, ...]
    fell: tuple[bool, ...]
    fall_reasons: tuple[str | None, ...]
    speed_m_s: float | None = None
    step_time_s: float | None = None
    cost_of_transport: float | None = None
    max_output_error_rad: float | None = None
    peak_torque_nm: float | None = None
    steady_peak_torque_nm: float | None = None
    max_joint_rate_rad_s: float | None = None
    min_normal_force_n: float | None = None
    saturated_fraction: float | None = None
    relaxed: Relaxed | None = None
    poincare: ModelOrbit | None = None
    sim_steps_per_s: float | None = None
    real_time_factor: float | None = None
    command_error: Mapping[str, CommandError] = field(default_factory=dict)
    foothold_error_m: CommandError | None = None
    hip_speed_error_m_s: float | None = None

    @property
    def stayed(self) -> int:
        """Walks that stayed up to their last step."""
        return len(self.fell) - sum(self.fell)

    @property
    def shown(self) -> list[tuple[str, float | None, str]]:
        """What a person sees of the figures that are known: words, number and unit."""
        found = ((words, getattr(self, name), unit) for name, words, unit in _SHOWN)
        return [row for row in found if row[1] is not None]


@dataclass(frozen=True, eq=False, kw_only=True)
class WalkSettings(Record):
    """What was asked of walks, so that they can be repeated.

    Attributes:
        run: that walked.
        plant: name of the robot that walked.
        controller, law: name, and numbers of it.
        episodes: walks.
        start: as in `simulate`.
        push: forward impulse [N s]; None for none.
        disturb: what was changed of the plant; see `simulation.setup.disturbance`.
        sensing: `perfect` or `encoders`, whose numbers are in `disturb`.
        seed: of starts and disturbances.
        engine, engine_note: what walked, and why it is not what was asked for.
        simulator: what stepped the plant; MuJoCo if the file is of a version that does not say.
        steps: walking steps asked of each walk.
        logs: files of the walks.
        sha256: of what the walks are about, by file.
        plant_given: what to name to walk on the same plant: None for the run's own robot, empty
            if the file is of a version that does not say.
        link: None without a process for the controller.
        command: told for ever, by name; None if it changed, or for a gait that takes none.
        commands: file that was told, or `random`; None for neither.
        terrain: that was walked on, as asked; None for a floor.
        parameters: half widths by kind of the box that each walk's robot was drawn from; empty for
            one robot.
        errors: those of the robot of each walk, by what they are of.
    """

    run: str = ""
    plant: str
    controller: str
    law: Mapping[str, Any] = field(default_factory=dict)
    episodes: Count
    start: str
    push: float | None = None
    disturb: Disturb | None = None
    sensing: str | None = None
    seed: Count
    engine: str | None = None
    engine_note: str | None = None
    simulator: str = MUJOCO
    steps: Count | None = None
    logs: Texts | None = ()
    sha256: Mapping[str, str | None] = field(default_factory=dict)
    plant_given: str | None = ""
    link: LinkFigures | None = None
    command: Mapping[str, float] | None = None
    commands: str | None = None
    terrain: str | None = None
    parameters: Mapping[str, float] = field(default_factory=dict)
    errors: Mapping[str, tuple[float, ...]] = field(default_factory=dict)


@dataclass(frozen=True, eq=False, kw_only=True)
class Simulated(WalkFigures, WalkSettings):
    """A simulation: what was asked, and how it went."""

    @property
    def stepped_by(self) -> str:
        """The simulator as a sentence names it."""
        return {MUJOCO: "MuJoCo", "drake": "Drake"}.get(self.simulator, self.simulator)

    @property
    def touchdowns_before_push(self) -> int | None:
        """How many touchdowns a walk has before its push; None if the file does not say."""
        return None if self.steps is None else min(STEPS_BEFORE, self.steps // 2)

    @property
    def fell_after_push(self) -> tuple[int, ...]:
        """Steps of each walk that fell once its push was due; empty without one."""
        before = self.touchdowns_before_push
        if not self.push or before is None:
            return ()
        pairs = zip(self.steps_walked, self.fell, strict=True)
        return tuple(steps for steps, fell in pairs if fell and steps >= before)

    @property
    def drawn_from(self) -> str | None:
        """The box that the robot of each walk was drawn from, in words; None for one robot."""
        return box_in_words(self.parameters) or None

    @property
    def changed(self) -> dict[str, Any]:
        """What was changed of the plant beside that: the floor of a box is said with the box."""
        of_box = {_OF_FLOOR[kind] for kind in self.parameters if kind in _OF_FLOOR}
        return {name: value for name, value in (self.disturb or {}).items() if name not in of_box}

    def unsaid(self) -> Collection[str]:
        """No link, commands, terrain, estimates and quadratic program where there were none."""
        unsaid = ["link"] if self.link is None else []
        for name in ("command_error", "parameters", "errors"):
            unsaid += [] if getattr(self, name) else [name]
        walked = ("command", "commands", "terrain", "foothold_error_m")
        for name in (*walked, "hip_speed_error_m_s", "relaxed"):
            unsaid += [name] if getattr(self, name) is None else []
        return unsaid
