"""Walks of one round of episodes: they judge a policy and yield logs to learn from.

Ten walks start anywhere in the tube, and one at each of several speeds at z1 = 0. The first
seconds of all of them are logged, falls included; the outcome is judged over their whole length.
"""

import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import jax
import numpy as np

from neuralgaits import logs
from neuralgaits._quick_jit import quick_filter_jit
from neuralgaits._types import Array, Float
from neuralgaits.analysis.run import Run
from neuralgaits.control import AbstractLaw
from neuralgaits.control.controlled_gait import law_for
from neuralgaits.control.measurement import SensedRobot
from neuralgaits.errors import InputError
from neuralgaits.gait import ZeroDynamics
from neuralgaits.gait.zero_coordinates import momentum_of
from neuralgaits.logs import Log
from neuralgaits.logs.satisfaction import satisfaction
from neuralgaits.records.episode_records import Shares, WalkedRound
from neuralgaits.records.simulated import WalkFigures
from neuralgaits.simulation.episode_log import log_of
from neuralgaits.simulation.metrics import summary
from neuralgaits.simulation.native_walk import WalkEngine, engine_of_run
from neuralgaits.simulation.setup.disturbance import PlantChanges
from neuralgaits.simulation.setup.plant import PERIOD_S
from neuralgaits.simulation.setup.starts import full_states, momentum_range, periodic_orbit
from neuralgaits.simulation.walk import walk

STARTS = 10
"""Number of walks that start anywhere in the tube."""
STEPS = 200
"""Walking steps requested of each of these."""
SPEEDS = tuple(float(share) for share in np.linspace(0.8, 1.2, 10))
"""z2 of the starts at z1 = 0 that are judged, in units of the nominal z2."""
BEYOND = (0.5, 0.6, 0.7, 1.3, 1.4, 1.5)
"""Further values of z2 in the same units, which show how far the range reaches."""
SPEED_STEPS = 50
"""Walking steps requested of a walk that starts at one of the speeds; its transient is long over
by then."""
LOGGED_S = 60.0
"""Length of walking that a round may learn from [s]."""


@dataclass(frozen=True)
class Field:
    """Setting of the walks: plant, disturbance and controller.

    Attributes:
        plant: robot to simulate.
        disturbance: differences between the plant and the model.
        controller: control law, or its name.
    """

    plant: SensedRobot
    disturbance: PlantChanges
    controller: str | AbstractLaw


def nominal_momentum(run: Run) -> float:
    """Return z2 of the model's orbit at z1 = 0, or of the tube's middle if there is no orbit."""
    orbit = periodic_orbit(run.zero_dynamics, run.gait)
    if orbit.result == "found":
        return float(momentum_of(orbit.fixed_point))
    phase = float(run.gait.phase(jax.numpy.zeros(())))
    return float(run.gait.z(jax.numpy.array([phase, 0.5]))[1])


def walk_round(run: Run, field: Field, *, momentum: float, seed: int, folder: Path) -> WalkedRound:
    """Walk one policy, write the logs, and summarise the walks.

    Args:
        run: run whose policy walks.
        field: plant, disturbance and controller.
        momentum: z2 at z1 = 0 that is the unit of the speeds (kg m^2/s).
        seed: seed of starts and noise.
        folder: folder for the logs, one CSV file for each walk.
    """
    start_time = time.perf_counter()
    shares = sorted({*SPEEDS, *BEYOND})
    anywhere = full_states(run.zero_dynamics, run.gait, "region", seed=seed, episodes=STARTS)
    longest = LOGGED_S / (STARTS + len(shares))
    engine = engine_of_run(run)
    tried, logs = _walk(run, field, engine, anywhere, steps=STEPS, seed=seed, longest_s=longest)
    sped, more = _walk(
        run,
        field,
        engine,
        _at_speeds(run, momentum, shares),
        steps=SPEED_STEPS,
        # Noise and floors of its own.
        seed=seed + 1,
        longest_s=longest,
    )
    logs += more
    files = _write(logs, folder, run)
    up = [not fell for fell in sped.fell]
    stable = longest_run(shares, up)
    stayed_up = [stayed for share, stayed in zip(shares, up, strict=True) if share in SPEEDS]
    return WalkedRound(
        steps_walked=tried.steps_walked,
        share_that_walks=1.0 - float(np.mean(tried.fell)),
        fall_reasons=tried.fall_reasons,
        steps_walked_at={
            f"{share:.3f}": steps for share, steps in zip(shares, sped.steps_walked, strict=True)
        },
        share_of_speeds=float(np.mean(stayed_up)),
        momentum_range=stable,
        speed_range_m_s=None if stable is None else _speeds(run, momentum, stable),
        speed_m_s=tried.speed_m_s,
        barriers=_barrier_shares(run, logs),
        walked_s=float(sum(log.t[-1] - log.t[0] for log in logs)),
        logs=tuple(str(file) for file in files),
        logs_left_out=len(logs) - len(files),
        engine="jax" if engine.library is None else "native",
        engine_note=engine.note,
        wall_s=time.perf_counter() - start_time,
    )


def _walk(
    run: Run,
    field: Field,
    engine: WalkEngine,
    starts: Float[np.ndarray, "k two_n"],
    *,
    steps: int,
    seed: int,
    longest_s: float,
) -> tuple[WalkFigures, list[Log]]:
    """Return the figures of walks, and logs of the first seconds of each."""
    walk_result = walk(
        run.robot,
        run.gait.policy,
        starts,
        plant=field.plant,
        controller=law_for(field.controller, run.robot, run.gait),
        steps=steps,
        z2_range=momentum_range(run.gait),
        disturbance=field.disturbance,
        seed=seed,
        longest=int(longest_s / PERIOD_S),
        library=engine.library,
    )
    records = walk_result.episodes.records
    return summary(walk_result), [
        log_of(run.robot.joint_names, record, "walk") for record in records
    ]


def logs_of(logs: Path, number: int) -> list[Path]:
    """Return the logs of a round. Raises: InputError if there are none."""
    place = logs / f"round-{number}"
    if number == 0 and not place.is_dir():
        place = logs
    files = sorted([*place.glob("*.csv"), *place.glob("*.mcap")])
    if not files:
        message = "none" if place.is_dir() else "no such folder"
        raise InputError(
            f"expected logs *.csv or *.mcap in {place}, found {message}: put the robot's there"
        )
    return files


def logged_round(run: Run, files: Sequence[Path], columns: str | Path | None = None) -> WalkedRound:
    """Summarise a robot's own logs as a round: each file counts as one walk, falls are unknown.

    `columns` is a file that describes the columns of the logs, see `logs.read`.
    """
    start_time = time.perf_counter()
    read, _ = logs.read_all(files, run.robot, columns=columns, policy=run.gait.policy)
    strides = [np.flatnonzero(np.diff(log.stance)) for log in read]
    return WalkedRound(
        steps_walked=tuple(len(touchdowns) for touchdowns in strides),
        share_that_walks=None,
        speed_range_m_s=None,
        barriers=_barrier_shares(run, read),
        walked_s=float(sum(log.t[-1] - log.t[0] for log in read)),
        logs=tuple(str(file) for file in files),
        wall_s=time.perf_counter() - start_time,
    )


def _barrier_shares(run: Run, walks: Sequence[Log]) -> Shares:
    zd = ZeroDynamics(run.robot, run.gait.policy)
    return Shares(**satisfaction(walks, zd, run.gait, run.spec)._asdict())


def _at_speeds(run: Run, momentum: float, shares: Sequence[float]) -> Float[np.ndarray, "k two_n"]:
    """Return full states of the model's zero dynamics at z1 = 0, at shares of the momentum."""
    zd = ZeroDynamics(run.robot, run.gait.policy)
    z = np.array([[0.0, share * momentum] for share in shares])
    return np.asarray(_phi_inv(zd, z))


def _speeds(run: Run, momentum: float, shares: tuple[float, float]) -> tuple[float, float]:
    """Return dz1 at z1 = 0 for two shares of the momentum (m/s)."""
    zd = ZeroDynamics(run.robot, run.gait.policy)
    z = np.array([[0.0, share * momentum] for share in shares])
    low, high = (float(speed) for speed in np.asarray(_zdot(zd, z))[:, 0])
    return low, high


@quick_filter_jit
def _phi_inv(zd: ZeroDynamics, z: Array) -> Array:
    return jax.vmap(lambda one: zd.phi_inv(one))(z)


@quick_filter_jit
def _zdot(zd: ZeroDynamics, z: Array) -> Array:
    return jax.vmap(lambda one: zd.zdot(one))(z)


def longest_run(shares: Sequence[float], up: Sequence[bool]) -> tuple[float, float] | None:
    """Return the ends of the longest run of neighbouring speeds that all walked, or None."""
    best: list[float] = []
    current: list[float] = []
    for share, stayed in zip(shares, up, strict=True):
        current = [*current, share] if stayed else []
        best = max(best, current, key=len)
    return (best[0], best[-1]) if best else None


def _write(walks: Sequence[Log], folder: Path, run: Run) -> list[Path]:
    """Write the logs that can be learned from, and return their paths.

    The other logs hold no complete stride, or a fall in which the foot moved so far that z2 no
    longer describes the robot.
    """
    files = []
    for number, log in enumerate(walks):
        file = folder / f"walk-{number:02d}.csv"
        logs.write(file, log)
        try:
            logs.read(file, run.robot)
        except InputError:
            file.unlink()
        else:
            files.append(file)
    return files
