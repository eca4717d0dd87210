"""The cart-pole: a pole on a cart that one motor drives along a rail.

It has no impacts, so a proof is about one flow and one set.
"""

from neuralgaits.certificate.proof_file.check import ASSUMPTIONS
from neuralgaits.systems.equilibrium.ellipsoid_levels import EllipsoidLevels
from neuralgaits.systems.equilibrium.ellipsoid_regions import ellipsoid_table
from neuralgaits.systems.system_family import SystemFamily, imported_when_called

LEVELS = EllipsoidLevels(
    words="a cart-pole",
    table=ellipsoid_table("force", "rail", "upright"),
    limits="the motor's force is within its limits, the cart on its rail, the pole upright",
    rest="the pole comes to rest upright, at the middle of the rail",
)


FAMILY = SystemFamily(
    name="cartpole",
    words=LEVELS.words,
    built_in={
        "cartpole": "a cart-pole: the one of DeepMind's Control Suite, 10 N on a rail of 3.6 m"
    },
    recognises=imported_when_called("neuralgaits.systems.cartpole.mjcf:is_cartpole"),
    assumptions=(
        ASSUMPTIONS[0],
        "the model is the rigid cart-pole with the stored float64 numbers, in exact real "
        "arithmetic; the force is computed from the true state in continuous time: sampling, "
        "delays, measurement errors and float32 are outside",
        "the flow is odd, so that what holds at a state holds at its opposite: a policy without "
        "biases and a decay made of squares",
        ASSUMPTIONS[-1],
    ),
    with_levels=LEVELS.with_levels,
)
