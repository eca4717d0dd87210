"""Bipeds in three dimensions on point feet, the yaw of their torso held.

Hip roll, hip pitch and knee on each leg; two degrees of freedom have no motor, so the state of the
zero dynamics has four numbers. Needs no JAX.
"""

from neuralgaits.certificate.proof_file.check import ASSUMPTIONS
from neuralgaits.systems.system_family import SystemFamily, imported_when_called
from neuralgaits.systems.walker3d.spatial_levels import with_spatial_levels

FAMILY = SystemFamily(
    name="walker3d",
    words="a walker in three dimensions",
    built_in={
        "walker3d": "a biped in three dimensions: hip roll, hip pitch, knees and point feet, 26 kg"
    },
    recognises=imported_when_called("neuralgaits.systems.walker3d.spatial_source:is_spatial"),
    assumptions=(
        ASSUMPTIONS[0],
        "the model is the rigid walker with the stored float64 numbers, in exact real arithmetic, "
        "on its zero dynamics: the stance foot is pinned, the torso does not roll, all outputs "
        "are as the policy says; sampling, delays, measurement errors and float32 are outside",
        "the yaw of the torso is held, by a moment about the vertical that is bounded",
        "touchdown is plastic and happens at phase 1 alone; after it outputs and their rates are "
        "at once as the policy says, the swing foot's place among them, with the hip's place and "
        "the horizontal angular momentum about the new foot as the touchdown leaves them",
        "the robot is its own mirror image, and is reflected after each step",
        ASSUMPTIONS[-1],
    ),
    with_levels=with_spatial_levels,
)
