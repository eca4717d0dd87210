"""The spec of a given gait: the limits of the robot itself, and a tube around the gait.

Nothing here is a margin of comfort. A gait from trajectory optimisation is as near to its limits
as it was allowed to be, so each bound is the robot file's or that of the contact itself; the tube
uses up no more of them than `fit_tube` of the room `hzd` planned for.
"""

from functools import partial
from typing import TYPE_CHECKING

import numpy as np
from jaxtyping import PRNGKeyArray

from neuralgaits.barriers import functions as f
from neuralgaits.barriers.conditions import Barrier, Equality, Fence, Inlet, Pointwise
from neuralgaits.barriers.spec import GaitSpec, Init, Recipe
from neuralgaits.barriers.walking import pendulum_height, regions_of_step, units
from neuralgaits.gait import BezierPolicy, walking_posture
from neuralgaits.gait.gaits import Gait
from neuralgaits.gait.posture import REFERENCE_MASS_KG
from neuralgaits.gait.stepping_robot import SteppingRobot
from neuralgaits.gait.tubes import Tube
from neuralgaits.robots.robot_source import planar_biped

if TYPE_CHECKING:
    from neuralgaits.robots import PlanarBiped

NAME = "hzd"
FENCE_DEGREE = 16
"""Degree of the fences' Chebyshev series: an orbit is met to 1e-6 of its zeta or better."""
LIFT_OFF, LANDING = 0.05, 0.95
"""Phases between which the foot must be above the ground: at the ends it is on it."""


def hzd(robot: "PlanarBiped", degree: int) -> GaitSpec:
    """Return the specification of a given gait of Bezier outputs.

    Args:
        robot: whose limits the conditions use.
        degree: degree of the polynomials.
    """
    regions = regions_of_step(LIFT_OFF, LANDING)
    recipe = Recipe(
        steps=1400,
        samples={name: 48 if name == "tube" else 16 for name in regions},
        learning_rate=1e-3,
        weight_decay=0.0,
        warmup=0.1,
        aim=0.02,
        worst_weight=0.1,
        logarithmic=True,
    )
    conditions = (*_stance(robot), *_swing_foot(robot), *_tube(), *_guard(robot))
    return GaitSpec(NAME, conditions, regions, partial(_new_gait, robot, degree), recipe)


def _new_gait(
    robot: "PlanarBiped",
    degree: int,
    key: PRNGKeyArray,
    init: Init,
    hidden: tuple[int, ...] | None,
) -> Gait:
    """Return a gait of the right shape, without values: a given gait has its own."""
    del key, init, hidden
    guard = walking_posture(robot).z_guard
    policy = BezierPolicy(np.zeros((robot.n - 1, degree + 1)), (-guard, guard))
    return Gait(policy, empty_tube(robot, (-guard, guard)))


def empty_tube(robot: SteppingRobot, span: tuple[float, float]) -> Tube:
    """Return a tube without fences.

    Args:
        robot: planar biped, which sets the unit of zeta.
        span: z1 after the impact and at the guard [m].
    """
    unit = 0.5 * float(robot.mass * pendulum_height(planar_biped(robot))) ** 2
    none = np.zeros(FENCE_DEGREE + 1)
    return Tube(none, none.copy(), np.asarray(unit), np.asarray(span, np.float64), trained=True)


def _stance(robot: "PlanarBiped") -> list[Barrier | Pointwise]:
    """Conditions on the whole tube: contact, torques, joint ranges and progress."""
    unit = units(robot)
    weight = unit.weight_n
    speed = unit.speed
    cone = float(robot.friction)
    conditions: list[Barrier | Pointwise] = []
    if robot.torso is not None:
        # Class-K gain of that barrier, in units of the reference robot's time [1/s].
        alpha, scale = 10.0 / unit.time, 3.3 / unit.time
        # Largest lean of the torso to either side [rad]: 20 degrees, more than in any published
        # gait of such robots.
        lean = 0.35
        conditions += [
            Barrier("torso-lower", "tube", scale, f.at_least(f.torso_angle, -lean), alpha),
            Barrier("torso-upper", "tube", scale, f.at_most(f.torso_angle, lean), alpha),
        ]
    inertia = 20.0 * unit.mass_kg * unit.length / REFERENCE_MASS_KG
    lower, upper = np.asarray(robot.joint_lower), np.asarray(robot.joint_upper)
    return [
        *conditions,
        Pointwise("normal-force", "tube", weight, f.at_least(f.normal_force, 0.0)),
        Pointwise("friction-forward", "tube", cone * weight, f.friction_forward(cone)),
        Pointwise("friction-backward", "tube", cone * weight, f.friction_backward(cone)),
        Pointwise("torque-lower", "tube", 1.0, f.torque_reserve("lower", 1.0)),
        Pointwise("torque-upper", "tube", 1.0, f.torque_reserve("upper", 1.0)),
        Pointwise("range-lower", "tube", 0.5, f.at_least(f.joint_angles, lower)),
        Pointwise("range-upper", "tube", 0.5, f.at_most(f.joint_angles, upper)),
        Pointwise("forward", "tube", speed, f.at_least(f.forward_rate, 0.0)),
        Pointwise("transversal-inertia", "tube", inertia, f.at_least(f.transversal_inertia, 0.0)),
    ]


def _swing_foot(robot: "PlanarBiped") -> list[Pointwise]:
    """Conditions of the swing foot: rise, stay above the ground, fall."""
    unit = units(robot)
    speed, height = 0.5 * unit.speed, 0.05 * unit.length
    velocity = f.foot_vertical_velocity
    return [
        Pointwise("foot-rises", "lift-off", speed, f.at_least(velocity, 0.0)),
        Pointwise("foot-clears", "swing", height, f.at_least(f.foot_height, 0.0)),
        Pointwise("foot-falls", "landing", speed, f.at_most(velocity, 0.0)),
    ]


def _tube() -> list[Fence | Inlet]:
    """Conditions of the tube: the flow stays between the fences, and so does the reset."""
    return [
        Fence("flow-above-lower-fence", "fence-lower", 1.0, "lower"),
        Fence("flow-below-upper-fence", "fence-upper", 1.0, "upper"),
        Inlet("reset-above-lower-fence", "guard", 1.0, "lower"),
        Inlet("reset-below-upper-fence", "guard", 1.0, "upper"),
    ]


def _guard(robot: "PlanarBiped") -> list[Pointwise | Equality]:
    """Conditions at the guard: a feasible impact, the old foot leaves, outputs near zero."""
    unit = units(robot)
    push, cone = 5.0 * unit.mass_kg * unit.speed / REFERENCE_MASS_KG, float(robot.friction)
    step, speed = 0.3 * unit.length, 0.5 * unit.speed
    # Errors of outputs [rad] and of their rates [rad/s of the reference robot's time] that the real
    # impact may leave: levels 1 to 3 set them to zero again. Those of spec `walking-mlp`.
    output_error = 1e-3
    rate = 2e-2 / unit.time
    return [
        Pointwise("step-length", "guard", step, f.at_least(f.foot_forward, 0.0)),
        Pointwise("impulse", "guard", push, f.at_least(f.normal_impulse, 0.0)),
        Pointwise("impulse-forward", "guard", cone * push, f.impulse_cone_forward(cone)),
        Pointwise("impulse-backward", "guard", cone * push, f.impulse_cone_backward(cone)),
        Pointwise("old-foot-leaves", "guard", 0.4 * speed, f.at_least(f.old_foot_lift, 0.0)),
        Pointwise("foot-lands", "guard", speed, f.at_most(f.foot_vertical_velocity, 0.0)),
        Equality("output-match", "guard", 0.02, f.output_mismatch, output_error),
        Equality("rate-match", "guard", 20.0 * rate, f.rate_mismatch, rate),
    ]
