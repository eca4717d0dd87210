"""Programs of a controller: every smooth part of a control tick, traced once.

The other parts (bounds of z, stance, limits, faults) are written by hand in `c/controller.c`.
"""

import re
from collections.abc import Callable, Mapping
from typing import Any

import jax
import jax.numpy as jnp

from neuralgaits._types import Actuated, Array, Float, ZeroState
from neuralgaits.control import Controller
from neuralgaits.errors import SpecError
from neuralgaits.export.robot_programs import (
    Part,
    dynamics,
    feet,
    lean_of_interval,
    momentum_about_contact,
    standing_rates_of,
    tells_lean,
    zero_dynamics_state,
)
from neuralgaits.gait import AbstractPolicy
from neuralgaits.gait.commands import Pair
from neuralgaits.programs import Program
from neuralgaits.programs.tracing.tracer import trace

_POLICY_INPUTS = {"z": (2,), "dz": (2,)}


def rate(policy: AbstractPolicy) -> Callable[..., dict[str, Array]]:
    """Return desired outputs and rates: (z, dz) to y, dy (rad, rad/s).

    A family's depend on its `step` as well.
    """

    def compute(
        z: ZeroState, dz: ZeroState, step: Float[Array, " s"] | None = None
    ) -> dict[str, Array]:
        y, dy = jax.jvp(_for_step(policy, step), (z,), (dz,))
        return {"y": y, "dy": dy}

    return compute


def path(policy: AbstractPolicy) -> Callable[..., dict[str, Array]]:
    """Return outputs along a path z(t), with two derivatives, and their slope in z1.

    With ddz1 = 0 in `ddz` the second derivative is the drift of `control.fblin`.
    """

    def compute(
        z: ZeroState, dz: ZeroState, ddz: ZeroState, step: Float[Array, " s"] | None = None
    ) -> dict[str, Array]:
        at = _for_step(policy, step)

        def first(z: ZeroState, dz: ZeroState) -> tuple[Actuated, Actuated]:
            return jax.jvp(at, (z,), (dz,))

        (y, dy), (_, ddy) = jax.jvp(first, (z, dz), (dz, ddz))
        _, slope = jax.jvp(at, (z,), (jnp.array([1.0, 0.0]),))
        return {"y": y, "dy": dy, "slope": slope, "drift": ddy}

    return compute


def _for_step(policy: AbstractPolicy, step: Float[Array, " s"] | None) -> AbstractPolicy:
    return policy if step is None else policy.from_step_parameters(step)


def _step(policy: AbstractPolicy) -> dict[str, tuple[int, ...]]:
    """Return the input that the functions of a family have beside z."""
    return {"step": (policy.step_size,)} if policy.step_size else {}


def policy_rate(policy: AbstractPolicy) -> Part:
    """Return the Program of y_d and its rate.

    Raises: SpecError naming the primitive of a policy that cannot be traced.
    """
    return Part(
        "ng_policy_rate",
        "Policy: desired outputs y [rad] and rates dy [rad/s] at z (m, kg m^2/s), dz.",
        _policy(rate(policy), _POLICY_INPUTS | _step(policy), policy),
    )


def policy_ankle(policy: AbstractPolicy) -> Part:
    """Return the Program of the stance ankle's torque and its slopes in z.

    Raises: SpecError naming the primitive of a policy that cannot be traced.
    """

    def compute(z: ZeroState, step: Float[Array, " s"] | None = None) -> dict[str, Array]:
        at = _for_step(policy, step)
        torque, push = jax.linearize(at.ankle_torque, z)
        return {"torque": torque, "slope": jnp.stack([push(axis) for axis in jnp.eye(2)])}

    return Part(
        "ng_policy_ankle",
        "Torque of the stance ankle [N m], positive forward, and its slopes in z.",
        _policy(compute, {"z": (2,)} | _step(policy), policy),
    )


def policy_in_one(controller: Controller) -> Part:
    """Return the Program as one function of z, dz and, for a family, its commands, without memory.

    Raises: SpecError naming the primitive of a policy that cannot be traced.
    """
    policy, robot, reset_residual = controller.policy, controller.robot, controller.reset_residual
    if not policy.step_size:
        return policy_rate(policy)

    def compute(z: ZeroState, dz: ZeroState, commands: Float[Array, "2 p"]) -> dict[str, Array]:
        at = policy.at(robot, Pair(*commands), reset_residual, exact=True)
        return rate(at)(z, dz)

    shapes = _POLICY_INPUTS | {"commands": (2, len(policy.commands))}
    part = policy_rate(policy)
    return part._replace(program=_policy(compute, shapes, policy))


def policy_step(controller: Controller) -> Part:
    """Return the Program for the numbers that a family computes once a step.

    Raises: SpecError naming the primitive of a policy that cannot be traced.
    """

    def compute(before: Float[Array, " p"], after: Float[Array, " p"]) -> dict[str, Array]:
        return {"step": controller.parameters_of_step(Pair(before, after))}

    policy = controller.policy
    shape = (len(policy.commands),)
    return Part(
        "ng_policy_step",
        "Once a step: the numbers that the policy has for it, from the commands of the step "
        "before and of this one.",
        _policy(compute, {"before": shape, "after": shape}, policy),
    )


def parts(controller: Controller) -> list[Part]:
    """Return every Program of a controller.

    Raises: SpecError naming the primitive of a policy that cannot be traced.
    """
    policy = controller.policy
    once = [policy_step(controller)] if policy.step_size else []
    once += [policy_ankle(policy)] if controller.robot.feet is not None else []
    return [
        policy_rate(policy),
        Part(
            "ng_policy_path",
            "Policy along z(t): y [rad], dy [rad/s], slope dy/dz1 [rad/m], drift ddy [rad/s^2].",
            _policy(path(policy), _POLICY_INPUTS | {"ddz": (2,)} | _step(policy), policy),
        ),
        *once,
        zero_dynamics_state(controller),
        dynamics(controller),
        feet(controller),
        momentum_about_contact(controller),
        standing_rates_of(controller),
        *([lean_of_interval(controller)] if tells_lean(policy) else []),
    ]


def _policy(
    compute: Callable[..., Mapping[str, Any]], shapes: Mapping[str, tuple], policy: AbstractPolicy
) -> Program:
    try:
        return trace(compute, shapes, parameters=policy)
    except SpecError as error:
        match = re.search(r"cannot trace [^:]*", str(error))
        raise SpecError(
            "expected a smooth policy, which is what C and ONNX are written from, found one that "
            f"{match.group() if match else error}: train with tanh or softplus"
        ) from None
