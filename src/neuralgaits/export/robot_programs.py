"""Programs of a robot, which a controller of any policy needs: state, dynamics, feet, rates, lean.

Where the gait is told the lean of the torso, these are of the robot that leans as it is believed
to.
"""

from typing import NamedTuple

import jax.numpy as jnp

from neuralgaits._types import Actuated, Array, Coordinates, Planar, Scalar
from neuralgaits.control import Controller
from neuralgaits.control.clf_qp import ground_force
from neuralgaits.control.estimator import contact_momentum, standing_rates
from neuralgaits.control.lean_sums import with_derivative
from neuralgaits.control.measurement import stance_foot_velocity
from neuralgaits.control.momentum import zero_state
from neuralgaits.gait import AbstractPolicy
from neuralgaits.gait.commands import LEAN, place_of
from neuralgaits.programs import Program
from neuralgaits.programs.tracing.tracer import trace
from neuralgaits.robots.mjcf.leaning import leaning_robot


class Part(NamedTuple):
    """A Program that becomes one C function."""

    function: str
    """Name of the C function."""
    about: str
    """Description of its results, with units."""
    program: Program


def tells_lean(policy: AbstractPolicy) -> bool:
    """Return whether a gait's policy is told the lean of the torso."""
    return place_of(policy.commands, LEAN) is not None


def zero_dynamics_state(controller: Controller) -> Part:
    """Return the Program of the measured z and its rates."""
    robot = controller.robot

    def state(
        q: Coordinates, dq: Coordinates, hip_velocity_: Planar, lean: Scalar | None = None
    ) -> dict[str, Array]:
        own = leaning_robot(robot, lean)
        z, dz = zero_state(own, q, dq, stance_foot_velocity(own, q, dq, hip_velocity_))
        return {"z": z, "dz": dz, "ddz2": own.momentum_rate_rate(q, dq)[0]}

    n = robot.n
    return Part(
        "ng_zero_state",
        "Measured z (m, kg m^2/s), dz (m/s, N m), and the second derivative of z2 [N m/s].",
        trace(
            state,
            {"q": (n,), "dq": (n,), "hip_velocity_": (2,)} | _belief(controller),
            parameters=robot,
        ),
    )


def dynamics(controller: Controller) -> Part:
    """Return the Program of mass matrix and bias of the robot that torques are for."""
    robot, joints = controller.robot, controller.joints
    if joints is not None:
        robot = robot.with_joints(joints.armature, joints.damping)

    def matrices(q: Coordinates, dq: Coordinates, lean: Scalar | None = None) -> dict[str, Array]:
        own = leaning_robot(robot, lean)
        return {"mass": own.mass_matrix(q), "bias": own.bias(q, dq)}

    n = robot.n
    return Part(
        "ng_dynamics",
        "Mass matrix [kg m^2] and bias [N m] of mass ddq + bias = (0, torques).",
        trace(matrices, {"q": (n,), "dq": (n,)} | _belief(controller), parameters=robot),
    )


def feet(controller: Controller) -> Part:
    """Return the Program of the places of swing foot and hip."""
    robot = controller.robot

    def places(q: Coordinates) -> dict[str, Array]:
        return {"foot": robot.swing_foot(q), "hip": robot.hip_position(q)}

    return Part(
        "ng_feet",
        "Swing foot and hip from the stance foot, (x, z) [m].",
        trace(places, {"q": (robot.n,)}, parameters=robot),
    )


def lean_of_interval(controller: Controller) -> Part:
    """Return the Program of what an interval adds to `lean_sums`, by powers of time."""
    robot = controller.robot

    def quantities(q: Coordinates, change: Coordinates) -> dict[str, Array]:
        momentum, ahead = with_derivative(robot, q, change)
        return {"momentum": jnp.stack(momentum), "ahead": jnp.stack(ahead)}

    return Part(
        "ng_lean",
        "Momentum times time [kg m^2] and centre of mass ahead of the foot [m], each with its "
        "derivative by the lean, at q and for a change of q [rad].",
        trace(quantities, {"q": (robot.n,), "change": (robot.n,)}, parameters=robot),
    )


def momentum_about_contact(controller: Controller) -> Part:
    """Return the Program of the momentum that the estimator follows, and of its rate."""
    robot = controller.robot

    def momentum(
        q: Coordinates, dq: Coordinates, hip_velocity_: Planar, lean: Scalar | None = None
    ) -> dict[str, Array]:
        value, rate = contact_momentum(leaning_robot(robot, lean), q, dq, hip_velocity_)
        return {"momentum": value, "moment": rate}

    n = robot.n
    return Part(
        "ng_contact_momentum",
        "Angular momentum about the place where the stance foot touches [kg m^2/s], and the moment "
        "of the weight about it [N m].",
        trace(
            momentum,
            {"q": (n,), "dq": (n,), "hip_velocity_": (2,)} | _belief(controller),
            parameters=robot,
        ),
    )


def standing_rates_of(controller: Controller) -> Part:
    """Return the Program of all rates on a foot that does not slip."""
    robot = controller.robot

    def standing(
        q: Coordinates,
        actuated: Actuated,
        momentum: Scalar,
        extra: Scalar,
        lean: Scalar | None = None,
    ) -> dict[str, Array]:
        dq, hip = standing_rates(leaning_robot(robot, lean), q, actuated, momentum, extra)
        return {"dq": dq, "hip": hip}

    n = robot.n
    return Part(
        "ng_standing_rates",
        "All rates dq [rad/s] and the hip's velocity (x, z) [m/s] on a foot that does not slip, "
        "of those of the actuated joints and the momentum about its contact [kg m^2/s]; `extra` "
        "is added to the first [rad/s].",
        trace(
            standing,
            {"q": (n,), "actuated": (n - 1,), "momentum": (), "extra": ()} | _belief(controller),
            parameters=robot,
        ),
    )


def ground(controller: Controller) -> Part:
    """Return the Program of the floor's force on the stance foot, see `control.clf_qp`."""
    robot = controller.robot

    def force(q: Coordinates, dq: Coordinates, lean: Scalar | None = None) -> dict[str, Array]:
        still, by_acceleration = ground_force(leaning_robot(robot, lean), q, dq)
        return {"still": still, "by_acceleration": by_acceleration}

    n = robot.n
    return Part(
        "ng_ground",
        "Force of the floor on the stance foot, (x, z): without accelerations, and by each "
        "[shares of the weight, of it a rad/s^2].",
        trace(force, {"q": (n,), "dq": (n,)} | _belief(controller), parameters=robot),
    )


def _belief(controller: Controller) -> dict[str, tuple[int, ...]]:
    """Return the input that functions of a robot have whose gait is told its lean [m]."""
    return {LEAN: ()} if tells_lean(controller.policy) else {}
