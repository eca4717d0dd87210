"""Interface of a policy: desired outputs y_d(z), bounded by the joint ranges, with derivatives."""

from abc import abstractmethod
from collections.abc import Callable
from typing import Any, NamedTuple

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np

from neuralgaits._types import Actuated, Array, Float, Scalar, ZeroState
from neuralgaits.errors import InputError
from neuralgaits.gait.activations import logistic
from neuralgaits.gait.commands import Commands, Number, Pair, Step
from neuralgaits.gait.network import Network, movable, scaled_inputs
from neuralgaits.gait.reset_residual import ResetCorrection
from neuralgaits.gait.stepping_robot import SteppingRobot
from neuralgaits.gait.zero_coordinates import combined


class AbstractPolicy(eqx.Module):
    """Desired outputs as a function of the zero dynamics state.

    The parametrisation y_d(z; theta) of the paper, section 3.1.
    """

    @abstractmethod
    def __call__(self, z: ZeroState) -> Actuated:
        """Desired actuated joint angles. Returns: [m] (rad)."""

    def ankle_torque(self, z: ZeroState) -> Scalar | None:
        """Torque of the stance ankle, positive forward (N m); None for a robot on point feet."""
        del z
        return None

    @property
    def commands(self) -> Commands:
        """Commands of a family of policies at each touchdown; () for a policy of all steps."""
        return ()

    @property
    def step(self) -> Step | None:
        """Commands of the step of this policy; None for a gait without commands."""
        return None

    @property
    def steady_next(self) -> "AbstractPolicy":
        """The policy of the next step, if the command stays: itself, for one that takes none."""
        return self

    def phase(self, z1: Number) -> Any:
        """Phase of the step at z1 (m), of its own kind: 0 at the start, 1 at the guard."""
        start, guard = self.z1_range
        return (z1 - start) / (guard - start)

    @property
    def hidden_widths(self) -> tuple[int, ...] | None:
        """Widths of the network's hidden layers; None for a policy without a network."""
        return None

    @property
    @abstractmethod
    def z1_range(self) -> tuple[Scalar, Scalar]:
        """z1 at the start of a step and at the guard (m)."""

    def match_impact(
        self, robot: SteppingRobot, reset_residual: ResetCorrection = None
    ) -> "AbstractPolicy":
        """Return the policy with everything that follows from robot and parameters recomputed.

        Itself, for one of which nothing does: free ones, and families, each of whose policies is
        matched when it is asked for. Training calls it before every evaluation, and once more at
        the end, so that a stored policy evaluates without the robot.

        Args:
            robot: whose impact it is matched to.
            reset_residual: corrects that impact.
        """
        del robot, reset_residual
        return self

    def at(
        self,
        robot: SteppingRobot,
        pair: Pair,
        reset_residual: ResetCorrection = None,
        *,
        exact: bool = False,
    ) -> "AbstractPolicy":
        """The policy of a step between two commands: itself, for one that takes none.

        Args:
            robot: whose impact it is matched to.
            pair: commands of the step before and of this one. [p] each
            reset_residual: corrects that impact.
            exact: whether to return one smooth formula of the pair, for proofs.
        """
        del robot, pair, reset_residual, exact
        return self

    @property
    def step_size(self) -> int:
        """Length of the vector of parameters of a step; 0 for one policy of every step."""
        return 0

    def parameters_of_step(
        self, robot: SteppingRobot, pair: Pair, reset_residual: ResetCorrection = None
    ) -> Float[Array, " s"]:
        """Return the parameters of a step between two commands, once a step. [step_size].

        Args:
            robot: whose impact it is matched to.
            pair: commands of the step before and of this one. [p] each
            reset_residual: corrects that impact.
        """
        del robot, pair, reset_residual
        return jnp.zeros(0)

    def from_step_parameters(self, step_parameters: Float[Array, " s"]) -> "AbstractPolicy":
        """Put together the policy of a step; itself, for one without parameters."""
        del step_parameters
        return self

    @abstractmethod
    def trainable(self) -> "AbstractPolicy":
        """A tree of booleans like this policy: True where training may move a leaf."""


class NetworkPolicy(AbstractPolicy):
    """A policy that is a network of z between output bounds.

    Attributes:
        network: N, inputs z / input_scale - input_shift, outputs [m].
        lower, upper: output bounds [rad]. [m]
        input_scale, input_shift: network input scaling. [2]
    """

    network: Network
    lower: Float[Array, " m"]
    upper: Float[Array, " m"]
    input_scale: Float[Array, "2"]
    input_shift: Float[Array, "2"]

    @property
    def hidden_widths(self) -> tuple[int, ...]:
        """Widths of the network's hidden layers."""
        return tuple(len(bias) for bias in self.network.biases[:-1])

    def inputs(self, z: ZeroState) -> ZeroState:
        """Return the scaled inputs of the network. [2]."""
        return scaled_inputs(z, self.input_scale, self.input_shift)

    def within_bounds(self, logits: Actuated) -> Actuated:
        """Outputs between the bounds. Returns: [m] (rad)."""
        return self.lower + (self.upper - self.lower) * logistic(logits)

    def trainable(self) -> "NetworkPolicy":
        """Flags of trainable leaves: the network may move; bounds and scales are fixed."""
        return movable(self, lambda policy: policy.network)


class FreePolicy(AbstractPolicy):
    """A policy that depends on no robot, not even for the ends of its steps.

    Attributes:
        start_and_guard: nominal z1 at the start of a step and at the guard [m]. [2]
    """

    start_and_guard: eqx.AbstractVar[Float[Array, "2"]]

    @property
    def z1_range(self) -> tuple[Scalar, Scalar]:
        """Nominal z1 at the start of a step and at the guard (m)."""
        # The ellipsis keeps NumPy from returning bare scalars.
        return self.start_and_guard[0, ...], self.start_and_guard[1, ...]


class OutputJet(NamedTuple):
    """Desired outputs and their derivatives at one z."""

    y: Actuated
    """y_d(z) [rad]. [m]"""
    jacobian: Float[Array, "m d"]
    """Partial derivatives, in positions [rad/m], then momenta [rad s/(kg m^2)]. [m, d]"""

    def rate(self, dz: ZeroState) -> Actuated:
        """Return the rate of the desired outputs at this rate of z [rad/s]. [m]."""
        return combined(self.jacobian, dz)

    def rate_errors(self, rates: Actuated, dz: ZeroState) -> Actuated:
        """Return how far joint rates are from the desired ones at this rate of z [rad/s]. [m]."""
        for column, rate in zip(self.jacobian.T, dz, strict=True):
            rates = rates - column * rate
        return rates


@eqx.filter_jit
def output_jet(policy: AbstractPolicy, z: ZeroState) -> OutputJet:
    """Return the desired outputs and their partial derivatives.

    This function is a call of its own in any function that is traced around it, so that JAX traces
    a network once, however many points a function evaluates.

    Returns: `OutputJet`.
    """
    y, derivative = jax.linearize(policy, z)
    slopes = jax.vmap(derivative)(np.eye(len(z), dtype=z.dtype))
    return OutputJet(y, slopes.T)


def refuse_other_joints(robot: SteppingRobot, y: Actuated) -> None:
    """Check that outputs are one for each actuated joint of the robot.

    Raises: InputError if the policy is for a robot with other joints.
    """
    if y.shape != (robot.n - 1,):
        raise InputError(
            f"policy: expected {robot.n - 1} outputs, one for each actuated joint of "
            f"{robot.name}, found shape {y.shape}: use a policy made for this robot"
        )


Curve = Callable[[ZeroState], OutputJet]
"""Linear map from a direction of z to the derivative of the jet along it."""


def output_jet_and_change(policy: AbstractPolicy, z: ZeroState) -> tuple[OutputJet, Curve]:
    """Compute the jet, and the map from a direction to the jet's derivative along it.

    The map's `jacobian @ v` is the second derivative D^2 y_d(z)[v, direction].

    Returns: `OutputJet` and a linear function [d] -> `OutputJet`.
    """
    return jax.linearize(lambda point: output_jet(policy, point), jnp.asarray(z))
