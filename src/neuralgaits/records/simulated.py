"""Result of `simulate`: `simulation/summary.json` of a run."""

from collections.abc import Collection, Mapping
from dataclasses import dataclass, field
from typing import Any

from neuralgaits.records.adapted_speeds import (
    AdaptedSpeeds,
    BelievedLean,
    BelievedSlope,
    LearnedLean,
)
from neuralgaits.records.certified import box_in_words
from neuralgaits.records.link_figures import LinkFigures
from neuralgaits.records.monitored import MonitorFigures
from neuralgaits.records.record import Count, Disturb, Record, Texts

FOLDER = "simulation"
WALK_SUMMARY, PLANT, LOG = f"{FOLDER}/summary.json", f"{FOLDER}/plant.xml", f"{FOLDER}/walk.csv"
MUJOCO = "mujoco"
STEPS_BEFORE = 5
"""Touchdowns before a push, or half of a shorter walk's: transients have died out by then."""
FLOOR_DISTURBANCES = {"floor": "floor_height", "friction": "friction"}
"""Parameters of a box that change a walk's floor, and the disturbances that they set."""


@dataclass(frozen=True, eq=False, kw_only=True)
class ModelOrbit(Record):
    """The periodic orbit of the model's zero dynamics; fields are None if there is no orbit.

    Attributes:
        multiplier: slope of the Poincaré map [1].
        period_s, step_length_m: duration and length of a step.
        result: why there is no orbit; None if there is one.
    """

    multiplier: float | None
    period_s: float | None = None
    step_length_m: float | None
    result: str | None = None

    @property
    def speed_m_s(self) -> float | None:
        """Mean speed along it; None if there is no orbit."""
        if not self.period_s or self.step_length_m is None:
            return None
        return self.step_length_m / self.period_s

    def omitted(self) -> Collection[str]:
        """Return the fields that `--json` omits: the reason, if there is an orbit."""
        return () if self.result is not None else ("result",)


@dataclass(frozen=True)
class RelaxedShares:
    """Shares of ticks at which a law with a quadratic program relaxed a constraint.

    Attributes:
        decrease: share at which its Lyapunov function may fall too slowly.
        contact: share at which it requires ground forces that the floor does not give.
    """

    decrease: float
    contact: float


@dataclass(frozen=True)
class CommandError:
    """Differences between walks and their commands, in the command's unit; None if unknown.

    Attributes:
        mean: mean over walks (speed: of each walk's mean) or over their steps (footholds).
        worst: largest of the same.
    """

    mean: float | None
    worst: float | None


@dataclass(frozen=True, eq=False, kw_only=True)
class WalkFigures(Record):
    """Results of walks; see `simulation.metrics` for how they are averaged.

    Attributes:
        steps_walked, fell, fall_reasons: outcome of each walk.
        speed_m_s, step_time_s: means.
        cost_of_transport: mechanical cost of transport [1].
        max_output_error_rad, peak_torque_nm, steady_peak_torque_nm, max_joint_rate_rad_s,
            min_normal_force_n: extremes.
        saturated_fraction: share of control ticks at which the law's torque of any joint was
            clipped, or is at its limit; the rate limit of exported C does not count.
        relaxed: relaxed constraints of a law with a quadratic program; None for other laws.
        poincare: periodic orbit of the model; None if it was not computed.
        sim_steps_per_s, real_time_factor: speed of the simulation itself.
        command_error: errors of every command that can be measured; empty without commands.
        foothold_error_m: distance of footholds from the middle of their stones; None without
            stones.
        hip_speed_error_m_s: rms error of the estimated forward speed of the hip at the time that
            the torque acts; None if the speed is measured.
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
    relaxed: RelaxedShares | None = None
    poincare: ModelOrbit | None = None
    sim_steps_per_s: float | None = None
    real_time_factor: float | None = None
    command_error: Mapping[str, CommandError] = field(default_factory=dict)
    foothold_error_m: CommandError | None = None
    hip_speed_error_m_s: float | None = None

    @property
    def stayed(self) -> int:
        """Number of walks that stayed up to their last step."""
        return len(self.fell) - sum(self.fell)

    @property
    def shown(self) -> list[tuple[str, float | None, str]]:
        """Figures that are known, for a person: words, number and unit."""
        figures = (
            ("speed_m_s", "speed", "m/s"),
            ("step_time_s", "time of a step", "s"),
            ("cost_of_transport", "mechanical cost of transport", ""),
            ("peak_torque_nm", "peak torque", "N m"),
            ("steady_peak_torque_nm", "peak torque, touchdowns excluded", "N m"),
            ("max_joint_rate_rad_s", "largest joint rate", "rad/s"),
            ("max_output_error_rad", "largest distance of a joint from its target", "rad"),
            ("min_normal_force_n", "smallest force on the standing foot, touchdowns excluded", "N"),
            ("hip_speed_error_m_s", "error of the estimated hip speed, rms", "m/s"),
            ("saturated_fraction", "share of time at a torque limit", ""),
        )
        rows = ((words, getattr(self, name), unit) for name, words, unit in figures)
        return [row for row in rows if row[1] is not None]


@dataclass(frozen=True, eq=False, kw_only=True)
class WalkSettings(Record):
    """Settings of walks, with which they can be repeated.

    Attributes:
        run: run that walked.
        plant: name of the robot that walked.
        controller, law: name of the control law, and its parameters.
        bandwidth: requested double pole of its output errors [rad/s]; None for the law's own.
        episodes: number of walks.
        start: initial states, as in `simulate`.
        push: forward impulse [N s]; None for none.
        disturb: changes of the plant; see `simulation.setup.disturbance`.
        sensing: `perfect` or `encoders`, whose numbers are in `disturb`.
        seed: seed of starts and disturbances.
        engine, engine_note: engine that ran, and why it is not the requested one.
        simulator: simulator of the plant; MuJoCo if the file's version does not record it.
        steps: walking steps requested of each walk.
        logs: files of the walks.
        sha256: hashes of the files that determine the walks, by file.
        plant_given: name that gives the same plant: None for the run's own robot, empty if the
            file's version does not record it.
        link: statistics of the connection; None without a process for the controller.
        command: constant command, by name; None if it changed, or for a gait without commands.
        commands: file of the commands, or `random`; None for neither.
        adapt: commands that were adapted, as in `speed,lean`; None if none was.
        terrain: requested terrain; None for a floor.
        parameters: half widths by kind of the box that each walk's robot was drawn from; empty for
            one robot.
        errors: parameter errors of each walk's robot, by parameter.
        joints, joints_sha256: file of identified joints that the torques are for, as requested,
            and its hash; None without.
    """

    run: str = ""
    plant: str
    controller: str
    law: Mapping[str, Any] = field(default_factory=dict)
    bandwidth: float | None = None
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
    adapt: str | None = None
    terrain: str | None = None
    parameters: Mapping[str, float] = field(default_factory=dict)
    errors: Mapping[str, tuple[float, ...]] = field(default_factory=dict)
    joints: str | None = None
    joints_sha256: str | None = None


def disturbances(values: Mapping[str, Any] | None) -> dict[str, float]:
    """Return the disturbances that differ from their defaults, as a command takes them."""
    # None is as in the robot's file, and 0 is not.
    usual = {"mass_scale": 1.0, "friction": None, "torque_limit": None, "drive_rate": 2e3}
    return {
        name: value
        for name, value in (values or {}).items()
        if value is not None and value != usual.get(name, 0.0)
    }


@dataclass(frozen=True, eq=False, kw_only=True)
class SimulationSummary(WalkFigures, WalkSettings):
    """A simulation: its settings and results.

    Attributes:
        monitor: its states and the sets that are proved of the gait; None without `--monitor`.
        adapted: speeds of the first walk, step by step; None without `--adapt`.
        believed_lean: leans that the first walk believed in; None without `--adapt`, or of a gait
            that takes no lean.
        believed_slope: slopes that the first walk believed in; None unless `--adapt` names it.
        learned_lean: lean of the torso that its joint angles show; None without `--adapt`, on
            workers, and for a robot that has no torso or flat feet.
    """

    monitor: MonitorFigures | None = None
    adapted: AdaptedSpeeds | None = None
    believed_lean: BelievedLean | None = None
    believed_slope: BelievedSlope | None = None
    learned_lean: LearnedLean | None = None

    @property
    def stepped_by(self) -> str:
        """Name of the simulator in a sentence."""
        return {MUJOCO: "MuJoCo", "drake": "Drake"}.get(self.simulator, self.simulator)

    @property
    def walked_by(self) -> str:
        """Control law and simulator in words."""
        joints = "" if self.joints is None else " with identified joints"
        return f"under {self.law_in_words}{joints} in {self.stepped_by}"

    @property
    def law_in_words(self) -> str:
        """Name of the control law, and its bandwidth if one was requested."""
        width = "" if self.bandwidth is None else f" at {self.bandwidth:g} rad/s"
        return f"{self.controller}{width}"

    @property
    def met(self) -> str:
        """Differences between the plant and the gait's robot, as options; empty if none."""
        parts = [f"plant {self.plant}"] if self.plant_given else []
        if self.push:
            parts.append(f"push {self.push:g} N s")
        parts += [f"{name}={value:g}" for name, value in disturbances(self.changed).items()]
        return "".join(f", {part}" for part in parts)

    @property
    def touchdowns_before_push(self) -> int | None:
        """Number of touchdowns before a walk's push; None if the file does not record it."""
        return None if self.steps is None else min(STEPS_BEFORE, self.steps // 2)

    @property
    def fell_after_push(self) -> tuple[int, ...]:
        """Steps of each walk that fell once its push was due; empty without a push."""
        before = self.touchdowns_before_push
        if not self.push or before is None:
            return ()
        pairs = zip(self.steps_walked, self.fell, strict=True)
        return tuple(steps for steps, fell in pairs if fell and steps >= before)

    @property
    def drawn_from(self) -> str | None:
        """Box that the robot of each walk was drawn from, in words; None for one robot."""
        return box_in_words(self.parameters) or None

    @property
    def changed(self) -> dict[str, Any]:
        """Changes of the plant, without those of a floor that belongs to the box."""
        of_box = {name for kind, name in FLOOR_DISTURBANCES.items() if kind in self.parameters}
        return {name: value for name, value in (self.disturb or {}).items() if name not in of_box}

    def omitted(self) -> Collection[str]:
        """Return the fields that `--json` omits: those of features that the walks did not use."""
        optional = ["link", "monitor", "joints", "joints_sha256", "adapt", "adapted", "bandwidth"]
        optional += ["believed_lean", "believed_slope", "learned_lean", "command", "commands"]
        optional += ["terrain", "foothold_error_m", "hip_speed_error_m_s", "relaxed"]
        collections = ("command_error", "parameters", "errors")
        absent = [name for name in optional if getattr(self, name) is None]
        return absent + [name for name in collections if not getattr(self, name)]
