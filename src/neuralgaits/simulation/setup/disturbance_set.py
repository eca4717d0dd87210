"""Disturbances on which every policy is tested, one at a time.

The project chose their sizes as plausible errors of a robot's model; they combine, since each is a
`PlantChanges`. The robot's own numbers are in its model file.
"""

from math import pi
from types import MappingProxyType

from neuralgaits.simulation.setup.disturbance import PlantChanges

DISTURBANCE_SET = MappingProxyType(
    {
        "mass -15 %": PlantChanges(mass_scale=0.85),
        "mass +15 %": PlantChanges(mass_scale=1.15),
        "torso 3 cm behind": PlantChanges(torso_shift_m=-0.03),
        "torso 3 cm ahead": PlantChanges(torso_shift_m=0.03),
        "joint friction 2 N m": PlantChanges(joint_friction=2.0),
        "delay 1 ms": PlantChanges(delay_ms=1),
        "delay 2 ms": PlantChanges(delay_ms=2),
        "delay 4 ms": PlantChanges(delay_ms=4),
        "torque limit 30 N m": PlantChanges(torque_limit=30.0),
        "torque limit 20 N m": PlantChanges(torque_limit=20.0),
        "encoders of 12 bits": PlantChanges(encoder_step=2.0 * pi / 2**12),
        "noise 2 mrad, 0.1 rad/s": PlantChanges(encoder_noise=0.002, rate_noise=0.1),
        "ground friction 0.4": PlantChanges(friction=0.4),
        "ground friction 1.0": PlantChanges(friction=1.0),
        "floor +-1 cm": PlantChanges(floor_height=0.01),
        "floor +-2 cm": PlantChanges(floor_height=0.02),
        "slope 3 deg up": PlantChanges(slope_deg=3.0),
        "slope 3 deg down": PlantChanges(slope_deg=-3.0),
    }
)
"""Disturbances by their names in tables."""
