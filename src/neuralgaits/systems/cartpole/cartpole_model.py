"""The rigid cart-pole: its numbers, its flow under a policy, and the force that this takes.

A state is (x, theta, x', theta'): the cart's position from the middle of its rail [m], the pole's
angle from the upright, positive where it leans forward [rad], and their rates. The zero dynamics'
state is z = (x, theta, s), with s = J theta' + m l cos(theta) x' the momentum conjugate to theta
[kg m^2/s]: no motor acts on it. The output is e = x' - v_d(z), the error of the cart's velocity.
"""

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np

from neuralgaits._types import Array, Float
from neuralgaits.systems.equilibrium.radial_conditions import Motion
from neuralgaits.systems.equilibrium.velocity_policy import Controls


class CartPole(eqx.Module):
    """Numbers of a cart-pole, in SI units.

    Attributes:
        mass: mass of cart and pole, with the rotor's reflected mass.
        moment: the pole's mass times the distance of its centre of mass from the hinge [kg m].
        inertia: inertia of the pole about the hinge, with the hinge's armature [kg m^2].
        cart_damping, pole_damping: viscous, of the two joints [N s/m, N m s].
        gravity: acceleration of gravity.
        rail: largest distance of the cart from the middle of its rail [m].
        lean: largest angle of the pole from the upright that its joint has room for [rad].
        force_limit: largest force of the motor on the cart [N].
        name: name of the robot.
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

    def motion(self, controls: Controls, state: Float[Array, "4"]) -> Motion:
        """Return the closed loop's flow: the force is the one with which e' = -decay(z, e) e."""
        _, theta, velocity, turning = state
        sine, coupling = jnp.sin(theta), self.moment * jnp.cos(theta)
        z = self.zero_state(state)
        falling = self.moment * sine * self.gravity - self.pole_damping * turning
        dz = jnp.stack([velocity, turning, falling - self.moment * sine * turning * velocity])
        desired, slope = jax.jvp(controls.policy, (z,), (dz,))
        error = velocity - desired
        acceleration = slope - controls.decay(jnp.append(z, error)) * error
        angular = (falling - coupling * acceleration) / self.inertia
        # The equation of the cart, with the pole's angular acceleration put in from the pole's.
        force = (
            (self.mass - coupling * coupling / self.inertia) * acceleration
            + coupling * falling / self.inertia
            - self.moment * sine * turning * turning
            + self.cart_damping * velocity
        )
        return Motion(jnp.stack([velocity, turning, acceleration, angular]), force)

    def limit_shares(self, state: Float[Array, "4"], force: Float[Array, ""]) -> dict[str, Array]:
        """Return the share of each limit that is reached, by the name of its condition."""
        return {
            "force": force / self.force_limit,
            "rail": state[0] / self.rail,
            "upright": state[1] / self.lean,
        }

    def zero_state(self, state: Float[Array, "4"]) -> Float[Array, "3"]:
        """Return the zero dynamics' state (x, theta, s)."""
        x, theta, velocity, turning = state
        momentum = self.inertia * turning + self.moment * jnp.cos(theta) * velocity
        return jnp.stack([x, theta, momentum])

    def linearised(self) -> tuple[np.ndarray, np.ndarray]:
        """Return A [3, 3] and B [3] of z' = A z + B x' at the upright, z = (x, theta, s)."""
        across = self.moment / self.inertia
        a = np.zeros((3, 3))
        a[1, 2] = 1.0 / self.inertia
        a[2] = [0.0, self.moment * self.gravity, -self.pole_damping / self.inertia]
        return a, np.array([1.0, -across, self.pole_damping * across])

    def accelerations(self, state: Float[np.ndarray, "4"], force: float) -> Float[np.ndarray, "2"]:
        """Return x'' [m/s^2] and theta'' [rad/s^2] of a state under a force."""
        _, theta, velocity, turning = state
        sine, coupling = np.sin(theta), self.moment * np.cos(theta)
        masses = np.array([[self.mass, coupling], [coupling, self.inertia]])
        on_cart = force - self.cart_damping * velocity + self.moment * sine * turning**2
        on_pole = self.moment * self.gravity * sine - self.pole_damping * turning
        return np.linalg.solve(masses, np.array([on_cart, on_pole]))
