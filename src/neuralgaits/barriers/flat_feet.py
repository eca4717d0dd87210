"""The default spec for a robot with flat feet on ankles with motors.

Conditions of the plain walk, read at the ankle, and those of the sole: the centre of pressure stays
inside it, heel and toe clear the ground, and it lands flat.
"""

from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING

from neuralgaits.barriers import functions as f
from neuralgaits.barriers.conditions import AbstractCondition, Pointwise
from neuralgaits.barriers.spec import GaitSpec
from neuralgaits.barriers.walking import (
    CLEARANCE,
    TORQUE_SHARE,
    new_hybrid_invariant,
    units,
    walking,
)
from neuralgaits.errors import SpecError
from neuralgaits.gait.posture import REFERENCE_MASS_KG
from neuralgaits.robots.robot_file import flat_feet_of

if TYPE_CHECKING:
    from neuralgaits.robots import PlanarBiped

NAME = "walking-flat-feet"
STEPS = 3000
"""Gradient steps."""


def flat_footed(robot: "PlanarBiped") -> GaitSpec:
    """Return the default specification of a gait on flat feet.

    Args:
        robot: robot with flat feet, a torso and knees.

    Raises: SpecError for a robot on point feet.
    """
    if robot.feet is None:
        raise SpecError(
            f"spec {NAME}: expected a robot with flat feet, found point feet at {robot.name}: use "
            "the spec walking"
        )
    plain = walking(robot)
    return replace(
        plain,
        name=NAME,
        conditions=(*plain.conditions, *_sole(robot)),
        recipe=replace(plain.recipe, steps=STEPS),
        new_gait=partial(new_hybrid_invariant, robot),
    )


def _sole(robot: "PlanarBiped") -> list[AbstractCondition]:
    """Conditions of both soles, and of the range of the stance ankle."""
    unit, feet = units(robot), flat_feet_of(robot)
    reach = 0.5 * float(feet.heel + feet.toe)
    moment = 0.5 * reach * unit.weight_n
    push = 5.0 * unit.mass_kg * unit.speed / REFERENCE_MASS_KG
    # Height of the arc that heel and toe stay above, of the reference robot [m]: at half a
    # CLEARANCE a gait on floors of 2 cm trips in every walk, at 1.25 in none of 20.
    clearance = 1.25 * CLEARANCE
    speed, arc = 0.5 * unit.speed, clearance * unit.length
    lower, upper = float(robot.joint_lower[-1]), float(robot.joint_upper[-1])
    velocity = f.sole_vertical_velocity
    within = 0.9  # Middle part of the sole, in shares of it, that the centre of pressure stays in.
    return [
        Pointwise("pressure-heel", "tube", moment, f.pressure_reserve("heel", within)),
        Pointwise("pressure-toe", "tube", moment, f.pressure_reserve("toe", within)),
        Pointwise("ankle-torque-lower", "tube", 1.0, f.ankle_reserve("lower", TORQUE_SHARE)),
        Pointwise("ankle-torque-upper", "tube", 1.0, f.ankle_reserve("upper", TORQUE_SHARE)),
        Pointwise("ankle-lower", "tube", 0.5, f.at_least(f.stance_ankle, lower)),
        Pointwise("ankle-upper", "tube", 0.5, f.at_most(f.stance_ankle, upper)),
        Pointwise("sole-rises", "lift-off", speed, f.at_least(velocity, 0.0)),
        Pointwise("sole-clears", "swing", 0.05 * unit.length, f.sole_above_arc(arc)),
        Pointwise("sole-falls", "landing", speed, f.at_most(velocity, 0.0)),
        Pointwise("impulse-heel", "guard", push * reach, f.impulse_reserve("heel", within)),
        Pointwise("impulse-toe", "guard", push * reach, f.impulse_reserve("toe", within)),
        Pointwise("old-sole-leaves", "guard", 0.2 * unit.speed, f.at_least(f.old_sole_lift, 0.0)),
    ]
