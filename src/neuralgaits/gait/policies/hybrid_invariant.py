"""A policy whose outputs and rates match through the real impact by construction.

Near both ends of a step y_d follows a cubic in logit space whose end values and slopes are
free at the guard and *computed* at the start of the step: the robot's own plastic impact, legs
relabelled, gives them. A network bends the path in between and vanishes with its slope at
both ends. The guard is therefore the line z1 = z_G, the zero dynamics manifold is hybrid
invariant, and the impact multiplies z2 by a constant. Hybrid invariance as
in Westervelt, Grizzle and Koditschek (2003).
"""

from dataclasses import replace
from typing import Any

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import PRNGKeyArray
from typing_extensions import override

from neuralgaits._types import Actuated, Array, Float, Scalar, ZeroState
from neuralgaits.gait.ankle import AnkleTorque
from neuralgaits.gait.commands import Number, Step
from neuralgaits.gait.network import Network, movable
from neuralgaits.gait.policies.step_ends import (
    Foothold,
    Guard,
    Start,
    cubic_between,
    inside,
    level_at,
    logit_ends,
    on_foothold,
    start_after,
)
from neuralgaits.gait.policies.step_policy import StepPolicy
from neuralgaits.gait.posture import Posture, frame_of, walking_posture
from neuralgaits.gait.reset_residual import ResetCorrection
from neuralgaits.gait.stepping_robot import SteppingRobot


class HybridInvariantPolicy(StepPolicy):
    """Desired outputs y_d = lower + (upper - lower) logistic(H(t) + 4 (4t(1-t))^2 N(z)).

    t = (z1 - z_start) / (z_guard - z_start) is the phase of the step, H a cubic, N a network.

    N is given z / input_scale - input_shift; its second entry is 0 unless `z2_dependence`. Its
    output is multiplied by a function of t that vanishes with its slope at t = 0 and t = 1.

    Inherited from `StepPolicy` and `NetworkPolicy`: z_start [m], z_guard [m] and cubic [4, m], of
    which z_start and cubic follow from robot and guard; network, lower and upper bounds of y_d
    [rad] [m], input_scale and input_shift [2]. Only the network of these is trainable.

    Attributes:
        guard_outputs: desired outputs at the guard [rad]; trainable, except that the swing
            hip follows from the foot touching the ground. [m]
        guard_slopes: their slopes d y_d / d z1 at the guard [rad/m]; trainable. [m]
        start_outputs, start_slopes: outputs and slopes after the impact; computed. [m]
        momentum_ratio: z2 after impact / z2 before; computed.
        z2_dependence: False makes y_d a function of z1 alone.
        step_commands: value of `step`, a property, which no field can override.
        then: the policy of the next step, if the command stays; None for this one.
        ends: values and slopes of H at phases 0 and 1, (H0, H0', H1, H1'), in whose terms it is
            evaluated if they are given: bounds of it are then as tight as those of its ends. [4, m]
        anchor: a phase and the z1 that it is at, from which other phases are counted, so that what
            start and guard depend on cancels in a proof; None where both are numbers. [2]
        ankle: torque of the stance ankle of a robot with flat feet; None on point feet.
    """

    guard_outputs: Float[Array, " m"]
    guard_slopes: Float[Array, " m"]
    start_outputs: Float[Array, " m"]
    start_slopes: Float[Array, " m"]
    momentum_ratio: Float[Array, ""]
    z2_dependence: bool = eqx.field(static=True)
    step_commands: Step | None = None
    then: "HybridInvariantPolicy | None" = None
    ends: Float[Array, "4 m"] | None = None
    anchor: Float[Array, "2"] | None = None
    ankle: AnkleTorque | None = None

    @classmethod
    def init(
        cls,
        robot: SteppingRobot,
        *,
        key: PRNGKeyArray,
        hidden: tuple[int, ...] = (32, 32),
        activation: str = "tanh",
        z2_dependence: bool = True,
        posture: Posture | None = None,
    ) -> "HybridInvariantPolicy":
        """Start near a nominal walking posture, with a small random network.

        Args:
            robot: sets bounds, scales and the impact.
            key: random key of the network.
            hidden: widths of the hidden layers.
            activation: activation of the network.
            z2_dependence: False makes y_d a function of z1 alone.
            posture: nominal posture, `walking_posture(robot)` by default.
        """
        posture = walking_posture(robot) if posture is None else posture
        m = robot.n - 1
        network = Network.init((2, *hidden, m), activation=activation, key=key, near=posture.bend)
        ankle = None
        if robot.feet is not None:
            ankle = AnkleTorque.init(robot.feet, posture, key=jax.random.fold_in(key, 1))
        zeros = np.zeros(m)
        policy = cls(
            network=network,
            guard_outputs=posture.guard_outputs,
            guard_slopes=posture.guard_slopes,
            **frame_of(posture),
            z_guard=np.asarray(posture.z_guard),
            z_start=np.zeros(()),
            cubic=np.zeros((4, m)),
            start_outputs=zeros,
            start_slopes=zeros,
            momentum_ratio=np.ones(()),
            z2_dependence=z2_dependence,
            ankle=ankle,
        )
        return _match(policy, robot)

    @override
    def ankle_torque(self, z: ZeroState) -> Scalar | None:
        if self.ankle is None:
            return None
        return self.ankle(z if self.z2_dependence else z * jnp.array([1.0, 0.0]))

    def phase(self, z1: Number) -> Any:
        """Phase of the step at a hip position."""
        if self.anchor is None:
            return super().phase(z1)
        return self.anchor[0] + (z1 - self.anchor[1]) / (self.z_guard - self.z_start)

    def path(self, phase: Number) -> Actuated:
        """H, in powers of the phase or in terms of its ends. Returns: [m]."""
        if self.ends is None:
            return super().path(phase)
        rest = 1.0 - phase
        p0, d0, p1, d1 = self.ends
        near = (1.0 + 2.0 * phase) * p0 + phase * d0
        far = (1.0 + 2.0 * rest) * p1 - rest * d1
        return (rest * rest) * near + (phase * phase) * far

    @property
    @override
    def step(self) -> Step | None:
        return self.step_commands

    @property
    @override
    def steady_next(self) -> "HybridInvariantPolicy":
        return self if self.then is None else self.then

    def match_impact(
        self, robot: SteppingRobot, reset_residual: ResetCorrection = None
    ) -> "HybridInvariantPolicy":
        """Recompute start of the step and cubic from the robot's impact at the guard."""
        outputs = inside(self.guard_outputs, self.lower, self.upper)
        outputs = on_foothold(robot, self.z_guard, outputs, Foothold())
        guard = level_at(robot, Guard(self.z_guard, outputs, self.guard_slopes))
        return self.between(start_after(robot, guard, reset_residual), guard)

    def between(
        self, start: Start, guard: Guard, *, exact: bool = False
    ) -> "HybridInvariantPolicy":
        """Return this policy with other ends of its step.

        Unless `exact`, the path is kept inside the bounds; start and guard are kept unchanged.
        """
        first, last = start, guard
        if not exact:
            first = start._replace(outputs=inside(start.outputs, self.lower, self.upper))
            last = guard._replace(outputs=inside(guard.outputs, self.lower, self.upper))
        ends = logit_ends(first, last, self.lower, self.upper)
        return replace(
            self,
            guard_outputs=guard.outputs,
            guard_slopes=guard.slopes,
            z_guard=guard.z1,
            z_start=start.z1,
            cubic=cubic_between(ends),
            start_outputs=start.outputs,
            start_slopes=start.slopes,
            momentum_ratio=start.momentum_ratio,
            ends=ends if exact else self.ends,
        )

    def trainable(self) -> "HybridInvariantPolicy":
        """Flags of trainable leaves: networks, guard outputs and guard slopes."""

        def free_parts(policy: HybridInvariantPolicy):
            of_ankle = () if policy.ankle is None else (policy.ankle.network,)
            return policy.network, policy.guard_outputs, policy.guard_slopes, *of_ankle

        return movable(self, free_parts)


@eqx.filter_jit
def _match(policy: HybridInvariantPolicy, robot: SteppingRobot) -> HybridInvariantPolicy:
    return policy.match_impact(robot)
