"""A policy whose outputs and rates match through the real impact by construction.

Near both ends of a step y_d follows a cubic in logit space whose end values and slopes are
free at the guard and *computed* at the start of the step: the robot's own plastic impact, legs
relabelled, gives them. A network bends the path in between and vanishes with its slope at
both ends. The guard is therefore the line z1 = z_G, the zero dynamics manifold is hybrid
invariant, and the impact multiplies z2 by a constant. Hybrid invariance as
in Westervelt, Grizzle and Koditschek (2003).
"""

from typing import TYPE_CHECKING

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import PRNGKeyArray

from neuralgaits._types import Actuated, Array, Coordinates, Float, Scalar, ZeroState
from neuralgaits.gait.activations import logistic
from neuralgaits.gait.coordinates import lift
from neuralgaits.gait.network import Network, scaled_inputs
from neuralgaits.gait.policy import AbstractPolicy
from neuralgaits.gait.posture import Posture, hip_indices, walking_posture
from neuralgaits.gait.reset_residual import AbstractResetResidual, rates_after
from neuralgaits.robots.dynamics import angular_momentum, swing_foot

if TYPE_CHECKING:
    from neuralgaits.robots import Impact, PlanarBiped

# How far inside the output bounds the end points are kept, as a share of the bounds' width:
# on the bound the logit is infinite and a warm start would turn to NaN.
END_POINT_MARGIN = 1e-3
# Newton steps that put the swing foot on the ground at the guard: quadratic convergence from
# a posture within a few centimetres leaves rounding error only.
FOOT_NEWTON_STEPS = 6


class HybridInvariantPolicy(AbstractPolicy):
    """Desired outputs y_d = lower + (upper - lower) logistic(H(t) + 4 (4t(1-t))^2 N(z)).

    t = (z1 - z_start) / (z_guard - z_start) is the phase of the step, H a cubic, N a network.

    Attributes:
        network: N, inputs z / input_scale - input_shift, outputs [m].
        guard_outputs: desired outputs at the guard [rad]; trainable, except that the swing
            hip follows from the foot touching the ground. [m]
        guard_slopes: their slopes d y_d / d z1 at the guard [rad/m]; trainable. [m]
        lower, upper: output bounds [rad]. [m]
        input_scale, input_shift: network input scaling. [2]
        z_guard: z1 at the guard [m].
        z_start: z1 after the impact [m]; follows from robot and guard.
        cubic: coefficients of H in powers of t; follow likewise. [4, m]
        start_outputs, start_slopes: outputs and slopes after the impact; follow likewise. [m]
        momentum_ratio: z2 after impact / z2 before; follows likewise.
    """

    network: Network
    guard_outputs: Float[Array, " m"]
    guard_slopes: Float[Array, " m"]
    lower: Float[Array, " m"]
    upper: Float[Array, " m"]
    input_scale: Float[Array, "2"]
    input_shift: Float[Array, "2"]
    z_guard: Float[Array, ""]
    z_start: Float[Array, ""]
    cubic: Float[Array, "4 m"]
    start_outputs: Float[Array, " m"]
    start_slopes: Float[Array, " m"]
    momentum_ratio: Float[Array, ""]
    z2_dependence: bool = eqx.field(static=True)

    @classmethod
    def init(
        cls,
        robot: "PlanarBiped",
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
            activation: of the network.
            z2_dependence: False makes y_d a function of z1 alone.
            posture: nominal posture, `walking_posture(robot)` by default.
        """
        posture = walking_posture(robot) if posture is None else posture
        m = robot.n - 1
        network = Network.init((2, *hidden, m), activation=activation, key=key)
        small = 0.1 * network.weights[-1]
        network = eqx.tree_at(
            lambda net: (net.weights, net.biases),
            network,
            ((*network.weights[:-1], small), (*network.biases[:-1], posture.bend)),
        )
        zeros = np.zeros(m)
        policy = cls(
            network=network,
            guard_outputs=posture.guard_outputs,
            guard_slopes=posture.guard_slopes,
            lower=posture.lower,
            upper=posture.upper,
            input_scale=posture.input_scale,
            input_shift=posture.input_shift,
            z_guard=np.asarray(posture.z_guard),
            z_start=np.zeros(()),
            cubic=np.zeros((4, m)),
            start_outputs=zeros,
            start_slopes=zeros,
            momentum_ratio=np.ones(()),
            z2_dependence=z2_dependence,
        )
        return _match(policy, robot)

    def __call__(self, z: ZeroState) -> Actuated:
        """Desired actuated joint angles. Returns: [m] (rad)."""
        phase = (z[0] - self.z_start) / (self.z_guard - self.z_start)
        inputs = scaled_inputs(z, self.input_scale, self.input_shift)
        if not self.z2_dependence:
            inputs = jnp.stack([inputs[0], jnp.zeros_like(inputs[0])])
        bump = 4.0 * phase * (1.0 - phase)
        a0, a1, a2, a3 = self.cubic
        path = a0 + phase * (a1 + phase * (a2 + phase * a3))
        share = logistic(path + (4.0 * bump * bump) * self.network(inputs))
        return self.lower + (self.upper - self.lower) * share

    @property
    def z1_range(self) -> tuple[Scalar, Scalar]:
        """z1 after the impact and at the guard (m)."""
        return self.z_start, self.z_guard

    def matched(
        self, robot: "PlanarBiped", reset_residual: AbstractResetResidual | None = None
    ) -> "HybridInvariantPolicy":
        """Recompute start of the step and cubic from the robot's impact at the guard."""
        width = self.upper - self.lower
        inner_lower = self.lower + END_POINT_MARGIN * width
        inner_upper = self.upper - END_POINT_MARGIN * width
        guard = jnp.clip(self.guard_outputs, inner_lower, inner_upper)
        guard = _foot_on_ground(robot, self.z_guard, guard)
        q = lift(robot, jnp.asarray(self.z_guard), guard)
        dq = lift(robot, jnp.ones_like(q[0]), jnp.asarray(self.guard_slopes))
        after = _after_impact(robot, q, dq, reset_residual)
        speed = robot.hip_gradient @ after.dq
        start, start_slopes = after.q[1:], after.dq[1:] / speed
        z_start = robot.hip_gradient @ after.q
        span = self.z_guard - z_start
        logits, logit_slopes = [], []
        for outputs, slopes in ((start, start_slopes), (guard, self.guard_slopes)):
            share = (jnp.clip(outputs, inner_lower, inner_upper) - self.lower) / width
            logits.append(jnp.log(share / (1.0 - share)))
            logit_slopes.append(slopes * span / (width * share * (1.0 - share)))
        (p0, p1), (d0, d1) = logits, logit_slopes
        cubic = jnp.stack([p0, d0, 3.0 * (p1 - p0) - 2.0 * d0 - d1, 2.0 * (p0 - p1) + d0 + d1])
        ratio = angular_momentum(robot, after.q, after.dq) / angular_momentum(robot, q, dq)
        return eqx.tree_at(
            lambda p: (
                p.guard_outputs,
                p.z_start,
                p.cubic,
                p.start_outputs,
                p.start_slopes,
                p.momentum_ratio,
            ),
            self,
            (guard, z_start, cubic, start, start_slopes, ratio),
        )

    def trainable(self) -> "HybridInvariantPolicy":
        """Network, guard outputs and guard slopes may move; the rest follows or is fixed."""
        frozen = jax.tree.map(lambda _: False, self)
        return eqx.tree_at(
            lambda p: (p.network, p.guard_outputs, p.guard_slopes),
            frozen,
            (jax.tree.map(lambda _: True, self.network), True, True),
        )


@eqx.filter_jit
def _match(policy: HybridInvariantPolicy, robot: "PlanarBiped") -> HybridInvariantPolicy:
    return policy.matched(robot)


def _after_impact(
    robot: "PlanarBiped",
    q: Coordinates,
    dq: Coordinates,
    reset_residual: AbstractResetResidual | None,
) -> "Impact":
    after = robot.impact(q, dq)
    if reset_residual is None:
        return after
    # The rates are those of dz1 = 1 m/s: any z2 gives the same ratios.
    correction = reset_residual(reset_residual.centre)
    z2 = angular_momentum(robot, q, dq)
    return after._replace(dq=rates_after(robot, after.q, after.dq, correction, z2))


def _foot_on_ground(robot: "PlanarBiped", z_guard: Scalar, outputs: Actuated) -> Actuated:
    """Move the swing hip until the swing foot is on the ground at the guard."""
    hip = hip_indices(robot)[-1]
    direction = np.zeros(robot.n - 1, dtype=outputs.dtype)
    direction[hip] = 1.0

    def height(angle):
        return swing_foot(robot, lift(robot, jnp.asarray(z_guard), outputs + angle * direction))[1]

    angle = jnp.zeros_like(outputs[hip])
    for _ in range(FOOT_NEWTON_STEPS):
        value, slope = jax.jvp(height, (angle,), (jnp.ones_like(angle),))
        angle = angle - value / slope
    return outputs + angle * direction
