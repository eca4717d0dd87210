"""Episodes in MuJoCo, with the robot file as it is: its rail, its joint friction, its motor.

The controller computes the force from the measured state at each step of the simulator and holds it
until the next; MuJoCo clamps it at the motor's limit. The proof is about continuous time.
"""

# pyright: reportAttributeAccessIssue=false
# MuJoCo ships no type stubs.

import math
import time
from collections.abc import Callable
from dataclasses import dataclass

import jax
import jax.numpy as jnp
import mujoco
import numpy as np

from neuralgaits._types import Array, Float
from neuralgaits.records.record import Count, Record
from neuralgaits.robots.mjcf.compiled import compile_text
from neuralgaits.runs.names import ROBOT
from neuralgaits.systems.cartpole.cartpole_model import motion
from neuralgaits.systems.cartpole.cartpole_run import CartPoleRun
from neuralgaits.systems.cartpole.mjcf import parts_of

SECONDS = 20.0
"""Length of an episode [s]."""
AT_REST = 0.01
"""Radius within which an episode counts as at rest."""


@dataclass(frozen=True, eq=False, kw_only=True)
class CartPoleEpisodes(Record):
    """Result of `simulate`.

    Attributes:
        run, robot: of the run.
        episodes: how many, each from a random state on the set's face unless it is the first.
        seconds: length of an episode.
        stayed: how many never left the set, never met a limit.
        largest_radius: over all times of all episodes; 1 is the set's face.
        last_radius: the largest at the end of an episode.
        settled_s: longest time until the radius was below 0.01 for good; None if one was not.
        largest_force: N, of the controller.
        force_limit: N, of the motor.
        clamped: share of ticks whose force was beyond the limit.
        largest_x, rail: of the cart from the middle of its rail, and half the rail's length (m).
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
    largest_x: float
    rail: float
    wall_s: float


@dataclass(frozen=True)
class Trace:
    """One episode, a row a tick.

    Attributes:
        t: times [T].
        state: (x, theta, x', theta'). [T, 4]
        radius: of the set's chart. [T]
        force: of the controller, before it is clamped [N]. [T]
    """

    t: Float[np.ndarray, " T"]
    state: Float[np.ndarray, "T 4"]
    radius: Float[np.ndarray, " T"]
    force: Float[np.ndarray, " T"]


Law = Callable[[Float[Array, "4"]], tuple[Float[Array, ""], Float[Array, ""]]]
"""Function from (x, theta, x', theta') to the force [N] and the square of the radius."""


def law_of(run: CartPoleRun) -> Law:
    """Return the controller of a run."""
    robot, controller = run.robot, run.controller

    def law(state: Float[Array, "4"]) -> tuple[Float[Array, ""], Float[Array, ""]]:
        force = motion(robot, controller.controls, state).force
        known: list[Array] = []
        for row in range(4):
            left = state[row] - sum(controller.ball.shape[row, k] * known[k] for k in range(row))
            known.append(left / controller.ball.shape[row, row])
        return force, jnp.sum(jnp.square(jnp.stack(known)))

    return law


def simulate_cartpole(run: CartPoleRun, *, episodes: int = 1, seed: int = 0) -> CartPoleEpisodes:
    """Simulate episodes. The first starts on the face where the pole leans most.

    Args:
        run: the run.
        episodes: how many.
        seed: of the other starts, random on the set's face.
    """
    start_time = time.perf_counter()
    found = [trace_of(run, start, SECONDS) for start in starts(run, episodes, seed)]
    limit = run.robot.force_limit
    radius = [float(one.radius.max()) for one in found]
    force = np.concatenate([np.abs(one.force) for one in found])
    settled = [settling_time(one) for one in found]
    good = [one.radius.max() <= 1.0 + 1e-9 and np.abs(one.force).max() <= limit for one in found]
    return CartPoleEpisodes(
        run=str(run.path),
        robot=run.config.robot,
        episodes=len(found),
        seconds=SECONDS,
        stayed=sum(map(bool, good)),
        largest_radius=max(radius),
        last_radius=max(float(one.radius[-1]) for one in found),
        settled_s=None if None in settled else max(filter(None, settled), default=0.0),
        largest_force=float(force.max()),
        force_limit=limit,
        clamped=float(np.mean(force > limit)),
        largest_x=max(float(np.abs(one.state[:, 0]).max()) for one in found),
        rail=run.robot.rail,
        wall_s=time.perf_counter() - start_time,
    )


def starts(run: CartPoleRun, count: int, seed: int) -> Float[np.ndarray, "N 4"]:
    """Return initial states (x, theta, x', theta') on the set's face."""
    shape = np.asarray(run.controller.ball.shape)
    normal = np.random.default_rng(seed).standard_normal((count, 4))
    # Where theta is largest on the ellipsoid.
    normal[0] = shape[1]
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    return normal @ shape.T


def trace_of(run: CartPoleRun, start: Float[np.ndarray, "4"], seconds: float) -> Trace:
    """Simulate one episode from a state (x, theta, x', theta')."""
    model, data, law = (
        compile_text(run.folder.copy(ROBOT), run.config.robot),
        run.data,
        _jitted(run),
    )
    world, middle = mujoco.MjData(model), 0.5 * (data.rail_low + data.rail_high)
    # By number: names are optional in MJCF.
    slide, hinge, motor = parts_of(model)
    places, rates = model.jnt_qposadr[[slide, hinge]], model.jnt_dofadr[[slide, hinge]]
    world.qpos[places] = [middle + start[0], data.upright + data.turn * start[1]]
    world.qvel[rates] = [start[2], data.turn * start[3]]
    rows = []
    for _ in range(round(seconds / model.opt.timestep)):
        x, angle = world.qpos[places]
        velocity, turning = world.qvel[rates]
        state = np.array(
            [x - middle, data.turn * (angle - data.upright), velocity, data.turn * turning]
        )
        force, squared = law(state)
        rows.append((world.time, *state, math.sqrt(squared), float(force)))
        world.ctrl[motor] = float(force) / data.gear
        mujoco.mj_step(model, world)
    table = np.array(rows)
    return Trace(table[:, 0], table[:, 1:5], table[:, 5], table[:, 6])


def _jitted(run: CartPoleRun) -> Law:
    return jax.jit(law_of(run))


def settling_time(one: Trace) -> float | None:
    """Return the time after which the radius stays below `AT_REST` [s]; None if it does not."""
    # A radius that is no number is not small.
    above = np.flatnonzero(~(one.radius < AT_REST))
    if not len(above):
        return 0.0
    return None if above[-1] + 1 == len(one.t) else float(one.t[above[-1] + 1])
