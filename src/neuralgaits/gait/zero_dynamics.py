"""The hybrid zero dynamics of a robot under a policy.

Source: paper, sections 2.1 and 2.2; coordinates as in docs/notation.md.
"""

from collections.abc import Callable

import equinox as eqx
import jax.numpy as jnp
import numpy as np

from neuralgaits._types import (
    Array,
    Coordinates,
    Float,
    FullState,
    Positions,
    Scalar,
    ZeroState,
)
from neuralgaits.gait.point import Point
from neuralgaits.gait.policy import AbstractPolicy, OutputJet, output_jet, refuse_other_joints
from neuralgaits.gait.reset_residual import ResetCorrection
from neuralgaits.gait.stepping_robot import SteppingRobot
from neuralgaits.gait.zero_coordinates import ZeroCoordinates, combined
from neuralgaits.robots.checks import vector


class ZeroDynamics(eqx.Module):
    """Zero dynamics dz = omega(0, z) + residual(z), with guard and reset map.

    All methods take single states; use `jax.vmap` for batches. They raise InputError for other
    shapes, and for a policy whose outputs are not one for each actuated joint.

    Attributes:
        robot: the robot.
        policy: desired outputs y_d(z).
        residual: optional function z -> [2] (m/s, N m), or None.
        reset_residual: optional correction of the reset map, or None.
    """

    robot: SteppingRobot
    policy: AbstractPolicy
    residual: Callable[[ZeroState], ZeroState] | None = None
    reset_residual: ResetCorrection = None

    def point(self, z: ZeroState) -> Point:
        """Everything on the zero dynamics manifold at z, evaluated on demand."""
        state = vector("z", z, 2 * self.coordinates.k)
        return Point(self.robot, self.policy, self.residual, state, self.reset_residual)

    def zdot(self, z: ZeroState) -> ZeroState:
        """Rate of the zero dynamics, `Point.dz`. Returns: [2] (m/s, N m). Source: paper Eq. 4."""
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
        """Output and zero dynamics coordinates of a full state x = (q, dq): the map Phi.

        Returns: eta = (y, dy) [2m] (rad, rad/s) and z [2] (m, kg m^2/s).
        """
        n = self.robot.n
        x = vector("x", x, 2 * n)
        q, dq = x[:n], x[n:]
        z = self.coordinates.of(q, dq)
        desired = self._desired(z)
        positions_rate, _ = self.coordinates.split(self.coordinates.rate(q, dq))
        rate = desired.rate(jnp.concatenate([positions_rate, self._momentum_rate(q, z)]))
        return jnp.concatenate([q[1:] - desired.y, dq[1:] - rate]), z

    def phi_inv(self, z: ZeroState, eta: Float[Array, " two_m"] | float = 0.0) -> FullState:
        """Full state with given zero dynamics and output coordinates; inverse of `phi`.

        Returns: x = (q, dq) [2n] (rad, rad/s).
        """
        robot, coordinates = self.robot, self.coordinates
        m = robot.n - 1
        z = vector("z", z, 2 * coordinates.k)
        eta = jnp.zeros(2 * m) + eta if np.ndim(eta) == 0 else vector("eta", eta, 2 * m)
        positions, momenta = coordinates.split(z)
        desired = self._desired(z)
        by_positions, by_momenta = jnp.split(desired.jacobian, 2, axis=1)
        q = coordinates.lift(positions, desired.y + eta[:m])
        # Part of the desired rates that does not depend on the positions' rates.
        of_momentum_rate = combined(by_momenta, self._momentum_rate(q, z))
        fixed = coordinates.still(of_momentum_rate + eta[m:])
        return jnp.concatenate([q, coordinates.rates(q, momenta, by_positions, fixed)])

    @property
    def coordinates(self) -> ZeroCoordinates:
        """Map between full states and zero dynamics states of the robot."""
        return ZeroCoordinates(self.robot)

    def _momentum_rate(self, q: Coordinates, z: ZeroState) -> Positions:
        """Rates of the momenta: moment of the weight, and torque of a stance ankle. [k]."""
        moment = self.robot.momentum_rate(q)
        ankle = None if self.robot.feet is None else self.policy.ankle_torque(z)
        return moment if ankle is None else moment + ankle

    def _desired(self, z: ZeroState) -> OutputJet:
        desired = output_jet(self.policy, z)
        refuse_other_joints(self.robot, desired.y)
        return desired
