"""Find the friction coefficient from which on no foot slips, from a spec's conditions.

A condition g = mu F_z -+ F_x >= 0 that holds for one mu holds for every larger one, since F_z is
not negative where both sides of it hold. So a proof with the least coefficient is one for all above
it. Needs no JAX.
"""

import math
from collections.abc import Iterable, Mapping
from typing import Any

from neuralgaits.certificate.levels.walking_set.theorem import cover_the_tube


def friction_needed(described: Mapping[str, Any]) -> float:
    """Return the least coefficient of friction on which no foot slips where the conditions hold.

    Args:
        described: a spec, as `GaitSpec.describe` returns it.

    Returns: infinity unless forces have a condition on either side on all of the tube, and impulses
        on all of the guard.
    """
    frictions: dict[str, float] = {}
    # Quantities by name, as `barriers.description` has them.
    forces = ("friction_forward", "friction_backward")
    impulses = ("impulse_cone_forward", "impulse_cone_backward")
    guard = (1.0, 0.0), (1.0, 1.0)
    for row in described["conditions"]:
        quantity = row.get("quantity")
        if row.get("kind") != "Pointwise" or not isinstance(quantity, Mapping):
            continue
        name = str(quantity.get("function"))
        boxes = described["regions"][row["region"]]
        on_the_tube = name in forces and cover_the_tube(_corners(boxes))
        if on_the_tube or (name in impulses and guard in _corners(boxes)):
            frictions[name] = min(quantity["coefficient"], frictions.get(name, math.inf))
    return max(frictions.values()) if set(frictions) == {*forces, *impulses} else math.inf


def _corners(boxes: Iterable[Any]) -> list[tuple[tuple[float, ...], tuple[float, ...]]]:
    """Return the corners of boxes, given as pairs or as mappings with "low" and "high"."""
    pairs = ((b["low"], b["high"]) if isinstance(b, Mapping) else b for b in boxes)
    return [(tuple(low), tuple(high)) for low, high in pairs]
