"""A family of policies: one for each pair of commands of a step, hybrid invariant across them all.

The posture at the guard, its slopes and its place are polynomials of the command; the swing foot
is put on its foothold exactly. A step begins as the real impact at the guard of the command before
leaves the robot, and ends at the guard of the command after; the network knows both. So the zero
dynamics manifold is invariant through the impact for every pair of commands.
"""

from dataclasses import replace

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import PRNGKeyArray

from neuralgaits._types import Actuated, Array, Float, Scalar, ZeroState
from neuralgaits.errors import InputError
from neuralgaits.gait.believed_robot import believed_robot
from neuralgaits.gait.command_polynomials import factors, plain_curves, powers, scaled
from neuralgaits.gait.commands import Commands, Ground, Pair, Step, place_of
from neuralgaits.gait.network import Network, movable
from neuralgaits.gait.policies.hybrid_invariant import HybridInvariantPolicy
from neuralgaits.gait.policies.step_ends import (
    Foothold,
    Guard,
    Start,
    inside,
    on_foothold,
    on_foothold_exactly,
    start_after,
    with_hip_at,
)
from neuralgaits.gait.policies.step_policy import TabulatedStep
from neuralgaits.gait.policy import NetworkPolicy
from neuralgaits.gait.posture import Posture, frame_of, walking_posture
from neuralgaits.gait.reset_residual import ResetCorrection
from neuralgaits.gait.stepping_robot import SteppingRobot

_NO_STEP = "expected a policy of one step, found a family of them: ask .at(robot, pair) first"


class CommandedPolicy(NetworkPolicy):
    """Policies `at(robot, pair)`, each an ordinary policy of one step.

    Attributes:
        network: network of the policies; inputs z, then the commands before and after, all scaled.
        guard_outputs: coefficients of the desired outputs at the guard, in units of half the
            output range around its middle before a smooth bound. [M, m]
        guard_slopes: coefficients of their slopes d y_d / d z1 [rad/m]. [M, m]
        guard_z1: coefficients of z1 at the guard [m]. [M]
        curves: cubics of the scaled commands, powers upwards: a speed that is asked for to the
            place in the family that walks at it, see `training.calibration`. [p, 4]
        taken_commands: value of `commands`, a property, which no field can override.
        z2_dependence: dependence of its policies on z2, see `HybridInvariantPolicy`.
    """

    guard_outputs: Float[Array, "M m"]
    guard_slopes: Float[Array, "M m"]
    guard_z1: Float[Array, " M"]
    curves: Float[Array, "p 4"]
    taken_commands: Commands = eqx.field(static=True)
    z2_dependence: bool = eqx.field(static=True, default=True)

    @classmethod
    def init(
        cls,
        robot: SteppingRobot,
        commands: Commands,
        *,
        key: PRNGKeyArray,
        hidden: tuple[int, ...] = (32, 32),
        activation: str = "tanh",
        posture: Posture | None = None,
        z2_dependence: bool = True,
    ) -> "CommandedPolicy":
        """Start near a nominal walking posture, the same for all commands but for their lengths.

        Args:
            robot: sets bounds and scales.
            commands: commands of the family, at least one.
            key: random key of the network.
            hidden: widths of the hidden layers.
            activation: activation of the network.
            posture: nominal posture, `walking_posture(robot)` by default.
            z2_dependence: False makes outputs functions of z1 and the commands alone.
        """
        posture = walking_posture(robot) if posture is None else posture
        m, p = robot.n - 1, len(commands)
        network = Network.init(
            (2 + 2 * p, *hidden, m), activation=activation, key=key, near=posture.bend
        )
        terms = factors(p)
        outputs, slopes = np.zeros((len(terms), m)), np.zeros((len(terms), m))
        slopes[0] = posture.guard_slopes
        z1 = np.zeros(len(terms))
        z1[0] = posture.z_guard
        for i, command in enumerate(commands):
            if command.name == "step_length":
                z1[0], z1[1 + i] = 0.5 * command.middle, 0.5 * command.half
            elif command.name == "speed":
                # A walk at twice the speed takes steps about half as long again.
                z1[1 + i] = 0.5 * posture.z_guard * command.half / command.middle
        # From here on a few Newton steps are enough.
        with jax.ensure_compile_time_eval():  # Runs are opened without computing weights.
            guard = np.asarray(_start_guard(robot, z1[:1], posture, commands))
        share = (guard - posture.lower) / (posture.upper - posture.lower)
        outputs[0] = np.log(share / (1.0 - share))
        return cls(
            network=network,
            guard_outputs=outputs,
            guard_slopes=slopes,
            guard_z1=z1,
            **frame_of(posture),
            curves=plain_curves(commands),
            taken_commands=commands,
            z2_dependence=z2_dependence,
        )

    @property
    def commands(self) -> Commands:
        """Commands that the gait receives at each touchdown."""
        return self.taken_commands

    def __call__(self, z: ZeroState) -> Actuated:
        """Raise InputError, since a family has no outputs of its own."""
        raise InputError(_NO_STEP)

    @property
    def z1_range(self) -> tuple[Scalar, Scalar]:
        """Raise InputError, since a family has no range of its own."""
        raise InputError(_NO_STEP)

    def trainable(self) -> "CommandedPolicy":
        """Flags of trainable leaves: network and guards may move, the rest is fixed."""
        return movable(self, lambda p: (p.network, p.guard_outputs, p.guard_slopes, p.guard_z1))

    def scaled(self, command: Float[Array, " p"]) -> Float[Array, " p"]:
        """Scale a command to its place in the family: about [-1, 1], 0 in the middle. [p]."""
        return scaled(self.commands, self.curves, command)

    def guard(
        self, robot: SteppingRobot, command: Float[Array, " p"], *, bounded: bool = False
    ) -> Guard:
        """Return the end of a step at this command, the swing foot on its foothold.

        Args:
            robot: robot whose foot it is.
            command: command of the step.
            bounded: as in `at`.
        """
        basis = powers(self.scaled(command))
        z1 = basis @ self.guard_z1
        share = jax.nn.sigmoid(basis @ self.guard_outputs)
        outputs = self.lower + (self.upper - self.lower) * share
        foothold = _foothold(self.commands, command)
        if bounded:
            outputs = on_foothold_exactly(robot, z1, outputs, foothold)
        else:
            newton_steps = 4  # From a few centimetres off they lead to 1e-12 m.
            outputs = on_foothold(robot, z1, outputs, foothold, newton_steps)
        return Guard(z1, outputs, basis @ self.guard_slopes)

    def at(
        self,
        robot: SteppingRobot,
        pair: Pair,
        reset_residual: ResetCorrection = None,
        *,
        exact: bool = False,
        bounded: bool = False,
    ) -> HybridInvariantPolicy:
        """The policy of one step.

        Args:
            robot: whose impact it is matched to, leaning as commanded if the lean is a command.
            pair: commands of the step before and of this one.
            reset_residual: corrects that impact.
            exact: leave out the clip that keeps a training off the bounds of the outputs: one
                smooth formula, and the same number for a trained gait.
            bounded: take formulas whose bounds over boxes are tight.
        """

        def ends(command: Float[Array, " p"]) -> tuple[Guard, Start]:
            guard = self.guard(robot, command, bounded=bounded)
            believed = believed_robot(robot, self.commands, command)
            return guard, start_after(believed, guard, reset_residual)

        # Both at once: what is compiled, or bounded in a proof, is half as long.
        both = jax.vmap(ends)(jnp.stack(pair))
        (before, start), (after, then) = (
            jax.tree.map(lambda leaf, i=i: leaf[i], both) for i in (0, 1)
        )
        ground = _ground(robot, self.commands, pair, before, after)
        again = _ground(robot, self.commands, pair.steady, after, after)
        # Whatever comes next, the impact at the end of this step is that of its own guard.
        start = start._replace(momentum_ratio=then.momentum_ratio)
        following = self._policy_between(pair.steady, again, then, after, exact=exact)
        policy = self._policy_between(pair, ground, start, after, exact=exact)
        return replace(policy, then=following)

    @property
    def step_size(self) -> int:
        """Length of the vector of parameters of a step."""
        return 2 + 4 * len(self.lower) + len(self.network.biases[0])

    def parameters_of_step(
        self, robot: SteppingRobot, pair: Pair, reset_residual: ResetCorrection = None
    ) -> Float[Array, " s"]:
        """Compute the `StepPolicy.step_parameters` of the exact policy of a step, see `at`."""
        return self.at(robot, pair, reset_residual, exact=True).step_parameters

    def from_step_parameters(self, step_parameters: Float[Array, " s"]) -> TabulatedStep:
        """Put together the policy of the step with these parameters."""
        weights, biases = self.network.weights, self.network.biases
        m = len(self.lower)
        return TabulatedStep(
            network=Network(
                (weights[0][:, :2], *weights[1:]),
                (step_parameters[2 + 4 * m :], *biases[1:]),
                self.network.activation,
            ),
            **frame_of(self),
            z_start=step_parameters[0],
            z_guard=step_parameters[1],
            cubic=step_parameters[2 : 2 + 4 * m].reshape(4, m),
            z2_dependence=self.z2_dependence,
        )

    def _policy_between(
        self, pair: Pair, ground: Ground | None, start: Start, guard: Guard, *, exact: bool
    ) -> HybridInvariantPolicy:
        ends = jnp.concatenate([self.scaled(command) for command in pair])
        weights, biases = self.network.weights, self.network.biases
        first = biases[0] + weights[0][:, 2:] @ ends
        policy = HybridInvariantPolicy(
            network=Network(
                (weights[0][:, :2], *weights[1:]), (first, *biases[1:]), self.network.activation
            ),
            guard_outputs=guard.outputs,
            guard_slopes=guard.slopes,
            **frame_of(self),
            z_guard=guard.z1,
            z_start=start.z1,
            cubic=jnp.stack([guard.outputs] * 4),
            start_outputs=start.outputs,
            start_slopes=start.slopes,
            momentum_ratio=start.momentum_ratio,
            z2_dependence=self.z2_dependence,
            step_commands=Step(pair, ground, tuple(command.name for command in self.commands)),
        )
        return policy.between(start, guard, exact=exact)


@eqx.filter_jit
def _start_guard(
    robot: SteppingRobot, z1: Float[Array, "1"], posture: Posture, commands: Commands
) -> Actuated:
    """Return outputs of the nominal posture with the swing foot on the middle foothold. [m]."""
    middle = jnp.array([command.middle for command in commands])
    foothold = _foothold(commands, middle)
    # Newton steps from the nominal posture, which may be far off.
    outputs = on_foothold(robot, z1[0], posture.guard_outputs, foothold, 20)
    return inside(outputs, posture.lower, posture.upper)


def _value(commands: Commands, command: Float[Array, " p"], name: str) -> Scalar | None:
    at = place_of(commands, name)
    return None if at is None else command[at]


def _foothold(commands: Commands, command: Float[Array, " p"]) -> Foothold:
    length, height, slope = (
        _value(commands, command, name) for name in ("step_length", "step_height", "slope")
    )
    rise = 0.0 if slope is None else jnp.tan(slope)
    return Foothold(length, 0.0 if height is None else height, rise)


def _ground(
    robot: SteppingRobot, commands: Commands, pair: Pair, before: Guard, after: Guard
) -> Ground | None:
    """Return the line from the old foothold to the next one; None where all is level."""
    if not {"step_height", "slope"} & {c.name for c in commands}:
        return None
    old, new = (robot.swing_foot(with_hip_at(robot, g.z1, g.outputs)) for g in (before, after))
    rise = (old[1] + new[1]) / (old[0] + new[0])
    slopes = [_value(commands, command, "slope") for command in pair]
    flat = jnp.zeros_like(rise)
    return Ground(rise, rise * old[0] - old[1], *(flat if s is None else s for s in slopes))
