"""The floor of a box of robots, as a disturbance of walks."""

from collections.abc import Mapping
from dataclasses import replace

from neuralgaits.errors import InputError
from neuralgaits.records.simulated import FLOOR_DISTURBANCES
from neuralgaits.simulation.setup.disturbance import PlantChanges


def on_floor_of(box: Mapping[str, float], disturbance: PlantChanges) -> PlantChanges:
    """Return a disturbance with the floor of the box: least friction, footholds up and down.

    Args:
        box: half widths by kind, see `robots.parameter_box`.
        disturbance: disturbance of the plant.

    Raises: InputError if both set the floor.
    """
    named = FLOOR_DISTURBANCES.items()
    extents = {name: box[kind] for kind, name in named if kind in box}
    default = PlantChanges()
    for name in extents:
        if getattr(disturbance, name) != getattr(default, name):
            raise InputError(
                f"expected {name} of --disturb or of --parameters, found both: leave one out"
            )
    return replace(disturbance, **extents)
