"""Closed-form mass matrix and bias beside MuJoCo's: worst error, and time per state.

Asked: at most 1e-9 relative, 1000 random states, the built-in robots and 20 random bipeds. The
error is measured in the pinned coordinates q, into which MuJoCo's floating base is projected; the
time of MuJoCo is its position and velocity pass (which also finds the bias of the floating base,
inertias and Jacobians) and the dense mass matrix, in C on one core, called from Python.
"""

import time

import common  # noqa: F401  Sets double precision.
import jax
import mujoco
import numpy as np
from common import show

from neuralgaits.robots import PlanarBiped, built_in, load_robot
from neuralgaits.robots.mjcf.loader import robot_from_text

# The independent road to the same matrices, and the random robots, are those of the tests.
from support.floating_base import FloatingBase
from support.random_biped import catalogue

STATES = 1000
BATCH = 4096
RANDOM_BIPEDS = 20


def main() -> None:
    """Print the worst errors and the times."""
    robots = {name: load_robot(name) for name in built_in()}
    errors = {name: worst_error(robot) for name, robot in robots.items()}
    for name, error in errors.items():
        show(f"{name}: D and bias, worst relative error", error, "<= 1e-9")
    bipeds = {name: robot_from_text(text, name) for name, text in catalogue(RANDOM_BIPEDS).items()}
    random = {name: worst_error(robot) for name, robot in bipeds.items()}
    name = max(random, key=random.__getitem__)
    show(f"{len(random)} random bipeds: D and bias, worst ({name})", random[name], "<= 1e-9")
    robot = robots["amber3m"]
    closed, reference = closed_form_us(robot), mujoco_us(robot)
    show("amber3m: closed form, jit(vmap), float64, us a state", closed)
    show("amber3m: MuJoCo, fullM and qfrc_bias, us a state", reference)
    show("MuJoCo / closed form", reference / closed)


def worst_error(robot: PlanarBiped) -> float:
    """Largest error over largest entry, mass matrix and bias, over random states."""
    q, dq = random_states(robot, STATES)
    mass = np.asarray(jax.vmap(robot.mass_matrix)(q))
    bias = np.asarray(jax.vmap(robot.bias)(q, dq))
    base, worst = FloatingBase.of(robot), 0.0
    for i in range(STATES):
        pinned = base.pinned(q[i], dq[i], i % 2)
        for ours, theirs in ((mass[i], pinned.mass_matrix), (bias[i], pinned.bias)):
            worst = max(worst, np.max(np.abs(ours - theirs)) / np.max(np.abs(theirs)))
    return float(worst)


def random_states(robot: PlanarBiped, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Angles within +-1.5 rad and normal rates of 3 rad/s. [count, n] each."""
    rng = np.random.default_rng(0)
    return rng.uniform(-1.5, 1.5, (count, robot.n)), rng.normal(0.0, 3.0, (count, robot.n))


def closed_form_us(robot: PlanarBiped, repeats: int = 50) -> float:
    """Median time of mass matrix and bias for one state of a batch (us)."""
    q, dq = random_states(robot, BATCH)

    @jax.jit
    @jax.vmap
    def both(q, dq):
        return robot.mass_matrix(q), robot.bias(q, dq)

    jax.block_until_ready(both(q, dq))
    times = []
    for _ in range(repeats):
        start_time = time.perf_counter()
        jax.block_until_ready(both(q, dq))
        times.append(time.perf_counter() - start_time)
    return 1e6 * float(np.median(times)) / BATCH


def mujoco_us(robot: PlanarBiped) -> float:
    """Median time of positions, velocities, dense mass matrix and bias of one state (us)."""
    base = FloatingBase.of(robot)
    qpos, qvel = base.states.to_mjcf(*random_states(robot, BATCH), 0)
    model, data = base.model, base.data
    full = np.zeros((model.nv, model.nv))
    times = []
    for position, velocity in zip(qpos, qvel, strict=True):
        data.qpos[:], data.qvel[:] = position, velocity
        start_time = time.perf_counter()
        mujoco.mj_fwdPosition(model, data)
        mujoco.mj_fwdVelocity(model, data)
        mujoco.mj_fullM(model, data, full)
        times.append(time.perf_counter() - start_time)
    return 1e6 * float(np.median(times))


if __name__ == "__main__":
    main()
