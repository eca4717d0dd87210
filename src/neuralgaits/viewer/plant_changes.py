"""Where the robot and the floor of a live page differ from those that a proof is about."""

import math
from collections.abc import Mapping

from neuralgaits.simulation.setup.disturbance import PlantChanges
from neuralgaits.viewer.slider import Slider

SLOPE_SETTING = "slope_deg"
"""Name of the disturbance that tilts the floor."""
_SLOPE_DEG = 0.01
"""Difference of slopes that is shown [deg]."""


def changed_settings(
    settings: Mapping[str, Slider], plant: PlantChanges, commanded_slope: float | None = None
) -> tuple[str, ...]:
    """Return the settings that are not at their first values, each with its value and unit.

    Args:
        settings: sliders by disturbance.
        plant: disturbances of the simulated plant.
        commanded_slope: slope that the gait walks on [rad]; None if it takes no such command. Then
            a floor of another slope is a change.
    """
    changes = []
    for name, slider in settings.items():
        value = getattr(plant, name)
        if value is None:
            continue
        value /= slider.unit
        if name == SLOPE_SETTING and commanded_slope is not None:
            commanded = math.degrees(commanded_slope)
            if abs(value - commanded) > _SLOPE_DEG:
                changes.append(f"{_words(slider, value)}, commanded {commanded:.2f} deg")
        # The page shows three digits, and may send back what it shows.
        elif f"{value:.3g}" != f"{slider.first:.3g}":
            changes.append(_words(slider, value))
    return tuple(changes)


def off_proof_words(changes: tuple[str, ...], proved_of: str) -> str:
    """Return a line about changes and what the proof is about; "" if nothing is proved, or none."""
    if not changes or not proved_of:
        return ""
    return f"Changed: {'; '.join(changes)}. The proof is about {proved_of}."


def _words(slider: Slider, value: float) -> str:
    name, _, unit = slider.label.partition(" [")
    return " ".join(filter(None, (name, f"{value:.3g}", unit.removesuffix("]"))))
