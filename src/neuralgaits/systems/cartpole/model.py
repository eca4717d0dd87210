"""The rigid cart-pole: its numbers, its flow under a policy, and the force that this takes.

Coordinates are y = (x, theta, s, e): the cart's position from the middle of its rail [m], the
pole's angle from the upright, positive where it leans forward [rad], the momentum conjugate to it
[kg m^2/s], and the error of the cart's velocity, x' - v_d(x, theta, s) [m/s]. They are coordinates
of the full state, everywhere: theta' follows from s, and x' = v_d + e.
"""

from typing import NamedTuple

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np

from neuralgaits._types import Array, Float
from neuralgaits.systems.cartpole.policy import VelocityPolicy

STATES = ("x", "theta", "s", "e")


class CartPole(eqx.Module):
    """Numbers of a cart-pole, in SI units.

    Attributes:
        mass: of cart and pole, with the rotor's reflected mass.
        moment: the pole's mass times the distance of its centre of mass from the hinge [kg m].
        inertia: of the pole about the hinge, with the hinge's armature [kg m^2].
        cart_damping, pole_damping: viscous, of the two joints [N s/m, N m s].
        gravity: acceleration of gravity.
        rail: largest distance of the cart from the middle of its rail [m].
        lean: largest angle of the pole from the upright that its joint has room for [rad].
        force_limit: largest force of the motor on the cart [N].
        name: of the robot.
    """

    mass: float
    moment: float
    inertia: float
    cart_damping: float
    pole_damping: float
    gravity: float
    rail: float
    lean: float
    force_limit: float
    name: str = eqx.field(static=True)


class Motion(NamedTuple):
    """Flow at one state, and the force that it takes [N]."""

    rates: Float[Array, "4"]
    force: Float[Array, ""]


def motion(
    robot: CartPole, policy: VelocityPolicy, decay: Float[Array, ""], y: Float[Array, "4"]
) -> Motion:
    """Return the closed loop's flow in y, where e' = -decay e, and its force."""
    z, error = y[:3], y[3]
    theta, velocity = z[1], policy(z) + error
    sine, coupling = jnp.sin(theta), robot.moment * jnp.cos(theta)
    turning = (z[2] - coupling * velocity) / robot.inertia
    falling = robot.moment * sine * robot.gravity - robot.pole_damping * turning
    rates = jnp.stack([velocity, turning, falling - robot.moment * sine * turning * velocity])
    _, desired = jax.jvp(policy, (z,), (rates,))
    acceleration = desired - decay * error
    # The equation of the cart, with the pole's angular acceleration put in from that of the pole.
    force = (
        (robot.mass - coupling * coupling / robot.inertia) * acceleration
        + coupling * falling / robot.inertia
        - robot.moment * sine * turning * turning
        + robot.cart_damping * velocity
    )
    return Motion(jnp.append(rates, -decay * error), force)


def coordinates(
    robot: CartPole, policy: VelocityPolicy, state: Float[Array, "4"]
) -> Float[Array, "4"]:
    """Return y of a measured state (x, theta, x', theta')."""
    x, theta, velocity, turning = state
    momentum = robot.inertia * turning + robot.moment * jnp.cos(theta) * velocity
    z = jnp.stack([x, theta, momentum])
    return jnp.append(z, velocity - policy(z))


def measured(
    robot: CartPole, policy: VelocityPolicy, y: Float[Array, "4"]
) -> Float[Array, "4"]:
    """Return the state (x, theta, x', theta') with these coordinates: the inverse of those."""
    velocity = policy(y[:3]) + y[3]
    turning = (y[2] - robot.moment * jnp.cos(y[1]) * velocity) / robot.inertia
    return jnp.stack([y[0], y[1], velocity, turning])


def linearised(robot: CartPole) -> tuple[np.ndarray, np.ndarray]:
    """Return A [3, 3] and B [3] of z' = A z + B x' at the upright, z = (x, theta, s)."""
    across = robot.moment / robot.inertia
    a = np.zeros((3, 3))
    a[1, 2] = 1.0 / robot.inertia
    a[2] = [0.0, robot.moment * robot.gravity, -robot.pole_damping / robot.inertia]
    return a, np.array([1.0, -across, robot.pole_damping * across])
