"""Figures of a simulated gait, those of `simulate --json`."""

import numpy as np

from neuralgaits._commands import KNOWN_COMMANDS
from neuralgaits._types import Array, Float
from neuralgaits.control import ClfQp
from neuralgaits.control.speed_adapter import ADAPTED
from neuralgaits.gait import Orbit
from neuralgaits.gait.commands import LEAN, SLOPE, Command, Commands, place_of
from neuralgaits.records.adapted_speeds import AdaptedSpeeds, BelievedLean, BelievedSlope
from neuralgaits.records.simulated import CommandError, ModelOrbit, RelaxedShares, WalkFigures
from neuralgaits.simulation.setup.course import Courses
from neuralgaits.simulation.setup.plant import PERIOD_S
from neuralgaits.simulation.ticks.gauge import START_UP_STEPS
from neuralgaits.simulation.ticks.stride_table import Strides
from neuralgaits.simulation.walk import Walk


def summary(walk: Walk, orbit: Orbit | None = None) -> WalkFigures:
    """Return the figures of a simulation.

    Gait figures are over completed steps, the first START_UP_STEPS of an episode left out; they
    are None if no episode has walked further. Extremes are over all episodes, means over the
    episodes that have the figure.

    `cost_of_transport` is mechanical: the integral of sum |torque rate| over the actuated joints,
    divided by weight times distance. Output error, normal force, joint rate and
    `steady_peak_torque_nm` leave out the first SETTLING_S after touchdown; `peak_torque_nm` is
    over everything.

    `hip_speed_error_m_s` is over every tick of every walk, falls and touchdowns included.

    Args:
        walk: the simulated walk.
        orbit: periodic orbit of the zero dynamics, if it was computed.
    """
    episodes, gauge = walk.episodes, walk.episodes.gauge
    counted = gauge.steps > START_UP_STEPS
    time = gauge.last.time - gauge.first.time
    distance = gauge.last.hip - gauge.first.hip
    work = gauge.last.energy - gauge.first.energy
    weight = float(walk.robot.mass * walk.robot.gravity)
    steady = gauge.steady
    with np.errstate(divide="ignore", invalid="ignore"):
        speed, step_time = distance / time, time / (gauge.steps - START_UP_STEPS)
        cost = work / (weight * distance)
    simulated = float(np.sum(gauge.ticks)) * PERIOD_S
    return WalkFigures(
        steps_walked=tuple(int(steps) for steps in gauge.steps),
        fell=tuple(ending.fell for ending in episodes.endings),
        fall_reasons=tuple(ending.reason for ending in episodes.endings),
        speed_m_s=_mean(speed, counted),
        step_time_s=_mean(step_time, counted),
        cost_of_transport=_mean(cost, counted),
        max_output_error_rad=_largest(steady.output_error, counted),
        peak_torque_nm=_largest(gauge.peak_torque, gauge.ticks > 0),
        steady_peak_torque_nm=_largest(steady.settled_torque, counted),
        max_joint_rate_rad_s=_largest(steady.joint_rate, counted),
        min_normal_force_n=_smallest(steady.normal_force, counted),
        saturated_fraction=float(np.sum(gauge.saturated) / max(1, np.sum(gauge.ticks))),
        relaxed=_relaxed(walk),
        poincare=None if orbit is None else _orbit(orbit),
        sim_steps_per_s=episodes.plant_steps / episodes.wall_s,
        real_time_factor=simulated / episodes.wall_s,
        command_error=command_errors(walk.commands, episodes.strides),
        foothold_error_m=foothold_error(walk.courses, episodes.strides),
        hip_speed_error_m_s=hip_speed_error(walk),
    )


def _relaxed(walk: Walk) -> RelaxedShares | None:
    """Return the mean relaxations of a law with a quadratic program; None for other laws."""
    if not isinstance(walk.law, ClfQp):
        return None
    gauge = walk.episodes.gauge
    decrease, contact = np.sum(gauge.relaxed, axis=0) / max(1, np.sum(gauge.ticks))
    return RelaxedShares(float(decrease), float(contact))


def command_errors(commands: Commands, strides: list[Strides]) -> dict[str, CommandError]:
    """Return how far walks were from their commands; the first START_UP_STEPS are left out.

    The error of speed is the mean over a walk minus the mean of what it was told, also where the
    command was adapted; that of footholds is of each step.
    """
    errors = {}
    for i, command in enumerate(commands):
        misses = [_misses(command.name, i, strides_of_walk) for strides_of_walk in strides]
        all_of_them = np.abs(np.concatenate([np.zeros(0), *misses]))
        # A lean that is told is a belief, and no step has to meet it.
        if command.name in KNOWN_COMMANDS and command.name != LEAN:
            measured = all_of_them.size > 0
            errors[command.name] = CommandError(
                float(np.mean(all_of_them)) if measured else None,
                float(np.max(all_of_them)) if measured else None,
            )
    return errors


def foothold_error(courses: Courses | None, strides: list[Strides]) -> CommandError | None:
    """Return feet's distances from the middle of their stones (m), all steps of all walks."""
    if courses is None or not courses.stones:
        return None
    misses = [
        course.misses(strides_of_walk.place)
        for course, strides_of_walk in zip(courses.each, strides, strict=True)
    ]
    every = np.abs(np.concatenate(misses))
    if not every.size:
        return CommandError(None, None)
    return CommandError(float(np.mean(every)), float(np.max(every)))


def hip_speed_error(walk: Walk) -> float | None:
    """Return the rms error of estimated hip speeds (m/s); None where the speed is measured."""
    if not walk.plant.disturbance.estimator:
        return None
    gauge = walk.episodes.gauge
    # The first torques arrive as late as all others.
    ticks = np.sum(np.maximum(0, gauge.ticks - walk.plant.delay_ticks))
    return float(np.sqrt(np.sum(gauge.speed_error) / ticks)) if ticks else None


def _misses(name: str, i: int, strides: Strides) -> Float[np.ndarray, " K"]:
    """Return measured minus requested values, of a walk or of its steps."""
    strides = Strides(*(column[START_UP_STEPS - 1 :] for column in strides))
    if len(strides.time) < 2:
        return np.zeros(0)
    commands = strides.commands[1:, i]
    if name == ADAPTED:
        # The command itself may have been adapted.
        commands, time = strides.reference[1:], np.diff(strides.time)
        mean = (strides.hip[-1] - strides.hip[0]) / np.sum(time)
        return np.array([mean - np.sum(commands * time) / np.sum(time)])
    length, height = strides.length[1:], strides.height[1:]
    steps = {"step_length": length, "step_height": height, "slope": np.arctan2(height, length)}
    return steps.get(name, commands) - commands


def adapted_speeds(walk: Walk, proved_level: int | None) -> AdaptedSpeeds | None:
    """Return the speeds of the first walk, step by step; None of a gait that takes no speed.

    Args:
        walk: the simulated walk.
        proved_level: level of the run's proof about every sequence of commands; None without one.
    """
    strides, place = walk.episodes.strides[0], place_of(walk.commands, ADAPTED)
    if place is None:
        return None
    speeds = np.diff(strides.hip) / np.diff(strides.time)
    measured = (None if np.isnan(one) else float(one) for one in strides.measured[1:])
    return AdaptedSpeeds(
        told=tuple(strides.reference[1:].tolist()),
        commanded=tuple(strides.commands[1:, place].ravel().tolist()),
        walked=tuple(speeds.tolist()),
        measured=tuple(measured),
        proved_level=proved_level,
    )


def believed_lean(
    walk: Walk, proved_level: int | None, near_m: float | None
) -> BelievedLean | None:
    """Return what the first walk believed of its lean; None of a gait that takes none.

    Args:
        walk: the simulated walk.
        proved_level: level of the run's proof about every sequence of beliefs; None without one.
        near_m: how far from its belief a robot may be that the proof is about (m).
    """
    place = place_of(walk.commands, LEAN)
    if place is None:
        return None
    believed = tuple(walk.episodes.strides[0].commands[:, place].tolist())
    return BelievedLean(believed, proved_level, near_m, _at_end(walk.commands[place], believed))


def believed_slope(walk: Walk, proved_level: int | None) -> BelievedSlope | None:
    """Return what the first walk believed of its ground; None of a gait that takes no slope."""
    if (place := place_of(walk.commands, SLOPE)) is None:
        return None
    believed = tuple(walk.episodes.strides[0].commands[:, place].tolist())
    return BelievedSlope(believed, proved_level, _at_end(walk.commands[place], believed))


def _at_end(command: Command, values: tuple[float, ...]) -> bool:
    """Return whether the last value stands at an end of a command's range."""
    return bool(values) and values[-1] in (command.low, command.high)


def _orbit(orbit: Orbit) -> ModelOrbit:
    if orbit.result != "found":
        return ModelOrbit(multiplier=None, step_length_m=None, result=orbit.result)
    return ModelOrbit(
        multiplier=float(orbit.multiplier),
        period_s=float(orbit.period_s),
        step_length_m=float(orbit.step_length_m),
    )


def _mean(values: Array, counted: Array) -> float | None:
    return float(np.mean(values[counted])) if counted.any() else None


def _largest(values: Array, counted: Array) -> float | None:
    return float(np.max(values[counted])) if counted.any() else None


def _smallest(values: Array, counted: Array) -> float | None:
    return float(np.min(values[counted])) if counted.any() else None
