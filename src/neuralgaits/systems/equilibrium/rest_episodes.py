"""Episodes in MuJoCo, with the robot file as it is: its ranges, its joint friction, its motor.

The controller computes the force from the measured state at each step of the simulator and holds it
until the next; MuJoCo clamps it at the motor's limit. The proof is about continuous time.
"""

import math
import time
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import jax
import mujoco
import numpy as np

from neuralgaits._types import Array, Float
from neuralgaits.records.record import Count, Record
from neuralgaits.robots.mjcf.compiled import compile_text
from neuralgaits.runs.names import ROBOT
from neuralgaits.systems.family_run import FamilyRun
from neuralgaits.systems.joint_map import JointMap

SECONDS = 20.0
"""Length of an episode [s]."""
AT_REST = 0.01
"""Radius within which an episode counts as at rest."""


@dataclass(frozen=True, eq=False, kw_only=True)
class RestEpisodes(Record):
    """Result of `simulate`.

    Attributes:
        run, robot: path of the run, and name of its robot.
        episodes: how many, each from a random state on the set's face unless it is the first.
        seconds: length of an episode.
        stayed: how many never left the set, never met a limit.
        largest_radius: over all times of all episodes; 1 is the set's face.
        last_radius: the largest at the end of an episode.
        settled_s: longest time until the radius was below 0.01 for good; None if one was not.
        largest_force: N, of the controller.
        force_limit: N, of the motor.
        clamped: share of ticks whose force was beyond the limit.
        wall_s: elapsed time.
    """

    run: str
    robot: str
    episodes: Count
    seconds: float
    stayed: Count
    largest_radius: float
    last_radius: float
    settled_s: float | None
    largest_force: float
    force_limit: float
    clamped: float
    wall_s: float


@dataclass(frozen=True)
class RestTrace:
    """One episode, a row a tick.

    Attributes:
        t: times [T].
        state: coordinates and their rates. [T, 4]
        radius: radius in the set's chart. [T]
        force: force of the controller before it is clamped [N]. [T]
    """

    t: Float[np.ndarray, " T"]
    state: Float[np.ndarray, "T 4"]
    radius: Float[np.ndarray, " T"]
    force: Float[np.ndarray, " T"]


RestLaw = Callable[[Float[Array, "4"]], tuple[Float[Array, ""], Float[Array, ""]]]
"""Function from a state to the force [N] and the square of the radius."""


def law_of(run: FamilyRun) -> RestLaw:
    """Return the controller of a run."""
    robot, controller = run.robot, run.controller

    def law(state: Float[Array, "4"]) -> tuple[Float[Array, ""], Float[Array, ""]]:
        force = robot.motion(controller.controls, state).force
        return force, controller.ball.radius_squared(state)

    return law


def traces_of(
    run: FamilyRun, starts: Iterable[Float[np.ndarray, "4"]], seconds: float
) -> list[RestTrace]:
    """Simulate an episode from each of some states; the controller is compiled once."""
    model = compile_text(run.folder.copy(ROBOT), run.config.robot)
    joints, law = run.data.joint_map(model), jax.jit(law_of(run))
    return [_trace_of(model, joints, law, start, seconds) for start in starts]


def _trace_of(
    model: mujoco.MjModel,
    joints: JointMap,
    law: RestLaw,
    start: Float[np.ndarray, "4"],
    seconds: float,
) -> RestTrace:
    world = mujoco.MjData(model)
    joints.write(model, world, start)
    rows = []
    for _ in range(round(seconds / model.opt.timestep)):
        state = joints.read(model, world)
        force, squared = law(state)
        rows.append((world.time, *state, math.sqrt(squared), float(force)))
        joints.push(world, float(force))
        mujoco.mj_step(model, world)
    table = np.array(rows)
    return RestTrace(table[:, 0], table[:, 1:5], table[:, 5], table[:, 6])


def settling_time(one: RestTrace) -> float | None:
    """Return the time after which the radius stays below `AT_REST` [s]; None if it does not."""
    # A radius that is no number is not small.
    above = np.flatnonzero(~(one.radius < AT_REST))
    if not len(above):
        return 0.0
    return None if above[-1] + 1 == len(one.t) else float(one.t[above[-1] + 1])


def simulate_at_rest(
    run: FamilyRun, *, episodes: int, seed: int, widest: int
) -> tuple[dict[str, Any], Sequence[RestTrace]]:
    """Simulate episodes.

    Args:
        run: the run.
        episodes: how many.
        seed: seed of the starts, random on the set's face.
        widest: coordinate of a state that is largest at the start of the first episode.

    Returns: the fields of a `RestEpisodes`, and the episodes.
    """
    start_time = time.perf_counter()
    starts = run.controller.ball.face(episodes, seed, widest)
    traces = traces_of(run, starts, SECONDS)
    limit = run.robot.force_limit
    force = np.concatenate([np.abs(one.force) for one in traces])
    settled = [settling_time(one) for one in traces]
    good = [one.radius.max() <= 1.0 + 1e-9 and np.abs(one.force).max() <= limit for one in traces]
    fields = {
        "run": str(run.path),
        "robot": run.config.robot,
        "episodes": len(traces),
        "seconds": SECONDS,
        "stayed": sum(map(bool, good)),
        "largest_radius": max(float(one.radius.max()) for one in traces),
        "last_radius": max(float(one.radius[-1]) for one in traces),
        "settled_s": None if None in settled else max(filter(None, settled), default=0.0),
        "largest_force": float(force.max()),
        "force_limit": limit,
        "clamped": float(np.mean(force > limit)),
        "wall_s": time.perf_counter() - start_time,
    }
    return fields, traces
