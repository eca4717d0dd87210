"""Orbits of a gait that takes commands, at constant commands: see `analysis.family`."""

from typing import NamedTuple

import numpy as np

from neuralgaits.analysis.command_sweeps import CommandSweep, Family, Member
from neuralgaits.analysis.flow import FlowQuantities, Mesh
from neuralgaits.analysis.link_points import skeleton
from neuralgaits.analysis.poincare_map import cycle, motion_of, orbit_near
from neuralgaits.analysis.point_evaluator import PlaneChart, PointEvaluator
from neuralgaits.analysis.run import Run
from neuralgaits.errors import InputError
from neuralgaits.gait import Orbit
from neuralgaits.gait.zero_coordinates import momentum_of

VALUES = 7
"""Number of values of a command over its range: odd, so that the middle is one of them."""
MIDDLE = 0.5
"""Level of the tube from which the search for the first orbit starts."""


class _OrbitAt(NamedTuple):
    """The gait at a constant command, and its orbit."""

    run: Run
    motion: FlowQuantities
    chart: PlaneChart
    mesh: Mesh
    orbit: Orbit
    level: float
    """Level of the orbit where the hip is above the foot; `MIDDLE` without an orbit."""


def family_data(run: Run) -> Family:
    """Find the orbits of a family over the range of each of its commands.

    Raises: InputError for a gait that takes no commands.
    """
    commands = run.trained.commands
    if not commands:
        raise InputError("expected a gait that takes commands, found one that takes none")
    middle = {one.name: 0.5 * (one.low + one.high) for one in commands}
    sweeps, members = [], []
    with np.errstate(all="ignore"):
        for one in commands:
            values = np.linspace(one.low, one.high, VALUES)
            orbits: list[_OrbitAt] = []
            for value in values:
                level = orbits[-1].level if orbits else MIDDLE
                orbits.append(_orbit_at(run, middle | {one.name: float(value)}, level))
            speed = np.array([each.orbit.speed_m_s for each in orbits])
            sweeps.append(CommandSweep(one.name, values, speed))
            if not members:
                rows = (0, VALUES // 2, VALUES - 1)
                members = [_member(float(values[row]), orbits[row]) for row in rows]
    return Family(tuple(sweeps), tuple(members), run.robot.torso is not None)


def _orbit_at(run: Run, command: dict[str, float], level: float) -> _OrbitAt:
    """Search for the orbit at a command, from a level of the tube there on."""
    steady = run.at(**command)
    chart, motion = PlaneChart(steady.gait, run.spec), motion_of(steady.zero_dynamics)
    # Steps of the flow over a step of the robot: errors near 1e-9 of z2, at half the time.
    nodes = 30
    mesh = Mesh.of_gait(chart.start, chart.guard, nodes)
    low, high = 0.5 * chart.section(2) ** 2
    orbit = orbit_near(motion, float(np.sqrt(2.0 * (low + level * (high - low)))), mesh)
    orbit_level = float((0.5 * momentum_of(orbit.fixed_point) ** 2 - low) / (high - low))
    if 0.0 <= orbit_level <= 1.0:
        return _OrbitAt(steady, motion, chart, mesh, orbit, orbit_level)
    # What Newton's method finds outside of the fences is not of this gait.
    none = orbit._replace(period_s=float("nan"), result="no periodic orbit between the fences")
    return _OrbitAt(steady, motion, chart, mesh, none, MIDDLE)


def _member(value: float, orbit_at: _OrbitAt) -> Member:
    robot, chart = orbit_at.run.robot, orbit_at.chart
    count = 41  # Number of points along the fences.
    phase = np.linspace(0.0, 1.0, count)
    orbit = cycle(orbit_at.motion, orbit_at.orbit, orbit_at.mesh).z[:, 0]
    zd = orbit_at.run.zero_dynamics
    theta = (
        PointEvaluator(lambda z: {"theta": zd.point(z).theta})(orbit[-1:])["theta"]
        if len(orbit)
        else ()
    )
    foot = np.asarray(robot.foot)
    return Member(
        value,
        chart.z(phase, np.zeros(count))[:, 0],
        chart.fences(phase),
        orbit,
        skeleton(np.reshape(theta, (-1, len(foot))), foot, robot.torso),
    )
