"""The controller in C: the law `pd` on the right foot as a function, and a tick on either foot."""

from collections.abc import Callable
from pathlib import Path

import jax
import jax.numpy as jnp
import numpy as np

from neuralgaits._blocks import in_blocks
from neuralgaits._quick_jit import quick_jit
from neuralgaits._types import Array, Float
from neuralgaits.systems.controller_header import ControllerHeader
from neuralgaits.systems.family_run import FamilyRun
from neuralgaits.systems.walker3d.spatial_changes import TICK_S
from neuralgaits.systems.walker3d.spatial_laws import (
    Measured,
    exact_reading,
    hips_of,
    joint_gains,
    pd_law,
)
from neuralgaits.systems.walker3d.spatial_walks import LANDING

ABOUT = """State: roll and pitch of the torso, then hip roll, hip pitch and knee of stance leg and
 * swing leg; the rates of these eight; velocity of the middle of the hips, forward, left and up;
 * 1 if that is measured, 0 if the stance foot counts as at rest{told}.
 * The stance leg is the right one: reflect a robot on its left foot. In rad, rad/s and m/s.
 * Torques, stance leg first [N m], not limited. z: hip from stance foot, forward and to the left
 * [m], and momenta about that foot, L_y and -L_x [kg m^2/s]. Phase: 0 at the start of a step, 1 at
 * its end"""
TOLD = """;
 * the speeds told to the step before and to this one"""
"""What the state has more of a gait that is told its speed."""


def header_of(run: FamilyRun) -> ControllerHeader:
    """Return names and numbers of the exported controller."""
    robot, command = run.robot, run.controller.command
    roll, pitch, knee = (float(limit) for limit in robot.torque_limits)
    constants = {
        "PERIOD": (TICK_S, "s, from tick to tick"),
        "LANDING": (LANDING, "phase before which contact is no touchdown"),
        "STATE": (run.system.state_size_of(run.config), "numbers of a state"),
        "ROLL_LIMIT": (roll, "N m, of a hip's roll motor"),
        "PITCH_LIMIT": (pitch, "N m, of a hip's pitch motor"),
        "KNEE_LIMIT": (knee, "N m, of a knee's motor"),
    }
    if command is not None:
        constants["SPEED_LOW"] = (command.low, "m/s, slowest speed that the gait is told")
        constants["SPEED_HIGH"] = (command.high, "m/s, fastest")
        constants["SPEED_CHANGE"] = (command.change_limit, "m/s, largest change a step")
    folder = Path(__file__).with_name("c_files")
    # Files that are the same for every biped, in the folder `c_files` beside this file.
    more_files = ("walker3d_tick.h", "walker3d_tick.c", "README.md")
    return ControllerHeader(
        file="walker3d",
        function="ng_walker3d_law",
        title=f"the biped {run.config.robot}",
        about=ABOUT.format(told="" if command is None else TOLD),
        advice="Call ng_walker3d_tick of walker3d_tick.h",
        constants=constants,
        output="torques",
        unit="N m",
        limit=max(roll, pitch, knee),
        proved="its projected\n * hybrid zero dynamics, the yaw held, not of `pd` or sampling",
        more={name: (folder / name).read_text(encoding="utf-8") for name in more_files},
    )


def law_of(run: FamilyRun) -> Callable[[Float[Array, " n"]], dict[str, Array]]:
    """Return the function that is written in C."""
    robot, gait = run.robot, run.controller
    typical = gait.typical
    gains = joint_gains(robot, typical.policy, typical.start)

    def law(state: Float[Array, " n"]) -> dict[str, Array]:
        policy = gait.step(state[20:]).policy
        joints, rates, velocity = state[:8], state[8:16], state[16:19]
        resting = jax.jvp(lambda q: hips_of(robot, q)[1], (joints,), (rates,))[1]
        used = resting + state[19] * (velocity - resting)
        demand = pd_law(robot, policy, gains, Measured(joints, rates, used))
        return {"torques": demand.torques, "z": demand.z, "phase": policy.phase(demand.z)}

    return law


def random_states(run: FamilyRun, count: int, seed: int) -> Float[np.ndarray, "count n"]:
    """Return states near those of the tube, every second one without a measured velocity."""
    draw = np.random.default_rng(seed)
    robot, gait, command = run.robot, run.controller, run.controller.command
    points = draw.uniform(size=(count, 4))
    pairs = np.zeros((count, 0))
    if command is not None:
        before = draw.uniform(command.low, command.high, count)
        change = draw.uniform(-command.change_limit, command.change_limit, count)
        pairs = np.stack([before, np.clip(before + change, command.low, command.high)], axis=1)

    def full(u: Float[Array, "4"], pair: Float[Array, " k"]) -> Float[Array, "19"]:
        step = gait.step(pair)
        return jnp.concatenate(exact_reading(robot, step.policy, step.state_at(u)))

    rows = in_blocks(quick_jit(jax.vmap(full)), 200, points, pairs)
    # Deviations of the states at which an export is compared, of angles [rad], rates [rad/s] and
    # velocities [m/s], about those of the gait.
    spread = np.array([0.01, 0.02, 0.01])
    rows = rows + draw.standard_normal(rows.shape) * np.repeat(spread, (8, 8, 3))
    return np.concatenate([rows, np.arange(count)[:, None] % 2.0, pairs], axis=1)
