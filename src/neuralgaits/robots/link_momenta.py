"""Momenta and generalised forces of a biped's links alone, as in the equations of its joints.

With L the Lagrangian of the links, without rotors and friction, a joint obeys
d/dt dL/d(dq_j) = dL/dq_j + its torque.
"""

import jax

from neuralgaits._types import Actuated, Array, Coordinates, Float, Scalar
from neuralgaits.robots import dynamics
from neuralgaits.robots.biped import PlanarBiped


def link_momenta(robot: PlanarBiped, q: Coordinates, dq: Coordinates) -> tuple[Actuated, Actuated]:
    """Return dL/d(dq_j) and dL/dq_j of the actuated joints. [m] (N m s), [m] (N m)."""
    turn = robot.link_angles

    def mass(at: Coordinates) -> Float[Array, "n n"]:
        return turn.T @ dynamics.link_mass_matrix(robot, turn @ at) @ turn

    def lagrangian(at: Coordinates) -> Scalar:
        return 0.5 * dq @ (mass(at) @ dq) - robot.potential_energy(at)

    return (mass(q) @ dq)[1:], jax.grad(lagrangian)(q)[1:]
