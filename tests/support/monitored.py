"""A monitor of the shipped gait: its proved set of level 2, and a set of levels 4 and 5 made up."""

import subprocess
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import jax
import jax.numpy as jnp
import numpy as np

from neuralgaits.analysis.run import Run, open_run
from neuralgaits.analysis.state_monitor import CommandSpan, StateMonitor
from neuralgaits.barriers import Gait
from neuralgaits.certificate.levels.full_order.model import FullOrderModel, scaled_coordinates
from neuralgaits.certificate.levels.full_order.theorem import BarrierConstants, FullOrderConstants
from neuralgaits.certificate.levels.walking_set.theorem import WalkingSetConstants
from neuralgaits.certificate.run_certificate.proved_monitor import (
    full_order_set_of,
    walking_set_of,
)
from neuralgaits.export import build, output_folder
from neuralgaits.export.design import Design
from neuralgaits.export.monitor_check import CHECKED, MonitorCases
from neuralgaits.export.monitor_source import monitor_files
from neuralgaits.export.source import gait_files
from neuralgaits.gait import ZeroDynamics
from neuralgaits.robots.dynamics import swing_foot
from neuralgaits.workflows.export import design_of
from support.shipped_run import SHIPPED

HOLD_S = 1.2345678e-3
WALKING = WalkingSetConstants(1e-3, 2e-3, 0.06, 0.5, (0.0, 0.0), (), ())
WEIGHTS = (1.0, -0.5, 0.2, 0.1, 2.0, 0.3, -0.2, 1.5, 0.4, 0.8)
"""S of the norm: upper triangular, over four joints."""


def full_order_constants(names: Sequence[str]) -> FullOrderConstants:
    """A set around nothing in particular, with a floor and a norm of its own."""
    rows = tuple(
        BarrierConstants(name, 5.0, 0.1, 1.0, 0.5 * (k > 1), 0.2 + 0.1 * k, 1.0, 200.0 + 100.0 * k)
        for k, name in enumerate(names)
    )
    return FullOrderConstants(
        bandwidth=40.0,
        radius=0.02,
        shrink=0.9,
        guard_radius=0.01,
        start_strip=0.003,
        guard_strip=0.004,
        crossing=0.001,
        risen=0.06,
        pace=(0.9, 3.0),
        inertia=1.0,
        mismatch=1.0,
        drift=1.0,
        gain=1.0,
        landing=1.0,
        landing_slope=1.0,
        barriers=rows,
        least_radius=0.004,
        weights=WEIGHTS,
    )


def made_up() -> tuple[Run, FullOrderConstants, Design]:
    """The shipped run, constants, and a design with the monitor of these sets."""
    run = open_run(SHIPPED)
    shape = full_order_constants(FullOrderModel(run.robot, run.gait, run.spec).names)
    sets = walking_set_of(run, WALKING), full_order_set_of(run, shape, (4, 5))
    monitor = StateMonitor(sets, HOLD_S, shape.bandwidth, (), "a" * 64, "b" * 64)
    return run, shape, replace(design_of(run), monitor=monitor)


def with_commands(run: Run, spans: tuple[CommandSpan, ...]) -> Design:
    """The design of a family whose set of level 2 is made up, for these ranges."""
    shape = replace(WALKING, told=tuple(one.name for one in spans))
    monitor = StateMonitor((walking_set_of(run, shape),), None, None, spans, "a" * 64, "b" * 64)
    return replace(design_of(run), monitor=monitor)


def compiled(folder: Path, design: Design, flags: tuple[str, ...] = ()) -> Path:
    """The exporter's harness around a design's monitor."""
    folder.mkdir(parents=True, exist_ok=True)
    files = output_folder.shipped() | output_folder.harness()
    for name, text in (files | gait_files(design) | monitor_files(design)).items():
        (folder / name).write_text(text)
    return build.build("gcc", folder, "check_monitor", CHECKED, ("-O1", *flags))


def ticks(
    program: Path, cases: MonitorCases, rows: Sequence[int], times_us: Sequence[int]
) -> list[list[str]]:
    """What a monitor answers at these states and times, tick after tick, in words."""
    times = np.array(times_us, dtype=np.float64)[:, None]
    file = program.parent / "ticks"
    np.hstack([cases.rows()[list(rows)], times]).tofile(file)
    done = subprocess.run([str(program), "ticks", str(file)], capture_output=True, check=True)
    return [line.split() for line in done.stdout.decode().splitlines()]


def tube_margins(
    gait: Gait, shape: WalkingSetConstants | FullOrderConstants, z: np.ndarray
) -> dict[str, np.ndarray]:
    """Phases and levels of states, as both theorems have them. [N] each."""
    first, last = shape.ends
    phase = np.asarray(jax.jit(jax.vmap(gait.phase))(jnp.asarray(z[:, 0])))
    level = np.asarray(jax.jit(jax.vmap(gait.level))(jnp.asarray(z)))
    return {
        "phase-start": phase - first,
        "phase-end": last - phase,
        "direction": z[:, 1],
        "level-lower": level,
        "level-upper": 1.0 - level,
    }


def theorem_margins(
    run: Run, shape: FullOrderConstants, q: np.ndarray, dq: np.ndarray
) -> dict[str, np.ndarray]:
    """Slacks of the conditions of D as docs/full_order.md lists them.

    From the certificate's own functions, put together here a second time.
    """
    gait, robot = run.gait, run.robot
    model = FullOrderModel(robot, gait, run.spec)
    phi = jax.jit(jax.vmap(ZeroDynamics(robot, gait.policy).phi))
    eta, z = map(np.asarray, phi(jnp.concatenate([q, dq], axis=1)))
    scaled = jax.vmap(lambda one: scaled_coordinates(one, shape.bandwidth, shape.weights))
    xi = jax.jit(scaled)(eta)
    v = np.sum(np.asarray(xi) ** 2, axis=1)
    found = tube_margins(gait, shape, z)
    phase = found["phase-start"] + shape.ends[0]
    floor, widest = shape.least_radius, shape.radius
    bound = floor + (widest - floor) * np.exp(-shape.shrink * phase**2)
    foot = np.asarray(jax.jit(jax.vmap(lambda one: swing_foot(robot, one)[1]))(jnp.asarray(q)))
    found |= {"foot": foot, "output-error": bound - np.sqrt(v)}
    h = np.asarray(jax.jit(jax.vmap(model.barriers))(jnp.asarray(z)))
    for k, row in enumerate(shape.barriers):
        t = row.reading**2 / (4.0 * row.sigma)
        found[row.name] = h[:, k] - t - row.sigma * v
    return found


def close(margins: dict[str, np.ndarray], distance: float) -> np.ndarray:
    """Which states are so close to an edge. [N]."""
    return np.any([np.abs(one) < distance for one in margins.values()], axis=0)


def none_negative(margins: dict[str, np.ndarray]) -> np.ndarray:
    """Which states break no condition. [N]."""
    return np.all([one >= 0.0 for one in margins.values()], axis=0)


def units_of(shape: FullOrderConstants) -> dict[str, float]:
    """Units of the monitor's barriers, by name."""
    units = {row.name: row.reset for row in shape.barriers}
    return units | {"level-lower": 1.0, "level-upper": 1.0}
