"""Bounds on the shares in which links of a box differ from the file's. Needs no JAX."""

from typing import Any


def largest_shares(mass: Any, com: Any, inertia: Any) -> tuple[Any, Any, Any, Any, Any]:
    """Bound the shares of a type of link, in the order of `LinkShares`.

    Doubles and balls alike; only balls are rounded up.

    Args:
        mass: error of the mass, over the file's.
        com: error of the centre of mass along the link and across it [m].
        inertia: error of the inertia, over the file's.
    """
    heavier = 1 + mass
    return mass, heavier * com, heavier * com, 2 * heavier * com**2, inertia
