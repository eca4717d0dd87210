"""A planar biped: its constants, and its mechanics in generalised coordinates."""

from collections.abc import Iterator

import equinox as eqx
import jax.numpy as jnp
from jax.core import Tracer

from neuralgaits import _notebook
from neuralgaits._types import Actuated, Array, Coordinates, Float, Int, Planar, Scalar
from neuralgaits.robots import checks, dynamics, impact
from neuralgaits.robots.constants import BipedConstants
from neuralgaits.robots.state_after_impact import Impact


class PlanarBiped(BipedConstants):
    """A planar biped with two equal legs, pinned at its stance foot, or at the ankle of a flat one.

    No motor but that of a stance ankle acts on the first coordinate. Methods take single states and
    raise InputError for other shapes, and for concrete numbers that are not finite; use `jax.vmap`
    for batches. Attributes: see `BipedConstants`.
    """

    def __repr__(self) -> str:
        """Return one line with name, mass, legs and motors."""
        motors = f"{len(self.joint_names) - 1} motors"
        if self.feet is not None:
            motors = f"{len(self.joint_names)} motors, flat feet"
        if isinstance(self.mass, Tracer):
            # While it is being traced its numbers are not known.
            return f"<PlanarBiped {self.name}: {motors}>"
        size = f"{float(self.mass):.3g} kg, legs of {self.leg_length:.3g} m"
        return f"<PlanarBiped {self.name}: {size}, {motors}>"

    def _repr_html_(self) -> str:
        """Return an HTML summary for a notebook, with one row per motor."""
        rows = [
            (joint, f"{limit:.3g}", f"{low:.3g} to {high:.3g}", f"{rotor:.3g}")
            for joint, limit, low, high, rotor in zip(
                self.joint_names[1:],
                self.torque_limit,
                self.joint_lower,
                self.joint_upper,
                self.armature[1:],
                strict=True,
            )
        ]
        head = ("motor at", "torque [N m]", "range [rad]", "rotor inertia [kg m²]")
        return _notebook.table(repr(self)[1:-1], rows, head)

    def mass_matrix(self, q: Coordinates) -> Float[Array, "n n"]:
        """Mass matrix D(q) of the robot pinned at the stance foot.

        Returns: [n, n] symmetric positive definite (kg m^2), armature included.
        """
        return dynamics.mass_matrix(self, *self._checked_vectors(q=q))

    def bias(self, q: Coordinates, dq: Coordinates) -> Coordinates:
        """Coriolis, gravity and damping terms H of D(q) ddq + H(q, dq) = B u.

        Returns: [n] (N m).
        """
        return dynamics.bias(self, *self._checked_vectors(q=q, dq=dq))

    def impact(self, q: Coordinates, dq: Coordinates) -> Impact:
        """Plastic impact of the swing foot, then relabelling of the legs.

        Returns: `Impact(q, dq, impulse)`: [n], [n] after relabelling (rad, rad/s) and
        [2] (tangential, normal) impulse on the new stance foot (N s).
        """
        return impact.impact(self, *self._checked_vectors(q=q, dq=dq))

    def sole_ends(self, q: Coordinates) -> Float[Array, "2 2"]:
        """Heel and toe of a flat swing foot, each (x, z). Returns: [2, 2] (m)."""
        return dynamics.sole_ends(self, q)

    def sole_velocities(self, q: Coordinates, dq: Coordinates) -> Float[Array, "2 2"]:
        """Velocities of heel and toe, each (x, z). Returns: [2, 2] (m/s)."""
        return dynamics.sole_velocities(self, q, dq)

    def momentum_after(self, q: Coordinates, dq: Coordinates) -> Coordinates:
        """Generalised momentum about the new stance foot after an impact [kg m^2/s]. [n]."""
        return impact.momentum_after(self, q, dq)

    def impulse_moment(self, q: Coordinates, dq: Coordinates) -> Scalar:
        """Normal impulse of an impact times its place ahead of a flat foot's ankle [N m s]."""
        return impact.pressure_moment(self, q, dq)

    def swing_foot(self, q: Coordinates) -> Planar:
        """Swing-foot position from the stance foot, (x, z). Returns: [2] (m)."""
        return dynamics.swing_foot(self, *self._checked_vectors(q=q))

    def swing_foot_velocity(self, q: Coordinates, dq: Coordinates) -> Planar:
        """Velocity of the swing foot, (x, z). Returns: [2] (m/s)."""
        return dynamics.swing_foot_velocity(self, q, dq)

    def centre_of_mass(self, q: Coordinates) -> Planar:
        """Centre of mass from the stance foot, (x, z). Returns: [2] (m)."""
        return dynamics.centre_of_mass(self, *self._checked_vectors(q=q))

    def kinetic_energy(self, q: Coordinates, dq: Coordinates) -> Scalar:
        """Kinetic energy, rotors included. Returns: scalar (J)."""
        q, dq = self._checked_vectors(q=q, dq=dq)
        return 0.5 * dq @ (dynamics.mass_matrix(self, q) @ dq)

    def potential_energy(self, q: Coordinates) -> Scalar:
        """Potential energy above the stance foot. Returns: scalar (J)."""
        return self.mass * self.gravity * self.centre_of_mass(q)[1]

    def acceleration(
        self, q: Coordinates, dq: Coordinates, torque: Actuated, ankle: Scalar | float = 0.0
    ) -> Coordinates:
        """Forward dynamics with the stance foot pinned.

        Args:
            q: coordinates (rad). [n]
            dq: rates (rad/s). [n]
            torque: torques of the actuated joints (N m). [m]
            ankle: torque of the stance ankle on the robot, positive forward (N m).

        Returns: [n] (rad/s^2).
        """
        q, dq = self._checked_vectors(q=q, dq=dq)
        torque = checks.vector("torque", torque, self.n - 1)
        return dynamics.acceleration(self, q, dq, torque, ankle)

    def ground_reaction_force(self, q: Coordinates, dq: Coordinates, ddq: Coordinates) -> Planar:
        """Force of the ground on the stance foot. Returns: [2] (tangential, normal) (N)."""
        return dynamics.ground_reaction_force(self, *self._checked_vectors(q=q, dq=dq, ddq=ddq))

    def with_joints(self, armature: Actuated, damping: Actuated) -> "PlanarBiped":
        """Return the robot with these rotors and this damping of its actuated joints.

        Args:
            armature: rotor inertia, stance leg first [kg m^2]. [m]
            damping: viscous friction [N m s/rad]. [m]
        """
        whole = [
            jnp.concatenate([own[:1], joints])
            for own, joints in ((self.armature, armature), (self.damping, damping))
        ]
        return eqx.tree_at(lambda robot: (robot.armature, robot.damping), self, tuple(whole))

    def pitch_row(self, stance: Int[Array, ""] | int) -> Float[Array, " n"]:
        """Return the row with pitch = row . q, standing on leg `stance`. [n]."""
        if self.torso is not None:
            return jnp.asarray(self.link_angles[self.torso])
        # The root is the top link of leg 0: leg 1 in stance counts the same links from the other
        # end.
        root = self.n // 2 - 1
        return jnp.where(stance == 0, self.link_angles[root], self.link_angles[self.n - 1 - root])

    def hip_position(self, q: Coordinates) -> Planar:
        """Hip from the stance foot, (x, z) [m]. [2]."""
        return dynamics.hip_position(self, q)

    def hip_velocity(self, q: Coordinates, dq: Coordinates) -> Planar:
        """Velocity of the hip, (x, z), with the stance foot at rest [m/s]. [2]."""
        return dynamics.hip_velocity(self, q, dq)

    def weight(self) -> Scalar:
        """Weight of the whole robot, flat feet left out [N]."""
        return self.mass * self.gravity

    def moment_scale(self) -> Scalar:
        """Mass times leg length: size of z2 per rate of z1 [kg m]."""
        return self.mass * jnp.sum(self.hip)

    @property
    def position_rows(self) -> Float[Array, "1 n"]:
        """Gradient of the linearised hip position z1 [m/rad]."""
        return self.hip_gradient[None]

    def momentum(self, q: Coordinates, dq: Coordinates) -> Float[Array, "1"]:
        """Angular momentum z2 about the stance foot, positive forward [kg m^2/s]."""
        return dynamics.angular_momentum(self, q, dq)[None]

    def momentum_rows(self, q: Coordinates) -> Float[Array, "1 n"]:
        """Row J of the mass matrix with z2 = -J . dq; only a stance ankle's rotor adds [kg m^2]."""
        links = dynamics.link_mass_matrix(self, self.link_angles @ q)
        row = jnp.sum(links, axis=0) @ self.link_angles
        if self.feet is not None:
            row = row + self.armature[0] * jnp.eye(self.n, dtype=row.dtype)[0]
        return row[None]

    def momentum_rows_rate(self, q: Coordinates, dq: Coordinates) -> Float[Array, "1 n"]:
        """Rate of that row along a motion [kg m^2/s]."""
        turn = self.link_angles
        dtheta = turn @ dq
        moving = dtheta[:, None] - dtheta[None, :]
        return (-jnp.sum(dynamics.coupling_sines(self, turn @ q) * moving, axis=0) @ turn)[None]

    def momentum_rate(self, q: Coordinates, dq: Coordinates | None = None) -> Float[Array, "1"]:
        """Moment of the weight about the stance foot, whatever the rates are [N m]."""
        del dq
        return (self.mass * self.gravity * dynamics.centre_of_mass(self, q)[0])[None]

    def momentum_rate_rate(self, q: Coordinates, dq: Coordinates) -> Float[Array, "1"]:
        """Rate of that moment along a motion [N m/s]."""
        return (self.mass * self.gravity * dynamics.centre_of_mass_velocity(self, q, dq)[0])[None]

    def _checked_vectors(self, **vectors: Coordinates) -> Iterator[Coordinates]:
        """The vectors in their order, each checked to be [n] and finite."""
        return (checks.vector(name, value, self.n) for name, value in vectors.items())
