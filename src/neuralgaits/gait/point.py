"""Quantities that follow from one zero dynamics state, each computed once."""

from collections.abc import Callable
from functools import cached_property
from typing import Any

import jax
import jax.numpy as jnp

from neuralgaits._types import Actuated, Array, Coordinates, Float, Planar, Scalar, ZeroState
from neuralgaits.errors import SpecError
from neuralgaits.gait.commands import Ground, Step
from neuralgaits.gait.policy import (
    AbstractPolicy,
    Curve,
    OutputJet,
    output_jet_and_change,
    refuse_other_joints,
)
from neuralgaits.gait.reset_residual import ResetCorrection, rates_after
from neuralgaits.gait.stepping_robot import SteppingRobot
from neuralgaits.gait.zero_coordinates import (
    ZeroCoordinates,
    combined,
    momentum_of,
    product,
    solved,
)
from neuralgaits.robots.robot_file import flat_feet_of
from neuralgaits.robots.state_after_impact import Impact


def turned(vector: Planar, slope: Scalar) -> Planar:
    """Return a vector's components along and across ground of this slope [rad]. [2]."""
    along, across = jnp.cos(slope), jnp.sin(slope)
    return jnp.stack(
        [vector[0] * along + vector[1] * across, vector[1] * along - vector[0] * across]
    )


class Point:
    """The robot on the zero dynamics manifold at one z; attributes are evaluated on demand.

    Not a pytree: build it inside the function that is transformed, return arrays.
    """

    def __init__(
        self,
        robot: SteppingRobot,
        policy: AbstractPolicy,
        residual,
        z: ZeroState,
        reset_residual: ResetCorrection = None,
    ):
        """Fix robot, policy, optional residuals (of the flow: a function z -> [2]) and state."""
        self.robot = robot
        self.policy = policy
        self.residual = residual
        self.reset_residual = reset_residual
        self.z = jnp.asarray(z)

    def rate(self, function: Callable[["Point"], Any]) -> tuple[Any, Any]:
        """Value of a function of the point data and its rate along the flow.

        Positions and rates are known here with their rates, so the function is differentiated
        in them and the network is not traced again. Other data that it reads follow from z.

        Returns: value and d value / dt, both trees like the function's result.
        """

        def value_at(z, q, dq, dz):
            point = Point(self.robot, self.policy, self.residual, z, self.reset_residual)
            vars(point).update(q=q, dq=dq, dz=dz)
            return function(point)

        state = (self.z, self.q, self.dq, self.dz)
        return jax.jvp(value_at, state, (self.dz, self.dq, self.ddq, self.ddz))

    @cached_property
    def _jet_and_change(self) -> tuple[OutputJet, Curve]:
        jet = output_jet_and_change(self.policy, self.z)
        refuse_other_joints(self.robot, jet[0].y)
        return jet

    @property
    def outputs(self) -> OutputJet:
        """Desired outputs and their partial derivatives."""
        return self._jet_and_change[0]

    @property
    def coordinates(self) -> ZeroCoordinates:
        """Map between full states and zero dynamics states of the robot."""
        return ZeroCoordinates(self.robot)

    @cached_property
    def q(self) -> Coordinates:
        """Coordinates of the robot on the manifold [rad]. [n]."""
        positions, _ = self.coordinates.split(self.z)
        return self.coordinates.lift(positions, self.outputs.y)

    @cached_property
    def theta(self) -> Coordinates:
        """Absolute angles of the links [rad]. [n]."""
        return self.robot.link_angles @ self.q

    @cached_property
    def along_positions(self) -> Float[Array, "n k"]:
        """Coordinate rates per unit rate of each position [rad/m]. [n, k]."""
        return self.coordinates.along(self.outputs.jacobian[:, : self.coordinates.k])

    @cached_property
    def along_momenta(self) -> Float[Array, "n k"]:
        """Coordinate rates per unit rate of each momentum [rad s/(kg m^2)]. [n, k]."""
        return self.coordinates.still(self.outputs.jacobian[:, self.coordinates.k :])

    @cached_property
    def momentum_rows(self) -> Float[Array, "k n"]:
        """Rows of the mass matrix that give the momenta, -(rows @ dq) [kg m^2]. [k, n]."""
        return self.robot.momentum_rows(self.q)

    @cached_property
    def inertia_along_positions(self) -> Float[Array, "k k"]:
        """Momenta per unit rate of each position, the matrix of every solve for rates. [k, k]."""
        return product(self.momentum_rows, self.along_positions)

    @property
    def transversal_inertia(self) -> Scalar:
        """J . s of docs/notation.md, for a robot with one position: -z2 per unit dz1 [kg m].

        Negative in forward walking; the zero dynamics exist where it is not zero.
        """
        return self.inertia_along_positions[0, 0]

    @cached_property
    def centre_of_mass(self) -> Planar:
        """Centre of mass from the stance foot [m]. [2]."""
        return self.robot.centre_of_mass(self.q)

    @cached_property
    def _ankle(self) -> tuple[Scalar, ZeroState] | None:
        """Torque of the stance ankle and its slopes in z; None without one."""
        torque = self.policy.ankle_torque
        if self.robot.feet is None or jax.eval_shape(torque, self.z) is None:
            return None
        value, derivative = jax.linearize(torque, self.z)
        axes = jnp.eye(len(self.z), dtype=self.z.dtype)
        return value, jnp.stack([derivative(axis) for axis in axes])

    @property
    def ankle_torque(self) -> Scalar:
        """Torque of the stance ankle on the robot, positive forward [N m]; 0 on point feet."""
        return jnp.zeros(()) if self._ankle is None else self._ankle[0]

    @cached_property
    def momentum_rate(self) -> Float[Array, " k"]:
        """Rates of the momenta: the moment of the weight, and an ankle's torque [N m]. [k]."""
        moment = self.robot.momentum_rate(self.q)
        return moment if self._ankle is None else moment + self._ankle[0]

    @cached_property
    def nominal_dz(self) -> ZeroState:
        """Rate omega(0, z) of the rigid model, residual left out (m/s, N m). [2k]."""
        _, momenta = self.coordinates.split(self.z)
        # -momenta = rows @ dq, and dq = along_positions @ (dp/dt) + along_momenta @ (ds/dt).
        momentum_rate = self.momentum_rate
        of_momentum_rate = combined(product(self.momentum_rows, self.along_momenta), momentum_rate)
        position_rate = solved(self.inertia_along_positions, -(momenta + of_momentum_rate))
        return jnp.concatenate([position_rate, momentum_rate])

    @cached_property
    def dz(self) -> ZeroState:
        """Rate of the zero dynamics, residual included (m/s, N m). [2k]. Source: paper Eq. 4."""
        if self.residual is None:
            return self.nominal_dz
        return self.nominal_dz + self.residual(self.z)

    @cached_property
    def dq(self) -> Coordinates:
        """Rates of the coordinates [rad/s]. [n]."""
        return self._position_rates(self.dz)

    def _position_rates(self, rate: ZeroState) -> Coordinates:
        """Return the coordinate rates of a rate of z, outputs at rest. [n]."""
        of_positions, of_momenta = self.coordinates.split(rate)
        shift = combined(self.along_positions, of_positions)
        return shift + combined(self.along_momenta, of_momenta)

    @cached_property
    def _slope_rates(self) -> OutputJet:
        """Derivative of the jet along the flow: its Jacobian is the Hessian times dz."""
        return self._jet_and_change[1](self.dz)

    def _curvature(self, along: ZeroState) -> Actuated:
        """Return D^2 y_d(z)[along, dz], the curvature of the desired outputs."""
        return self._slope_rates.rate(along)

    @cached_property
    def ddz(self) -> ZeroState:
        """Second rate of the zero dynamics (m/s^2, N m/s). [2k].

        Differentiates the momentum rows along the flow. With a residual, the rows hold for the
        nominal rate while everything else moves at the corrected one.
        """
        robot = self.robot
        moment_rate = robot.momentum_rate_rate(self.q, self.dq)
        if self._ankle is not None:
            moment_rate = moment_rate + self._ankle[1] @ self.dz
        nominal_dq, curvature = self.dq, self._curvature(self.nominal_dz)
        residual_rate = jnp.zeros_like(self.z)
        if self.residual is not None:
            nominal_dq = self._position_rates(self.nominal_dz)
            _, residual_rate = jax.jvp(self.residual, (self.z,), (self.dz,))
        rows_rate = robot.momentum_rows_rate(self.q, self.dq)
        fixed_rate = self.coordinates.still(curvature) + combined(self.along_momenta, moment_rate)
        _, momenta_rate = self.coordinates.split(self.dz)
        momenta_change = momenta_rate + product(rows_rate, nominal_dq)
        needed = -(momenta_change + product(self.momentum_rows, fixed_rate))
        rate = jnp.concatenate([solved(self.inertia_along_positions, needed), moment_rate])
        return rate + residual_rate

    @cached_property
    def ddq(self) -> Coordinates:
        """Accelerations of the coordinates [rad/s^2]. [n]."""
        return self._position_rates(self.ddz) + self.coordinates.still(self._curvature(self.dz))

    @cached_property
    def torque(self) -> Actuated:
        """Joint torques that keep the outputs at zero [N m]. [m]."""
        mass = self.robot.mass_matrix(self.q)
        return (mass @ self.ddq + self.robot.bias(self.q, self.dq))[1:]

    @cached_property
    def force(self) -> Planar:
        """Ground force on the stance foot, (tangential, normal) [N]. [2]."""
        return self.robot.ground_reaction_force(self.q, self.dq, self.ddq)

    @cached_property
    def pressure_moment(self) -> Scalar:
        """Normal force times the centre of pressure's place ahead of a flat foot's ankle [N m]."""
        torque = self.ankle_torque + self.robot.armature[0] * self.ddq[0]
        return flat_feet_of(self.robot).pressure_moment(
            self.contact_force, torque, self.robot.gravity
        )

    @cached_property
    def foot(self) -> Planar:
        """Swing foot from the stance foot, (x, z) [m]. [2]."""
        return self.robot.swing_foot(self.q)

    @cached_property
    def foot_velocity(self) -> Planar:
        """Swing-foot velocity, (x, z) [m/s]. [2]."""
        return self.robot.swing_foot_velocity(self.q, self.dq)

    @property
    def step(self) -> Step:
        """Commands of this step: `p.step["speed"]` is (before, after).

        Raises: SpecError for a gait without commands.
        """
        if self.policy.step is None:
            raise SpecError("expected a gait with commands, found one without: give the spec some")
        return self.policy.step

    @property
    def _ground(self) -> Ground | None:
        return None if self.policy.step is None else self.policy.step.ground

    @cached_property
    def foot_above_ground(self) -> Scalar:
        """Swing foot above the line between the two footholds of this step [m]."""
        if self._ground is None:
            return self.foot[1]
        return self.foot[1] - (self._ground.level + self._ground.rise * self.foot[0])

    @cached_property
    def foot_lift_rate(self) -> Scalar:
        """Rate of the swing foot's height above that line [m/s]."""
        if self._ground is None:
            return self.foot_velocity[1]
        return self.foot_velocity[1] - self._ground.rise * self.foot_velocity[0]

    @property
    def landing_rise(self) -> Scalar | float:
        """Metres of height a metre of the ground under the next foothold."""
        return 0.0 if self._ground is None else jnp.tan(self._ground.landing_slope)

    @cached_property
    def contact_force(self) -> Planar:
        """Force on the stance foot along and across the ground under it [N]. [2]."""
        if self._ground is None:
            return self.force
        return turned(self.force, self._ground.stance_slope)

    @cached_property
    def contact_impulse(self) -> Planar:
        """Impulse on the new stance foot along and across the ground under it [N s]. [2]."""
        if self._ground is None:
            return self.impact.impulse
        return turned(self.impact.impulse, self._ground.landing_slope)

    @cached_property
    def impulse_moment(self) -> Scalar:
        """Normal impulse times its place ahead of a flat foot's ankle, in an impact now [N m s]."""
        return self.robot.impulse_moment(self.q, self.dq)

    @cached_property
    def impact(self) -> Impact:
        """Full state after an impact in this state, and its impulse.

        A residual corrects the rates; the impulse is the model's.
        """
        after = self.robot.impact(self.q, self.dq)
        if self.reset_residual is None:
            return after
        correction = self.reset_residual(self.z)
        dq = rates_after(self.robot, after.q, after.dq, correction, momentum_of(self.z))
        return after._replace(dq=dq)

    @cached_property
    def z_after(self) -> ZeroState:
        """Reset map: z after an impact in this state (m, kg m^2/s). [2].

        `ZeroDynamics.reset` returns it. The impact conserves the momentum about the new stance
        foot, so no rates after the impact are solved for.
        """
        q_new = self.robot.relabel @ self.q
        # Conjugate to q, so backwards positive: z2, forward positive, is minus its first entry.
        momentum = self.robot.momentum_after(self.q, self.dq)
        z1, z2 = self.robot.position_rows[0] @ q_new, -momentum[0]
        if self.reset_residual is not None:
            z2 = z2 + self.reset_residual(self.z).momentum * momentum_of(self.z)
        return jnp.stack([z1, z2])

    @cached_property
    def after(self) -> "Point":
        """The point of the zero dynamics manifold above `z_after`, outputs re-zeroed."""
        policy = self.policy.steady_next
        return Point(self.robot, policy, self.residual, self.z_after, self.reset_residual)
