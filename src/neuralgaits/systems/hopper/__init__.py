"""The hopper: one leg that slides out of a hub with a wheel, in the plane.

It has stances, flights and touchdowns, so a proof is about its hybrid zero dynamics.
"""

from neuralgaits.certificate.proof_file.check import ASSUMPTIONS
from neuralgaits.systems.hopper.hop_levels import with_hop_levels
from neuralgaits.systems.system_family import SystemFamily, imported_when_called

FAMILY = SystemFamily(
    name="hopper",
    words="a hopper",
    built_in={"hopper": "a planar hopper: a leg that slides out of a hub with a wheel"},
    recognises=imported_when_called("neuralgaits.systems.hopper.hopper_file:is_hopper"),
    assumptions=(
        ASSUMPTIONS[0],
        "the model is the rigid hopper with the stored float64 numbers, in exact real arithmetic, "
        "on its zero dynamics: in stance the foot is pinned, the leg has the policy's length and "
        "the wheel stands still; sampling, delays, measurement errors and float32 are outside",
        "every flight ends in the posture of touchdown with the leg locked and the wheel at rest, "
        "and the foot is off the floor until then: the way of leg and wheel there is not proved",
        "touchdown is plastic, and neither motor gives a blow",
        ASSUMPTIONS[-1],
    ),
    with_levels=with_hop_levels,
)
