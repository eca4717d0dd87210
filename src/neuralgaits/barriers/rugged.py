"""The default spec for a gait that tolerates more: a faster walk that lifts its feet.

A push backwards stops a hip that is then too slow to get over its foot: speed helps. A higher
foothold is met early and a lower one late, by a foot that was made to clear the first and that
goes on falling to the second. The robot receives no information about floors or pushes.
"""

from dataclasses import replace
from typing import TYPE_CHECKING

from neuralgaits.barriers import functions as f
from neuralgaits.barriers.commanded_spec import at_speed
from neuralgaits.barriers.conditions import AbstractCondition, TubeWidth
from neuralgaits.barriers.spec import GaitSpec
from neuralgaits.barriers.walking import FLOWS, RESETS, units

if TYPE_CHECKING:
    from neuralgaits.robots import PlanarBiped

NAME = "rugged"
SPEED = 1.06
"""Requested mean speed of the reference robot [m/s]. At a higher speed, pushes do less harm and
floors more."""
EFFORT, TORQUES, AT_FENCES = 1.0, 4.0, 4.0
"""Weight of the mean squared torque, five times the plain walk's, and factors of the losses of
torque limits and of fences and resets: where the floor is uneven, torques run out."""
CLEARANCE = 0.032
"""Height of the arc that the swing foot stays above, of the reference robot [m]: a foothold 25 mm
higher is under it."""
FALL = 0.5
"""Least speed of the foot at the guard, of the reference robot [m/s]."""
STRIP = 0.1
"""Phases before and behind the guard that its conditions are trained on, and the whole tube's
beyond both its ends."""
WIDTH = 0.36
"""Least width of the tube, in shares of its z2."""
STEPS, MORE_GUARD, LARGEST_GRADIENT = 3000, 3, 5.0
"""Gradient steps, factor of the samples of the guard, and norm that gradients are clipped to."""


def rugged(robot: "PlanarBiped") -> GaitSpec:
    """Return the default specification of a gait for unknown pushes, slopes and floors.

    Args:
        robot: with knees.
    """
    plain = at_speed(robot, SPEED * units(robot).speed)
    recipe = plain.recipe
    samples = dict(recipe.samples) | {"guard": MORE_GUARD * recipe.samples["guard"]}
    return replace(
        plain,
        name=NAME,
        conditions=tuple(_harder(robot, one) for one in plain.conditions),
        recipe=replace(
            recipe,
            steps=STEPS,
            effort=EFFORT,
            strip=STRIP,
            overshoot=(STRIP, recipe.overshoot[1]),
            samples=samples,
            largest_gradient=LARGEST_GRADIENT,
        ),
        weights=dict(plain.weights)
        | dict.fromkeys(("torque-lower", "torque-upper"), TORQUES)
        | dict.fromkeys((*FLOWS, *RESETS), AT_FENCES),
    )


def _harder(robot: "PlanarBiped", condition: AbstractCondition) -> AbstractCondition:
    """Return a condition of the plain walk with this spec's numbers."""
    unit = units(robot)
    if condition.name == "foot-clears":
        return replace(condition, function=f.foot_above_arc(CLEARANCE * unit.length))
    if condition.name == "guard-transversal":
        return replace(condition, function=f.at_most(f.foot_vertical_velocity, -FALL * unit.speed))
    if condition.name == "tube-width":
        return TubeWidth(condition.name, condition.region, WIDTH, WIDTH)
    return condition
