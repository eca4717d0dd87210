"""The Programs of a controller: everything in a control tick that is smooth, traced once.

What is not smooth (bounds of z, stance, limits, faults) is written by hand in `c/controller.c`.
"""

import re
from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp

from neuralgaits._types import Actuated, Array, Coordinates, Planar, ZeroState
from neuralgaits.control.momentum import zero_state
from neuralgaits.errors import SpecError
from neuralgaits.gait import AbstractPolicy
from neuralgaits.programs import Program
from neuralgaits.programs.tracing.tracer import trace
from neuralgaits.robots import PlanarBiped
from neuralgaits.robots.dynamics import (
    centre_of_mass_velocity,
    hip_position,
    hip_velocity,
    swing_foot,
)

_OF_POLICY = {"z": (2,), "dz": (2,)}


class Part(NamedTuple):
    """A Program that becomes one C function."""

    function: str
    """Its name in C."""
    about: str
    """What it computes, with units."""
    program: Program


def rate(policy: AbstractPolicy) -> Callable[..., dict[str, Array]]:
    """Desired outputs and rates: (z, dz) to y, dy (rad, rad/s)."""

    def compute(z: ZeroState, dz: ZeroState) -> dict[str, Array]:
        y, dy = jax.jvp(policy, (z,), (dz,))
        return {"y": y, "dy": dy}

    return compute


def path(policy: AbstractPolicy) -> Callable[..., dict[str, Array]]:
    """Outputs along a path z(t), with two derivatives, and their slope in z1.

    With ddz1 = 0 in `ddz` the second derivative is the drift of `control.fblin`.
    """

    def first(z: ZeroState, dz: ZeroState) -> tuple[Actuated, Actuated]:
        return jax.jvp(policy, (z,), (dz,))

    def compute(z: ZeroState, dz: ZeroState, ddz: ZeroState) -> dict[str, Array]:
        (y, dy), (_, ddy) = jax.jvp(first, (z, dz), (dz, ddz))
        _, slope = jax.jvp(policy, (z,), (jnp.array([1.0, 0.0]),))
        return {"y": y, "dy": dy, "slope": slope, "drift": ddy}

    return compute


def policy_rate(policy: AbstractPolicy) -> Part:
    """The Program of y_d and its rate.

    Raises: SpecError naming the primitive of a policy that cannot be traced.
    """
    return Part(
        "ng_policy_rate",
        "Policy: desired outputs y [rad] and rates dy [rad/s] at z (m, kg m^2/s), dz.",
        _policy(rate(policy), _OF_POLICY, policy),
    )


def parts(robot: PlanarBiped, policy: AbstractPolicy) -> list[Part]:
    """Every Program of a controller.

    Raises: SpecError naming the primitive of a policy that cannot be traced.
    """
    n = robot.n

    def state(q: Coordinates, dq: Coordinates, hip_velocity_: Planar) -> dict[str, Array]:
        foot = hip_velocity_ - hip_velocity(robot, q, dq)
        z, dz = zero_state(robot, q, dq, foot)
        speed = centre_of_mass_velocity(robot, q, dq)[0]
        return {"z": z, "dz": dz, "ddz2": robot.mass * robot.gravity * speed}

    def dynamics(q: Coordinates, dq: Coordinates) -> dict[str, Array]:
        return {"mass": robot.mass_matrix(q), "bias": robot.bias(q, dq)}

    def feet(q: Coordinates) -> dict[str, Array]:
        return {"foot": swing_foot(robot, q), "hip": hip_position(robot, q)}

    of_state = {"q": (n,), "dq": (n,)}
    return [
        policy_rate(policy),
        Part(
            "ng_policy_path",
            "Policy along z(t): y [rad], dy [rad/s], slope dy/dz1 [rad/m], drift ddy [rad/s^2].",
            _policy(path(policy), _OF_POLICY | {"ddz": (2,)}, policy),
        ),
        Part(
            "ng_zero_state",
            "Measured z (m, kg m^2/s), dz (m/s, N m), and the second derivative of z2 [N m/s].",
            trace(state, of_state | {"hip_velocity_": (2,)}, parameters=robot),
        ),
        Part(
            "ng_dynamics",
            "Mass matrix [kg m^2] and bias [N m] of mass ddq + bias = (0, torques).",
            trace(dynamics, of_state, parameters=robot),
        ),
        Part(
            "ng_feet",
            "Swing foot and hip from the stance foot, (x, z) [m].",
            trace(feet, {"q": (n,)}, parameters=robot),
        ),
    ]


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
