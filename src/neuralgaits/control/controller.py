"""One control tick as a pure function: sensors in, joint torques and the next state out.

A simulation, a firmware and a proof all run `step`. It can be jitted, and vmapped over
controllers (their policies), states and measurements.
"""

from collections.abc import Callable
from typing import NamedTuple

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np

from neuralgaits._types import Actuated, Array, Bool, Coordinates, Float, Int, Scalar, ZeroState
from neuralgaits.control import command_state, stance_ankle
from neuralgaits.control.command_state import CommandState
from neuralgaits.control.inverse_dynamics import impact_consistent_rates
from neuralgaits.control.joint_model import JointModel
from neuralgaits.control.law import AbstractLaw, Demand, Desired, MeasuredState, Outputs
from neuralgaits.control.measurement import (
    Measurement,
    coordinates,
    leg_joints,
    stance_foot_velocity,
)
from neuralgaits.control.momentum import zero_state
from neuralgaits.control.saturation import ZeroStateBounds, momenta_of_walking, zero_state_bounds
from neuralgaits.control.touchdown import (
    StanceState,
    TouchdownThresholds,
    advance_stance,
    start_stance,
)
from neuralgaits.gait import AbstractPolicy
from neuralgaits.gait.believed_robot import believed_robot
from neuralgaits.gait.commands import CommandLimits, Pair
from neuralgaits.gait.joint_inertia import JointResponse
from neuralgaits.gait.posture import momentum_unit
from neuralgaits.gait.reset_residual import ResetCorrection
from neuralgaits.robots import PlanarBiped


class Controller(eqx.Module):
    """Everything a control tick needs that does not change from tick to tick.

    Attributes:
        robot: the model the controller believes in, except for a commanded lean.
        policy: desired outputs y_d(z), or a family of them that takes commands.
        law: law by which torques follow from them, fitted to the robot.
        bounds: limits of the measured z; the law selects the part that the policy gets.
        torque_limit: largest torque of each actuated joint, stance leg first [N m]. [m]
        stance: thresholds of the stance machine.
        period_s: time between two ticks [s].
        reset_residual: corrects the impact that the steps of a family begin with.
        joints: rotors and friction that torques are for; None for those of `robot`.
    """

    robot: PlanarBiped
    policy: AbstractPolicy
    law: AbstractLaw
    bounds: ZeroStateBounds
    torque_limit: Float[Array, " m"]
    stance: TouchdownThresholds = eqx.field(static=True)
    period_s: float = eqx.field(static=True)
    reset_residual: ResetCorrection = None
    joints: JointModel | None = None

    @classmethod
    def init(
        cls,
        robot: PlanarBiped,
        policy: AbstractPolicy,
        law: AbstractLaw,
        *,
        z2_range: tuple[float, float] | None = None,
        torque_limit: Actuated | None = None,
        stance: TouchdownThresholds | None = None,
        period_s: float = 1e-3,
        reset_residual: ResetCorrection = None,
        joints: JointModel | None = None,
    ) -> "Controller":
        """Build a controller, with bounds and limits taken from policy and robot.

        Args:
            robot: the model the controller believes in.
            policy: desired outputs, or a family of them.
            law: `Pd()`, `PAPER`, `Fblin()` or `ClfQp()`; it is fitted to the robot.
            z2_range: momenta the policy was trained on (kg m^2/s), wide bounds if None.
            torque_limit: [m] (N m), the robot's own if None.
            stance: thresholds, the defaults if None.
            period_s: time between two ticks (s).
            reset_residual: corrects the impact that the steps of a family begin with.
            joints: rotors and friction that torques are for; None for those of `robot`.
        """
        middle = CommandLimits.of(policy.commands).middle
        parameters = _steady_parameters(robot, policy, middle, reset_residual)
        of_middle = policy.from_step_parameters(parameters)
        limit = robot.torque_limit if torque_limit is None else torque_limit
        momenta = z2_range or momenta_of_walking(momentum_unit(robot))
        return cls(
            robot=robot,
            policy=policy,
            law=law.with_gains_for(JointResponse(robot)),
            bounds=zero_state_bounds(of_middle, momenta),
            torque_limit=np.asarray(limit, dtype=np.float64),
            stance=TouchdownThresholds() if stance is None else stance,
            period_s=period_s,
            reset_residual=reset_residual,
            joints=joints,
        )

    def believed(self, now: CommandState) -> PlanarBiped:
        """Return the model of the step under way: leaning as it was told, if that is a command."""
        return believed_robot(self.robot, self.policy.commands, now.pair.after)

    def parameters_of_step(self, pair: Pair) -> Float[Array, " s"]:
        """Return the parameters of a step with these commands."""
        return self.policy.parameters_of_step(self.robot, pair, self.reset_residual)

    def latch(self, before: CommandState, touchdown: Bool[Array, ""]) -> CommandState:
        """Take over what was requested, if the tick is a touchdown. Returns: `CommandState`."""
        commands = self.policy.commands
        if not commands:
            return before
        pair = command_state.next_pair(commands, before)
        after = CommandState(before.requested, pair, self.parameters_of_step(pair))
        return jax.tree.map(lambda new, old: jnp.where(touchdown, new, old), after, before)


@eqx.filter_jit
def _steady_parameters(
    robot: PlanarBiped,
    policy: AbstractPolicy,
    command: Float[Array, " p"],
    reset_residual: ResetCorrection,
) -> Float[Array, " s"]:
    one = jnp.asarray(command, dtype=float)
    return policy.parameters_of_step(robot, Pair(one, one), reset_residual)


class ControllerState(NamedTuple):
    """State that a controller keeps from tick to tick."""

    stance: StanceState
    """Stance leg and time since touchdown."""
    ticks_to_policy: Int[Array, ""]
    """Ticks until the policy is evaluated again."""
    held: Desired
    """Latest output of the policy."""
    commands: CommandState
    """Commands, and the parameters of the step under way."""
    ankle: Scalar | None = None
    """Torque of the stance ankle at the last tick [N m]; None on point feet."""


class TickResult(NamedTuple):
    """Output of a tick: torques, and the measured quantities behind them."""

    torque: Float[Array, "2 k"]
    """Joint torques per leg, from the lowest joint up, legs as in the robot file [N m]."""
    actuated: Actuated
    """Torques in the order of the actuated coordinates [N m]. [m]"""
    q: Coordinates
    """Measured coordinates [rad]. [n]"""
    dq: Coordinates
    """Measured rates [rad/s]. [n]"""
    y_d: Actuated
    """Desired outputs [rad]. [m]"""
    dy_d: Actuated
    """Desired output rates [rad/s]. [m]"""
    z: ZeroState
    """Measured zero dynamics state (m, kg m^2/s). [2]"""
    leg: Int[Array, ""]
    """Stance leg."""
    since_touchdown: Scalar
    """Time since the last touchdown [s], infinite before the first."""
    touchdown: Bool[Array, ""]
    """Whether the stance leg changed at this tick."""
    saturated: Bool[Array, ""]
    """Whether any torque was clipped, or is at its limit."""
    relaxed: Bool[Array, "2"]
    """Requirements that a law gave up to stay within limits, see `LimitedTorque`."""
    commands: Float[Array, "2 p"]
    """Commands of the step before, and of this one. [2, p]"""
    ankle: Scalar | None = None
    """Torque of the stance ankle, positive forward [N m]; None on point feet."""


def start(
    controller: Controller,
    leg: Int[Array, ""] | int = 0,
    command: Float[Array, " p"] | None = None,
) -> ControllerState:
    """Return the state before the first tick, standing on `leg`.

    Args:
        controller: controller to start.
        leg: stance leg.
        command: constant command before the start; the middle of the ranges if None.
    """
    n, policy = controller.robot.n, controller.policy
    limits = CommandLimits.of(policy.commands)
    one = jnp.asarray(limits.middle if command is None else command, dtype=float)
    steady = Pair(one, one)
    first = CommandState(one, steady, controller.parameters_of_step(steady))
    at_rest = MeasuredState(jnp.zeros(n), jnp.zeros(n), jnp.zeros(2), jnp.zeros(2))
    at_rest = _with_ankle(controller, first, at_rest)
    shapes = jax.eval_shape(_desired, controller, first, at_rest)
    torques = jax.tree.map(lambda leaf: jnp.zeros(leaf.shape, leaf.dtype), shapes)
    ankle = None if controller.robot.feet is None else jnp.zeros(())
    return ControllerState(start_stance(leg), jnp.zeros((), jnp.int32), torques, first, ankle)


def tell(
    controller: Controller, state: ControllerState, requested: Float[Array, " p"]
) -> ControllerState:
    """Request other commands from the next touchdown on, see `command_state.tell`."""
    updated = command_state.tell(controller.policy.commands, state.commands, requested)
    return state._replace(commands=updated)


def step(
    controller: Controller, state: ControllerState, measurement: Measurement
) -> tuple[ControllerState, TickResult]:
    """Compute one control tick. Returns: the next state, and the `TickResult`."""
    robot, law, joints = controller.robot, controller.law, controller.joints
    q_before, _ = coordinates(robot, measurement, state.stance.leg)
    force, period = measurement.normal_force, controller.period_s
    standing, touchdown = advance_stance(
        controller.stance, robot, state.stance, q_before, force, period
    )
    q, dq = coordinates(robot, measurement, standing.leg)
    foot_velocity = stance_foot_velocity(robot, q, dq, measurement.hip_velocity)
    now = controller.latch(state.commands, touchdown)
    robot = controller.believed(now)
    reading = MeasuredState(q, dq, *zero_state(robot, q, dq, foot_velocity))
    reading = _with_ankle(controller, now, reading)
    if law.uses_impact_consistent_rates:
        after = impact_consistent_rates(robot, _outputs(controller, now), reading)
        reading = jax.tree.map(lambda new, old: jnp.where(touchdown, new, old), after, reading)
    # When the hold is over; and at a touchdown, since held outputs are for the old stance.
    ask = touchdown | (state.ticks_to_policy <= 0)
    held = jax.tree.map(
        lambda new, old: jnp.where(ask, new, old), _desired(controller, now, reading), state.held
    )
    remaining = jnp.where(ask, law.hold_ticks, state.ticks_to_policy) - 1
    model = robot if joints is None else robot.with_joints(joints.armature, joints.damping)
    requested_torque = law.torque(model, reading, held)
    if joints is not None and law.takes_joints:
        requested_torque = requested_torque + joints.friction_torque(held.dy)
    demand = Demand(reading, held, requested_torque, controller.torque_limit)
    torque, saturated, relaxed = law.apply_limits(model, demand)
    motors = stance_ankle.motors(robot.layout, robot.feet, robot.damping[0], reading, torque)
    result = TickResult(
        torque=leg_joints(robot.layout, motors, standing.leg),
        actuated=torque,
        q=q,
        dq=dq,
        y_d=held.y,
        dy_d=held.dy,
        z=reading.z,
        leg=standing.leg,
        since_touchdown=standing.since_touchdown,
        touchdown=touchdown,
        saturated=saturated,
        relaxed=relaxed,
        commands=jnp.stack(now.pair),
        ankle=reading.ankle,
    )
    return ControllerState(standing, remaining, held, now, reading.ankle), result


def _desired(controller: Controller, now: CommandState, reading: MeasuredState) -> Desired:
    return controller.law.desired(controller.believed(now), _outputs(controller, now), reading)


def _outputs(controller: Controller, now: CommandState) -> Outputs:
    """Return the policy of the step under way, with the z that the law gives it."""
    policy, policy_state = _step_policy(controller, now)
    return lambda z: policy(policy_state(z))


def _step_policy(
    controller: Controller, now: CommandState
) -> tuple[AbstractPolicy, Callable[[ZeroState], ZeroState]]:
    """Return the policy of the step under way, and what it gets in place of a measured z."""
    policy = controller.policy.from_step_parameters(now.step_parameters)
    bounds = controller.bounds.over(policy)
    # After the bounds, whose interval need not hold what a law tells instead of z2.
    return policy, lambda z: controller.law.policy_state(bounds(z))


def _with_ankle(controller: Controller, now: CommandState, reading: MeasuredState) -> MeasuredState:
    """Return a reading with the policy's torque of the stance ankle, if the robot has one."""
    if controller.robot.feet is None:
        return reading
    policy, policy_state = _step_policy(controller, now)
    return stance_ankle.read(reading, lambda z: policy.ankle_torque(policy_state(z)))
