"""The formulas beside MuJoCo: a file is a cart-pole if both accelerate it alike.

A file can hold more than any list of refusals names: gravity compensation, a wall on the rail,
switched-off forces, polynomials of damping, friction in a motor. What moves the joints shows in
their accelerations, so these are compared all over the rail and the pole's range.
"""

# pyright: reportAttributeAccessIssue=false
# MuJoCo ships no type stubs.

import itertools

import mujoco
import numpy as np

from neuralgaits._types import Float
from neuralgaits.systems.cartpole.cartpole_data import CartPoleData

SHARES = (-0.98, -0.7, -0.35, 0.0, 0.35, 0.7, 0.98)
"""Places of cart and pole, as shares of rail and lean."""
RATES = ((0.0, 0.0), (0.8, -1.7), (-1.3, 2.1))
"""Rates of slide [m/s] and hinge [rad/s]."""
FORCES = (-1.0, 0.4, 1.0)
"""Forces, as shares of the motor's limit."""
LEANS, STEPS = (0.0, 0.1), 60
"""Where the pole is let go, as shares of lean, and for how many of MuJoCo's steps."""
ALIKE = 1e-7
"""Largest difference of accelerations that is rounding, as a share of the largest there."""


def difference_from_mujoco(
    model: mujoco.MjModel, data: CartPoleData, parts: tuple[int, int, int]
) -> tuple[float, float, float] | None:
    """Compare the formulas' accelerations with MuJoCo's.

    Args:
        model: of the file.
        data: numbers that were read from it.
        parts: numbers of slide, hinge and motor.

    What acts later than at once shows where MuJoCo goes on by itself for a while.

    Returns: None if they agree; else the share by which they differ, and x [m] from the middle of
        the rail and theta [rad] where that is largest.
    """
    slide, hinge, motor = parts
    world, worst = mujoco.MjData(model), (0.0, 0.0, 0.0)
    places, rates = model.jnt_qposadr[[slide, hinge]], model.jnt_dofadr[[slide, hinge]]
    middle, rail = 0.5 * (data.rail_low + data.rail_high), 0.5 * (data.rail_high - data.rail_low)
    for x_share, lean_share, (velocity, turning), force_share in itertools.product(
        SHARES, SHARES, RATES, FORCES
    ):
        x, theta, force = x_share * rail, lean_share * data.lean, force_share * data.force_limit
        mujoco.mj_resetData(model, world)
        world.qpos[places] = [middle + x, data.upright + data.turn * theta]
        world.qvel[rates] = [velocity, data.turn * turning]
        world.ctrl[motor] = force / data.gear
        mujoco.mj_forward(model, world)
        found = world.qacc[rates] * [1.0, data.turn]
        share = _differ(data, found, theta, velocity, turning, force)
        if not share <= worst[0]:
            worst = share, x, theta
    for lean_share in LEANS:
        mujoco.mj_resetData(model, world)
        world.qpos[places] = [middle, data.upright + data.turn * lean_share * data.lean]
        for _ in range(STEPS):
            mujoco.mj_step(model, world)
            # Integrators of several stages leave the accelerations of the last one.
            mujoco.mj_forward(model, world)
            (x, angle), (velocity, turning) = world.qpos[places], world.qvel[rates]
            theta, turning = data.turn * (angle - data.upright), data.turn * turning
            if not (abs(x - middle) < 0.98 * rail and abs(theta) < 0.98 * data.lean):
                break
            found = world.qacc[rates] * [1.0, data.turn]
            share = _differ(data, found, theta, velocity, turning, 0.0)
            if not share <= worst[0]:
                worst = share, x - middle, theta
    return None if worst[0] <= ALIKE else worst


def _differ(
    data: CartPoleData,
    found: Float[np.ndarray, "2"],
    theta: float,
    velocity: float,
    turning: float,
    force: float,
) -> float:
    """Return how far MuJoCo's accelerations are from the formulas', as a share of these."""
    expected = _accelerations(data, theta, velocity, turning, force)
    return float(np.max(np.abs(found - expected)) / max(1.0, np.max(np.abs(expected))))


def colliding(model: mujoco.MjModel) -> tuple[str, str] | None:
    """Return the names of two geoms that can collide; None if no two can.

    A thin wall may lie between the places where accelerations are compared. MuJoCo's own rules:
    https://mujoco.readthedocs.io/en/stable/computation/index.html#collision-detection
    """
    if model.opt.disableflags & mujoco.mjtDisableBit.mjDSBL_CONTACT:
        return None
    weld = model.body_weldid[model.geom_bodyid]
    above = model.body_weldid[model.body_parentid[weld]]
    kinds, meets = model.geom_contype, model.geom_conaffinity
    excluded = set(model.exclude_signature.tolist())
    for first in range(model.ngeom):
        rest = np.arange(first + 1, model.ngeom)
        alike = (kinds[first] & meets[rest]) | (kinds[rest] & meets[first])
        family = (weld[first] == above[rest]) | (weld[rest] == above[first])
        # A child may meet its parent if that is the world.
        family &= (weld[first] != 0) & (weld[rest] != 0)
        if model.opt.disableflags & mujoco.mjtDisableBit.mjDSBL_FILTERPARENT:
            family[:] = False
        for second in rest[(alike != 0) & (weld[first] != weld[rest]) & ~family]:
            low, high = sorted((int(model.geom_bodyid[first]), int(model.geom_bodyid[second])))
            if (low << 16) + high not in excluded:
                names = [model.geom(one).name or f"number {one}" for one in (first, second)]
                return names[0], names[1]
    return None


def _accelerations(
    data: CartPoleData, theta: float, velocity: float, turning: float, force: float
) -> Float[np.ndarray, "2"]:
    """Return x'' [m/s^2] and theta'' [rad/s^2] of a state under a force."""
    robot = data.model("")
    sine, coupling = np.sin(theta), robot.moment * np.cos(theta)
    masses = np.array([[robot.mass, coupling], [coupling, robot.inertia]])
    on_cart = force - robot.cart_damping * velocity + robot.moment * sine * turning**2
    on_pole = robot.moment * robot.gravity * sine - robot.pole_damping * turning
    return np.linalg.solve(masses, np.array([on_cart, on_pole]))
