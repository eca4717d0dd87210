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


def rugged(robot: "PlanarBiped") -> GaitSpec:
    """Return the default specification of a gait for unknown pushes, slopes and floors.

    Args:
        robot: robot with knees.
    """
    # Requested mean speed of the reference robot [m/s]. At a higher speed, pushes do less harm and
    # floors more.
    speed = 1.06
    plain = at_speed(robot, speed * units(robot).speed)
    recipe = plain.recipe
    samples = dict(recipe.samples) | {"guard": 3 * recipe.samples["guard"]}
    # Phases before and behind the guard that its conditions are trained on, and the whole tube's
    # beyond both its ends.
    strip = 0.1
    return replace(
        plain,
        name=NAME,
        conditions=tuple(_harder(robot, one) for one in plain.conditions),
        recipe=replace(
            recipe,
            steps=3000,
            effort=1.0,  # Weight of the mean squared torque, five times the plain walk's.
            strip=strip,
            overshoot=(strip, recipe.overshoot[1]),
            samples=samples,
            largest_gradient=5.0,
        ),
        # Where the floor is uneven, torques run out.
        weights=dict(plain.weights)
        | dict.fromkeys(("torque-lower", "torque-upper"), 4.0)
        | dict.fromkeys((*FLOWS, *RESETS), 4.0),
    )


def _harder(robot: "PlanarBiped", condition: AbstractCondition) -> AbstractCondition:
    """Return a condition of the plain walk with this spec's numbers."""
    unit = units(robot)
    if condition.name == "foot-clears":
        # Height of the arc that the swing foot stays above, of the reference robot [m]: a foothold
        # 25 mm higher is under it.
        clearance = 0.032
        return replace(condition, function=f.foot_above_arc(clearance * unit.length))
    if condition.name == "guard-transversal":
        fall = 0.5  # Least speed of the foot at the guard, of the reference robot [m/s].
        return replace(condition, function=f.at_most(f.foot_vertical_velocity, -fall * unit.speed))
    if condition.name == "tube-width":
        width = 0.36  # Least width of the tube, in shares of its z2.
        return TubeWidth(condition.name, condition.region, width, width)
    return condition
