"""Quantities of one full state (z, eta) under exact input-output linearisation.

The outputs obey ddy = -w^2 y - 2 w dy exactly, whatever z does, so eta is an input here and no
feedback law appears. The zero dynamics coordinates move with dz2 = M g x_com(q) and the dz1 that
the momentum row fixes; both stay closed form, as on the zero dynamics manifold. Source:
docs/full_order.md; Westervelt et al. (2007), section 5.
"""

from functools import cached_property

import jax
import jax.numpy as jnp

from neuralgaits._types import Actuated, Array, Coordinates, Float, Scalar, ZeroState
from neuralgaits.gait.point import Point
from neuralgaits.gait.policy import AbstractPolicy
from neuralgaits.gait.stepping_robot import SteppingRobot
from neuralgaits.gait.third_order import ThirdOrderPolicy
from neuralgaits.gait.zero_coordinates import combined, product, solved
from neuralgaits.robots.linear import solve


class FullPoint(Point):
    """The robot in the state Phi^-1(z, eta); at eta = 0 it is the `Point` of z.

    Every physical quantity of a `Point` can be read here too, torques and contact forces
    included: they are those of the outputs' own acceleration, -w^2 y - 2 w dy unless another
    one is given.
    """

    def __init__(
        self,
        robot: SteppingRobot,
        policy: AbstractPolicy,
        z: ZeroState,
        eta: Float[Array, " two_m"],
        bandwidth: float | Scalar,
        acceleration: Actuated | None = None,
    ):
        """Fix robot, policy, z [2], eta = (y, dy) [2m] and w, the outputs' double pole [rad/s].

        And ddy [m] (rad/s^2), if it is not that of exact input-output linearisation.
        """
        super().__init__(robot, policy, None, z)
        self.bandwidth = bandwidth
        self._acceleration = acceleration
        m = robot.n - 1
        self.output = jnp.asarray(eta)[:m]
        self.output_rate = jnp.asarray(eta)[m:]

    @cached_property
    def output_acceleration(self) -> Actuated:
        """Output accelerations, -w^2 y - 2 w dy if no other is given [rad/s^2]. [m]."""
        if self._acceleration is not None:
            return self._acceleration
        w = self.bandwidth
        return -(w * w) * self.output - (2.0 * w) * self.output_rate

    @cached_property
    def q(self) -> Coordinates:
        """Coordinates of the robot at this state [rad]. [n]."""
        positions, _ = self.coordinates.split(self.z)
        return self.coordinates.lift(positions, self.outputs.y + self.output)

    @cached_property
    def nominal_dz(self) -> ZeroState:
        """Rate omega(eta, z) (m/s, N m). [2]."""
        _, momenta = self.coordinates.split(self.z)
        momentum_rate = self.momentum_rate
        of_momentum_rate = combined(self.along_momenta, momentum_rate)
        fixed_rate = of_momentum_rate + self.coordinates.still(self.output_rate)
        needed = -(momenta + product(self.momentum_rows, fixed_rate))
        return jnp.concatenate([solved(self.inertia_along_positions, needed), momentum_rate])

    @cached_property
    def dq(self) -> Coordinates:
        """Rates of the coordinates at this state [rad/s]. [n]."""
        return self._position_rates(self.dz) + self.coordinates.still(self.output_rate)

    def _curvature(self, along: ZeroState) -> Actuated:
        """Joint accelerations that do not come from ddz: curvature of y_d, and ddy."""
        return super()._curvature(along) + self.output_acceleration

    @cached_property
    def eta_after(self) -> Float[Array, " two_m"]:
        """Outputs and their rates after an impact in this state (rad, rad/s). [2m].

        z moves at its real rate then.
        """
        after, desired = self.impact, self.after.outputs
        dz = self.coordinates.rate(after.q, after.dq)
        rates = desired.rate_errors(after.dq[1:], dz)
        return jnp.concatenate([after.q[1:] - desired.y, rates])


def held_jerk(point: FullPoint) -> Actuated:
    """Return third derivatives of the outputs at constant joint torques. [m] (rad/s^3).

    With u = U(z, y, dy, ddy) of the inverse dynamics, 0 = dU/dt is linear in it. Its matrix is
    that of the joints' inertia, near enough for elimination to have its pivots. Source:
    docs/level5_proof.md.
    """
    policy = ThirdOrderPolicy.of(point.policy, point.z)

    def torque(z: ZeroState, y: Actuated, dy: Actuated, ddy: Actuated) -> Actuated:
        eta = jnp.concatenate([y, dy])
        return FullPoint(point.robot, policy, z, eta, point.bandwidth, ddy).torque

    z, y, dy, ddy = point.z, point.output, point.output_rate, point.output_acceleration
    _, rate = jax.jvp(lambda z, y, dy: torque(z, y, dy, ddy), (z, y, dy), (point.dz, dy, ddy))
    slopes = [
        jax.jvp(lambda a: torque(z, y, dy, a), (ddy,), (row,))[1]
        for row in jnp.eye(len(ddy), dtype=ddy.dtype)
    ]
    return -solve(jnp.stack(slopes, axis=1), rate)
