"""Differences between plant and model of a biped in three dimensions: values of `--disturb`."""

from collections.abc import Mapping
from dataclasses import dataclass

from neuralgaits.errors import InputError
from neuralgaits.simulation.setup.disturbance import PlantChanges, parse, quantity
from neuralgaits.simulation.setup.sensing import sensed

TICK_S = 0.001
"""Time between two ticks of the controller."""


@dataclass(frozen=True)
class SpatialChanges(PlantChanges):
    """Plant changes of a biped in three dimensions: no drives, and a lateral shift of the torso.

    Noise and resolution of angles are those of joints and of the torso's lean; `pitch_noise` is
    that of roll and pitch, `pitch_offset` of the pitch alone.

    Attributes:
        torso_shift_left_m: the torso's centre of mass moves to the left by this [m].
        torsional_friction_m: the yaw is free, and the feet resist twisting by this times the normal
            force [m]; None holds the yaw.
    """

    torso_shift_left_m: float = quantity(
        0.0, -1.0, 1.0, "torso centre of mass moved to the left [m]"
    )
    torsional_friction_m: float | None = quantity(
        None, 0.0, 1.0, "yaw free, feet that resist twisting by this times the normal force [m]"
    )

    def __post_init__(self):
        """Check every value against its range."""
        super().__post_init__()
        for name in ("drive_stiffness", "drive_damping", "drive_rate"):
            if getattr(self, name) != getattr(PlantChanges, name):
                raise InputError(
                    f"disturbance {name}: expected motors without a loop of their own for a walker "
                    "in three dimensions, found drives: leave it out"
                )

    @property
    def delay_ticks(self) -> int:
        """Return the number of control ticks from a reading to its torque."""
        return round(self.delay_ms * 1e-3 / TICK_S)


def changes_of(
    disturb: str | Mapping[str, float] | PlantChanges | None, sensing: str | None
) -> SpatialChanges:
    """Return the changes that a walk is asked for. Raises: InputError in one line."""
    return sensed(parse(disturb, SpatialChanges), sensing)
