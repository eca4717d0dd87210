"""The hybrid zero dynamics of a robot under a policy.

Source: paper, sections 2.1 and 2.2; coordinates as in docs/notation.md.
"""

from collections.abc import Callable

import equinox as eqx
import jax.numpy as jnp
import numpy as np

from neuralgaits._types import Array, Float, FullState, Scalar, ZeroState
from neuralgaits.gait.coordinates import lift, zero_coordinates
from neuralgaits.gait.point import Point
from neuralgaits.gait.policy import AbstractPolicy, OutputJet, output_jet, refuse_other_joints
from neuralgaits.gait.reset_residual import ResetCorrection
from neuralgaits.robots import PlanarBiped, dynamics
from neuralgaits.robots.checks import vector


class ZeroDynamics(eqx.Module):
    """Zero dynamics dz = omega(0, z; theta) + residual(z), with guard and reset map.

    All methods take single states; use `jax.vmap` for batches. They raise InputError for other
    shapes, and for a policy whose outputs are not one for each actuated joint.

    Attributes:
        robot: the biped.
        policy: desired outputs y_d(z).
        residual: optional function z -> [2] (m/s, N m), or None.
        reset_residual: optional correction of the reset map, or None.
    """

    robot: PlanarBiped
    policy: AbstractPolicy
    residual: Callable[[ZeroState], ZeroState] | None = None
    reset_residual: ResetCorrection = None

    def point(self, z: ZeroState) -> Point:
        """Everything on the zero dynamics manifold at z, evaluated on demand."""
        state = vector("z", z, 2)
        return Point(self.robot, self.policy, self.residual, state, self.reset_residual)

    def zdot(self, z: ZeroState) -> ZeroState:
        """Rate of the zero dynamics. Returns: [2] (m/s, N m). Source: paper Eq. 4."""
        return self.point(z).dz

    def guard(self, z: ZeroState) -> Scalar:
        """Swing-foot height (m): the step ends where it falls through zero with z1 > 0."""
        return self.point(z).foot_above_ground

    def reset(self, z: ZeroState) -> ZeroState:
        """Reset map z+ = Phi_z(Delta(Phi^-1(0, z))).

        The formula is `Point.z_after` in `gait/point.py`; that of the impact Delta is in
        `robots/impact.py`.

        Returns: [2] (m, kg m^2/s).
        """
        return self.point(z).z_after

    def phi(self, x: FullState) -> tuple[Float[Array, " two_m"], ZeroState]:
        """Output and zero dynamics coordinates of a full state x = (q, dq).

        Returns: eta = (y, dy) [2m] (rad, rad/s) and z [2] (m, kg m^2/s).
        """
        n = self.robot.n
        x = vector("x", x, 2 * n)
        q, dq = x[:n], x[n:]
        z = zero_coordinates(self.robot, q, dq)
        desired = self._desired(z)
        dz = self._rate(q, dq)
        slope = desired.d1 * dz[0] + desired.d2 * dz[1]
        return jnp.concatenate([q[1:] - desired.y, dq[1:] - slope]), z

    def phi_inv(self, z: ZeroState, eta: Float[Array, " two_m"] | float = 0.0) -> FullState:
        """Full state with given zero dynamics and output coordinates; inverse of `phi`.

        Returns: x = (q, dq) [2n] (rad, rad/s).
        """
        m = self.robot.n - 1
        z = vector("z", z, 2)
        eta = jnp.zeros(2 * m) + eta if np.ndim(eta) == 0 else vector("eta", eta, 2 * m)
        desired = self._desired(z)
        q = lift(self.robot, z[0], desired.y + eta[:m])
        theta = self.robot.link_angles @ q
        dz2 = self._fall(q)
        row = jnp.sum(dynamics.link_mass_matrix(self.robot, theta), axis=0)
        row = row @ self.robot.link_angles
        along = lift(self.robot, jnp.ones_like(z[0]), desired.d1)
        known = lift(self.robot, jnp.zeros_like(z[0]), desired.d2 * dz2 + eta[m:])
        dz1 = -(z[1] + row @ known) / (row @ along)
        return jnp.concatenate([q, along * dz1 + known])

    def _desired(self, z: ZeroState) -> OutputJet:
        desired = output_jet(self.policy, z)
        refuse_other_joints(self.robot, desired.y)
        return desired

    def _fall(self, q) -> Scalar:
        """Rate of z2: the weight's moment about the stance foot."""
        return self.robot.mass * self.robot.gravity * self.robot.centre_of_mass(q)[0]

    def _rate(self, q, dq) -> ZeroState:
        """Rate of z in any full state of the rigid model (m/s, N m)."""
        return jnp.stack([self.robot.hip_gradient @ dq, self._fall(q)])
