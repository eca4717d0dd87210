"""Programs of a controller: every smooth part of a control tick, traced once.

The other parts (bounds of z, stance, limits, faults) are written by hand in `c/controller.c`.
"""

import re
from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp

from neuralgaits._types import Actuated, Array, Coordinates, Float, Planar, Scalar, ZeroState
from neuralgaits.control.clf_qp import ground_force
from neuralgaits.control.estimator import pinned
from neuralgaits.control.lean_sums import with_derivative
from neuralgaits.control.momentum import zero_state
from neuralgaits.errors import SpecError
from neuralgaits.gait import AbstractPolicy
from neuralgaits.gait.commands import LEAN, Pair, place_of
from neuralgaits.gait.reset_residual import ResetCorrection
from neuralgaits.programs import Program
from neuralgaits.programs.tracing.tracer import trace
from neuralgaits.robots import PlanarBiped
from neuralgaits.robots.dynamics import (
    centre_of_mass_velocity,
    hip_position,
    hip_velocity,
    swing_foot,
)
from neuralgaits.robots.mjcf.leaning import leaning_robot

_OF_POLICY = {"z": (2,), "dz": (2,)}


class Part(NamedTuple):
    """A Program that becomes one C function."""

    function: str
    """Name of the C function."""
    about: str
    """Description of its results, with units."""
    program: Program


def rate(policy: AbstractPolicy) -> Callable[..., dict[str, Array]]:
    """Return desired outputs and rates: (z, dz) to y, dy (rad, rad/s).

    A family's depend on its `step` as well.
    """

    def compute(
        z: ZeroState, dz: ZeroState, step: Float[Array, " s"] | None = None
    ) -> dict[str, Array]:
        y, dy = jax.jvp(_of(policy, step), (z,), (dz,))
        return {"y": y, "dy": dy}

    return compute


def path(policy: AbstractPolicy) -> Callable[..., dict[str, Array]]:
    """Return outputs along a path z(t), with two derivatives, and their slope in z1.

    With ddz1 = 0 in `ddz` the second derivative is the drift of `control.fblin`.
    """

    def compute(
        z: ZeroState, dz: ZeroState, ddz: ZeroState, step: Float[Array, " s"] | None = None
    ) -> dict[str, Array]:
        at = _of(policy, step)

        def first(z: ZeroState, dz: ZeroState) -> tuple[Actuated, Actuated]:
            return jax.jvp(at, (z,), (dz,))

        (y, dy), (_, ddy) = jax.jvp(first, (z, dz), (dz, ddz))
        _, slope = jax.jvp(at, (z,), (jnp.array([1.0, 0.0]),))
        return {"y": y, "dy": dy, "slope": slope, "drift": ddy}

    return compute


def _of(policy: AbstractPolicy, step: Float[Array, " s"] | None) -> AbstractPolicy:
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
        _policy(rate(policy), _OF_POLICY | _step(policy), policy),
    )


def policy_ankle(policy: AbstractPolicy) -> Part:
    """Return the Program of the stance ankle's torque and its slopes in z.

    Raises: SpecError naming the primitive of a policy that cannot be traced.
    """

    def compute(z: ZeroState, step: Float[Array, " s"] | None = None) -> dict[str, Array]:
        at = policy if step is None else policy.from_step_parameters(step)
        torque, push = jax.linearize(at.ankle_torque, z)
        return {"torque": torque, "slope": jnp.stack([push(axis) for axis in jnp.eye(2)])}

    return Part(
        "ng_policy_ankle",
        "Torque of the stance ankle [N m], positive forward, and its slopes in z.",
        _policy(compute, {"z": (2,)} | _step(policy), policy),
    )


def policy_in_one(
    robot: PlanarBiped, policy: AbstractPolicy, reset_residual: ResetCorrection
) -> Part:
    """Return the Program as one function of z, dz and, for a family, its commands, without memory.

    Raises: SpecError naming the primitive of a policy that cannot be traced.
    """
    if not policy.step_size:
        return policy_rate(policy)

    def compute(z: ZeroState, dz: ZeroState, commands: Float[Array, "2 p"]) -> dict[str, Array]:
        at = policy.at(robot, Pair(*commands), reset_residual, exact=True)
        return rate(at)(z, dz)

    shapes = _OF_POLICY | {"commands": (2, len(policy.commands))}
    part = policy_rate(policy)
    return part._replace(program=_policy(compute, shapes, policy))


def policy_step(
    robot: PlanarBiped, policy: AbstractPolicy, reset_residual: ResetCorrection
) -> Part:
    """Return the Program for the numbers that a family computes once a step.

    Raises: SpecError naming the primitive of a policy that cannot be traced.
    """

    def compute(before: Float[Array, " p"], after: Float[Array, " p"]) -> dict[str, Array]:
        return {"step": policy.parameters_of_step(robot, Pair(before, after), reset_residual)}

    shape = (len(policy.commands),)
    return Part(
        "ng_policy_step",
        "Once a step: the numbers that the policy has for it, from the commands of the step "
        "before and of this one.",
        _policy(compute, {"before": shape, "after": shape}, policy),
    )


def parts(
    robot: PlanarBiped,
    policy: AbstractPolicy,
    reset_residual: ResetCorrection = None,
    torque_model: PlanarBiped | None = None,
) -> list[Part]:
    """Return every Program of a controller.

    Args:
        robot: the model of the gait.
        policy: desired outputs, or a family of them.
        reset_residual: corrects the impact that the steps of a family begin with.
        torque_model: robot that torques are for; the gait's if None.

    Raises: SpecError naming the primitive of a policy that cannot be traced.
    """
    n, model = robot.n, torque_model or robot
    believed = _belief(policy)

    def state(
        q: Coordinates, dq: Coordinates, hip_velocity_: Planar, lean: Scalar | None = None
    ) -> dict[str, Array]:
        own = _leaning(robot, lean)
        foot = hip_velocity_ - hip_velocity(own, q, dq)
        z, dz = zero_state(own, q, dq, foot)
        speed = centre_of_mass_velocity(own, q, dq)[0]
        return {"z": z, "dz": dz, "ddz2": own.mass * own.gravity * speed}

    def dynamics(q: Coordinates, dq: Coordinates, lean: Scalar | None = None) -> dict[str, Array]:
        own = _leaning(model, lean)
        return {"mass": own.mass_matrix(q), "bias": own.bias(q, dq)}

    def feet(q: Coordinates) -> dict[str, Array]:
        return {"foot": swing_foot(robot, q), "hip": hip_position(robot, q)}

    of_state = {"q": (n,), "dq": (n,)}
    once = [policy_step(robot, policy, reset_residual)] if policy.step_size else []
    once += [policy_ankle(policy)] if robot.feet is not None else []
    return [
        policy_rate(policy),
        Part(
            "ng_policy_path",
            "Policy along z(t): y [rad], dy [rad/s], slope dy/dz1 [rad/m], drift ddy [rad/s^2].",
            _policy(path(policy), _OF_POLICY | {"ddz": (2,)} | _step(policy), policy),
        ),
        *once,
        Part(
            "ng_zero_state",
            "Measured z (m, kg m^2/s), dz (m/s, N m), and the second derivative of z2 [N m/s].",
            trace(state, of_state | {"hip_velocity_": (2,)} | believed, parameters=robot),
        ),
        Part(
            "ng_dynamics",
            "Mass matrix [kg m^2] and bias [N m] of mass ddq + bias = (0, torques).",
            trace(dynamics, of_state | believed, parameters=model),
        ),
        Part(
            "ng_feet",
            "Swing foot and hip from the stance foot, (x, z) [m].",
            trace(feet, {"q": (n,)}, parameters=robot),
        ),
        pinned_rates(robot, policy),
        *([lean_of_interval(robot)] if believed else []),
    ]


def _belief(policy: AbstractPolicy) -> dict[str, tuple[int, ...]]:
    """Return the input that functions of a robot have whose gait is told its lean [m]."""
    return {} if place_of(policy.commands, LEAN) is None else {LEAN: ()}


def _leaning(robot: PlanarBiped, lean: Scalar | None) -> PlanarBiped:
    return robot if lean is None else leaning_robot(robot, lean)


def lean_of_interval(robot: PlanarBiped) -> Part:
    """Return the Program of what an interval adds to `lean_sums`, by powers of time."""

    def quantities(q: Coordinates, change: Coordinates) -> dict[str, Array]:
        momentum, ahead = with_derivative(robot, q, change)
        return {"momentum": jnp.stack(momentum), "ahead": jnp.stack(ahead)}

    return Part(
        "ng_lean",
        "Momentum times time [kg m^2] and centre of mass ahead of the foot [m], each with its "
        "derivative by the lean, at q and for a change of q [rad].",
        trace(quantities, {"q": (robot.n,), "change": (robot.n,)}, parameters=robot),
    )


def pinned_rates(robot: PlanarBiped, policy: AbstractPolicy) -> Part:
    """Return the Program of all rates on a foot that stands still."""

    def standing(
        q: Coordinates,
        actuated: Actuated,
        z2: Scalar,
        extra: Scalar,
        lean: Scalar | None = None,
    ) -> dict[str, Array]:
        dq, hip = pinned(_leaning(robot, lean), q, actuated, z2, extra)
        return {"dq": dq, "hip": hip}

    n = robot.n
    return Part(
        "ng_pinned",
        "All rates dq [rad/s] and the hip's velocity (x, z) [m/s] on a foot that stands still, "
        "of those of the actuated joints and the momentum z2 [kg m^2/s]; `extra` is added to "
        "the first [rad/s].",
        trace(
            standing,
            {"q": (n,), "actuated": (n - 1,), "z2": (), "extra": ()} | _belief(policy),
            parameters=robot,
        ),
    )


def ground(robot: PlanarBiped, policy: AbstractPolicy) -> Part:
    """Return the Program of the floor's force on the stance foot, see `control.clf_qp`."""

    def force(q: Coordinates, dq: Coordinates, lean: Scalar | None = None) -> dict[str, Array]:
        still, by_acceleration = ground_force(_leaning(robot, lean), q, dq)
        return {"still": still, "by_acceleration": by_acceleration}

    n = robot.n
    return Part(
        "ng_ground",
        "Force of the floor on the stance foot, (x, z): without accelerations, and by each "
        "[shares of the weight, of it a rad/s^2].",
        trace(force, {"q": (n,), "dq": (n,)} | _belief(policy), parameters=robot),
    )


def _policy(
    compute: Callable[..., Mapping[str, Any]], shapes: Mapping[str, tuple], policy: AbstractPolicy
) -> Program:
    try:
        return trace(compute, shapes, parameters=policy)
    except SpecError as error:
        found = re.search(r"cannot trace [^:]*", str(error))
        raise SpecError(
            "expected a smooth policy, which is what C and ONNX are written from, found one that "
            f"{found.group() if found else error}: train with tanh or softplus"
        ) from None
