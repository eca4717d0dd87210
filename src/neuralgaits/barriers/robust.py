"""The default spec for every robot of a box around a file's: the walk of `walking` on all of them.

The policy depends on z1 alone and is computed for the file's robot: it need not know which
robot of the box it is on. Conditions are those of the plain gait, numbers included; but no
friction cone is wider than the floor's.
"""

from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING

from neuralgaits.barriers.commanded_spec import commanded
from neuralgaits.barriers.conditions import AbstractCondition, Pointwise
from neuralgaits.barriers.functions import at_most, foot_vertical_velocity
from neuralgaits.barriers.quantities import FrictionCone
from neuralgaits.barriers.spec import GaitSpec
from neuralgaits.barriers.walking import RESETS, new_hybrid_invariant, units, walking
from neuralgaits.errors import SpecError
from neuralgaits.gait.commands import LEAN, Commands, command_named
from neuralgaits.gait.posture import REFERENCE_LEG_M
from neuralgaits.robots.mjcf.parameters import axes_of
from neuralgaits.robots.parameter_box import GROUND, Box, checked_box

if TYPE_CHECKING:
    from neuralgaits.robots import PlanarBiped


def robust(robot: "PlanarBiped", box: Box, commands: Commands = ()) -> GaitSpec:
    """Return the default specification of a gait for every robot of a box.

    Args:
        robot: robot in the middle of the box; with knees.
        box: half widths by kind of parameter, see `robots.parameter_box`.
        commands: commands that the gait receives at each touchdown, on a floor as modelled.

    Raises: SpecError if there are commands and the floor's height is unknown.
    """
    box = checked_box(box)
    if command_named(commands, LEAN) is not None or LEAN in box:
        return _leaning(robot, box, commands)
    if commands:
        if "floor" in box:
            raise SpecError(
                "expected a gait without commands with a floor of unknown height, found one that "
                f"takes {', '.join(c.name for c in commands)}: leave floor or these out"
            )
        plain = commanded(robot, commands, z2_dependence=False)
        recipe, new_gait = plain.recipe, plain.new_gait
    else:
        plain = walking(robot)
        steps = 3000  # Gradient steps: many, since each sample is of another robot.
        recipe = replace(plain.recipe, steps=steps)
        new_gait = partial(new_hybrid_invariant, robot, z2_dependence=False)
    if "floor" in box:
        # Phases around the guard in which the foot goes through a metre of heights: AMBER-3M's foot
        # falls at 0.5 m/s, and takes 6.5.
        a_metre = 7.5
        strip = min(a_metre * box["floor"] * REFERENCE_LEG_M / robot.leg_length, 0.09)
        samples = dict(recipe.samples) | {"guard": 3 * recipe.samples["guard"]}
        overshoot = strip, recipe.overshoot[1]
        recipe = replace(recipe, strip=strip, overshoot=overshoot, samples=samples)
        # Least speed of a foot that comes to a floor of unknown height, for the reference robot
        # [m/s]: so the strip in which it may meet the floor is short.
        least_speed = 0.45
        fall = at_most(foot_vertical_velocity, -least_speed * units(robot).speed)
        plain = replace(
            plain,
            conditions=tuple(
                replace(one, function=fall) if one.name == "guard-transversal" else one
                for one in plain.conditions
            ),
            weights=dict(plain.weights) | dict.fromkeys(RESETS, 2.0),
        )
    return replace(
        plain,
        conditions=tuple(_on_friction(one, box.get("friction")) for one in plain.conditions),
        new_gait=new_gait,
        recipe=recipe,
        parameters=axes_of(robot, box),
        ground={kind: box[kind] for kind in GROUND if kind in box},
    )


def _leaning(robot: "PlanarBiped", box: Box, commands: Commands) -> GaitSpec:
    """Return the specification of a gait that is told a lean. Raises: SpecError on other boxes."""
    if command_named(commands, LEAN) is None:
        raise SpecError(
            "--parameters lean: expected a gait that takes lean as command, found one that does "
            "not: train with --lean SIZE, or write com=SIZE"
        )
    if set(box) != {LEAN}:
        others = ", ".join(kind for kind in box if kind != LEAN)
        raise SpecError(
            f"--parameters: expected lean alone for a gait that takes lean as command, found "
            f"{others}: leave that out, or --lean"
        )
    return commanded(robot, commands, lean_error=box[LEAN])


def _on_friction(condition: AbstractCondition, least: float | None) -> AbstractCondition:
    """Return the condition with a friction cone no wider than that of the least friction."""
    if least is None or not isinstance(condition, Pointwise):
        return condition
    if not isinstance(condition.function, FrictionCone) or condition.function.coefficient <= least:
        return condition
    return replace(condition, function=replace(condition.function, coefficient=least))
