"""The cart-pole: a pole on a cart that one motor drives along a rail.

It has no impacts, so a proof is about one flow and one set.
"""

from pathlib import Path

from neuralgaits.systems.cartpole.conclusions import ASSUMPTIONS, with_cartpole_levels
from neuralgaits.systems.system_family import SystemFamily


def _recognises(source: str | Path) -> bool:
    from neuralgaits.systems.cartpole.mjcf import is_cartpole  # Brings MuJoCo.

    return is_cartpole(source)


FAMILY = SystemFamily(
    name="cartpole",
    words="a cart-pole",
    built_in={
        "cartpole": "a cart-pole: the one of DeepMind's Control Suite, 10 N on a rail of 3.6 m"
    },
    recognises=_recognises,
    assumptions=ASSUMPTIONS,
    with_levels=with_cartpole_levels,
)
