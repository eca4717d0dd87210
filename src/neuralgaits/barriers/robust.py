"""The default spec for every robot of a box around a file's: the walk of `walking` on all of them.

The policy is one of z1 alone, and what it is made of is the file's robot: neither needs to know
which robot of the box it is on. Conditions are those of the plain gait, numbers included; but no
friction cone is wider than the floor's.
"""

from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING

from neuralgaits.barriers.conditions import AbstractCondition, Pointwise
from neuralgaits.barriers.quantities import (
    FrictionBackward,
    FrictionForward,
    ImpulseConeBackward,
    ImpulseConeForward,
)
from neuralgaits.barriers.spec import GaitSpec
from neuralgaits.barriers.walking import new_hybrid_invariant, walking
from neuralgaits.gait.posture import REFERENCE_LEG_M
from neuralgaits.robots.parameters import GROUND, Box, axes_of, checked_box

if TYPE_CHECKING:
    from neuralgaits.robots import PlanarBiped

STEPS = 3000
"""Gradient steps: each sample is of another robot."""
STRIP, MOST_STRIP = 8.0, 0.09
"""Phases around the guard in which the foot goes through a metre of heights, and the most there can
be: AMBER-3M's foot falls at 0.55 m/s, and takes 6."""
CONES = FrictionForward, FrictionBackward, ImpulseConeForward, ImpulseConeBackward
"""Quantities that no foot slips of which are not negative."""


def robust(robot: "PlanarBiped", box: Box) -> GaitSpec:
    """The default specification of a gait for every robot of a box.

    Args:
        robot: in the middle of the box; with knees.
        box: half widths by kind of parameter, see `robots.parameters`.
    """
    plain, box = walking(robot), checked_box(box)
    recipe = replace(plain.recipe, steps=STEPS)
    if "floor" in box:
        strip = min(STRIP * box["floor"] * REFERENCE_LEG_M / robot.leg_length, MOST_STRIP)
        recipe = replace(recipe, strip=strip, overshoot=(strip, plain.recipe.overshoot[1]))
    return replace(
        plain,
        conditions=tuple(_on_friction(one, box.get("friction")) for one in plain.conditions),
        new_gait=partial(new_hybrid_invariant, robot, z2_dependence=False),
        recipe=recipe,
        parameters=axes_of(robot, box),
        ground={kind: box[kind] for kind in GROUND if kind in box},
    )


def _on_friction(condition: AbstractCondition, least: float | None) -> AbstractCondition:
    """The condition, with a friction cone that is no wider than that of the least friction."""
    if least is None or not isinstance(condition, Pointwise):
        return condition
    if not isinstance(condition.function, CONES) or condition.function.coefficient <= least:
        return condition
    return replace(condition, function=replace(condition.function, coefficient=least))
