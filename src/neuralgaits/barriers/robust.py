"""The default spec for every robot of a box around a file's: the walk of `walking` on all of them.

The policy is one of z1 alone, and what it is made of is the file's robot: neither needs to know
which robot of the box it is on. Conditions are those of the plain gait, numbers included.
"""

from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING

from neuralgaits.barriers.spec import GaitSpec
from neuralgaits.barriers.walking import new_hybrid_invariant, walking
from neuralgaits.robots.parameters import Box, axes_of

if TYPE_CHECKING:
    from neuralgaits.robots import PlanarBiped

STEPS = 3000
"""Gradient steps: each sample is of another robot."""


def robust(robot: "PlanarBiped", box: Box) -> GaitSpec:
    """The default specification of a gait for every robot of a box.

    Args:
        robot: in the middle of the box; with knees.
        box: half widths by kind of parameter, see `robots.parameters`.
    """
    plain = walking(robot)
    return replace(
        plain,
        new_gait=partial(new_hybrid_invariant, robot, z2_dependence=False),
        recipe=replace(plain.recipe, steps=STEPS),
        parameters=axes_of(robot, box),
    )
