"""Forces and momenta of robots whose links are not those of the file, as slopes in few numbers.

Inverse dynamics, momenta and ground forces of a pinned link tree are linear in each link's mass,
first moments, second moment and inertia. So their slopes at the file's robot are exact for every
other one. Source: Khalil and Dombre (2002), chapter 9, on base inertial parameters.
"""

from collections.abc import Callable
from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from neuralgaits._types import Array, Coordinates, Float
from neuralgaits.errors import InputError
from neuralgaits.robots import dynamics
from neuralgaits.robots.biped import PlanarBiped
from neuralgaits.robots.impact import momentum_after
from neuralgaits.robots.mjcf.parameters import RobotFamily
from neuralgaits.robots.robot_file import RobotFile

KINDS = "mass", "com", "inertia"
"""Kinds of parameters that the shares cover."""


class LinkShares(NamedTuple):
    """Slopes in shares of the links, K = 5T of them for T types of link.

    Those of all types together: of mass; of mass times the offset of the centre of mass along the
    link and across it [m]; of mass times the offset squared [m^2], each over the file's mass; and
    of the inertia, over the file's.

    Attributes:
        family: robots like one from a file.
    """

    family: RobotFamily

    @classmethod
    def of(cls, robot: RobotFile) -> "LinkShares":
        """Return the slopes of a robot's quantities. Raises: InputError if it is no biped."""
        if not isinstance(robot, PlanarBiped):
            raise InputError(f"expected a planar biped for errors of a model, found {robot.name}")
        return cls(RobotFamily.of(robot, KINDS))

    @property
    def types(self) -> int:
        """Number of types of link, T."""
        return len(self.family.masses)

    def torque(self, q: Coordinates, dq: Coordinates, ddq: Coordinates) -> Float[Array, "n K"]:
        """Slopes of the inverse dynamics: forces that a motion needs [N m]."""

        def needed(robot: PlanarBiped) -> Coordinates:
            return dynamics.mass_matrix(robot, q) @ ddq + dynamics.bias(robot, q, dq)

        return self._slopes(needed)

    def mass_matrix(self, q: Coordinates) -> Float[Array, "n n K"]:
        """Slopes of the mass matrix [kg m^2]."""
        return self._slopes(lambda robot: dynamics.mass_matrix(robot, q))

    def lost_momentum(
        self, q: Coordinates, dq: Coordinates, dq_after: Coordinates
    ) -> Float[Array, "n K"]:
        """Slopes of the momentum about the new stance foot less that of the rates after an impact.

        Args:
            q: coordinates before the impact (rad). [n]
            dq: rates before it (rad/s). [n]
            dq_after: rates after it, in the new coordinates. [n]

        Returns: [n, K] (kg m^2/s).
        """

        def lost(robot: PlanarBiped) -> Coordinates:
            mass = dynamics.mass_matrix(robot, robot.relabel @ q)
            return momentum_after(robot, q, dq) - mass @ dq_after

        return self._slopes(lost)

    def force(
        self, q: Coordinates, dq: Coordinates, ddq: Coordinates
    ) -> tuple[Float[Array, "2"], Float[Array, "2 K"]]:
        """Force of the ground on the stance foot (tangential, normal), and its slopes [N]."""

        def of(robot: PlanarBiped) -> Array:
            return dynamics.ground_reaction_force(robot, q, dq, ddq)

        return of(self.family.nominal), self._slopes(of)

    def impulse(
        self, q: Coordinates, dq: Coordinates, dq_after: Coordinates
    ) -> tuple[Float[Array, "2"], Float[Array, "2 K"]]:
        """Impulse on the new stance foot that leaves these rates, and its slopes [N s]."""

        def of(robot: PlanarBiped) -> Array:
            change = dq_after - robot.relabel @ dq
            moved = dynamics.centre_of_mass_velocity(robot, robot.relabel @ q, change)
            return robot.mass * (moved - dynamics.swing_foot_velocity(robot, q, dq))

        return of(self.family.nominal), self._slopes(of)

    def _slopes(self, function: Callable[[PlanarBiped], Array]) -> Array:
        none = jnp.zeros(5 * self.types)
        return jax.jacfwd(lambda shares: function(self._robot(shares)))(none)

    def _robot(self, shares: Float[Array, " K"]) -> PlanarBiped:
        """Return the robot that differs by these shares: its constants are linear in them."""
        family, robot, count = self.family, self.family.nominal, self.types
        moments, inertia = shares[: 4 * count].reshape(4, count), shares[4 * count :]
        moments = family.masses[None, :] * (moments + np.eye(4)[0][:, None])
        more = robot.inertia * (1.0 + inertia[np.array(family.link)])
        return family.with_features(jnp.ravel(moments), moments[0], True, more)
