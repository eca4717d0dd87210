"""The rigid cart-pole: its numbers, its flow under a policy, and the force that this takes.

A state is (x, theta, x', theta'): the cart's position from the middle of its rail [m], the pole's
angle from the upright, positive where it leans forward [rad], and their rates. The zero dynamics'
state is z = (x, theta, s), with s = J theta' + m l cos(theta) x' the momentum conjugate to theta
[kg m^2/s]: no motor acts on it. The output is e = x' - v_d(z), the error of the cart's velocity.
"""

from typing import NamedTuple

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np

from neuralgaits._types import Array, Float
from neuralgaits.systems.cartpole.velocity_policy import Controls


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
    """Rates of a state (x, theta, x', theta'), and the force that they take [N]."""

    rates: Float[Array, "4"]
    force: Float[Array, ""]


def motion(robot: CartPole, controls: Controls, state: Float[Array, "4"]) -> Motion:
    """Return the closed loop's flow: the force is the one with which e' = -decay(z, e) e."""
    _, theta, velocity, turning = state
    sine, coupling = jnp.sin(theta), robot.moment * jnp.cos(theta)
    z = zero_state(robot, state)
    falling = robot.moment * sine * robot.gravity - robot.pole_damping * turning
    dz = jnp.stack([velocity, turning, falling - robot.moment * sine * turning * velocity])
    desired, slope = jax.jvp(controls.policy, (z,), (dz,))
    error = velocity - desired
    acceleration = slope - controls.decay(jnp.append(z, error)) * error
    angular = (falling - coupling * acceleration) / robot.inertia
    # The equation of the cart, with the pole's angular acceleration put in from that of the pole.
    force = (
        (robot.mass - coupling * coupling / robot.inertia) * acceleration
        + coupling * falling / robot.inertia
        - robot.moment * sine * turning * turning
        + robot.cart_damping * velocity
    )
    return Motion(jnp.stack([velocity, turning, acceleration, angular]), force)


def zero_state(robot: CartPole, state: Float[Array, "4"]) -> Float[Array, "3"]:
    """Return the zero dynamics' state (x, theta, s)."""
    x, theta, velocity, turning = state
    momentum = robot.inertia * turning + robot.moment * jnp.cos(theta) * velocity
    return jnp.stack([x, theta, momentum])


def linearised(robot: CartPole) -> tuple[np.ndarray, np.ndarray]:
    """Return A [3, 3] and B [3] of z' = A z + B x' at the upright, z = (x, theta, s)."""
    across = robot.moment / robot.inertia
    a = np.zeros((3, 3))
    a[1, 2] = 1.0 / robot.inertia
    a[2] = [0.0, robot.moment * robot.gravity, -robot.pole_damping / robot.inertia]
    return a, np.array([1.0, -across, robot.pole_damping * across])
