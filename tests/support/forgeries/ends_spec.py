"""Two conditions; the region of one has two boxes."""

from dataclasses import replace

from neuralgaits.barriers import Box, Pointwise, specs
from neuralgaits.barriers import functions as f

REGIONS = {
    "tube": (Box((0.0, 0.0), (1.0, 1.0)),),
    "ends": (Box((0.0, 0.0), (0.25, 1.0)), Box((0.75, 0.0), (1.0, 1.0))),
}


def ends(robot):
    spec = specs.walking(robot)
    conditions = (
        Pointwise("tall", "tube", 0.5, f.at_least(f.hip_height, 0.5)),
        Pointwise("brisk", "ends", 1.0, f.at_least(f.forward_rate, 0.1)),
    )
    recipe = replace(spec.recipe, samples=dict.fromkeys(REGIONS, 4))
    return replace(
        spec, name="ends", conditions=conditions, regions=REGIONS, recipe=recipe, weights={}
    )
