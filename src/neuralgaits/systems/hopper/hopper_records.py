"""Records of hoppers: numbers of a file, configuration and result of a training."""

from dataclasses import dataclass

from neuralgaits.records.record import Pair, Record
from neuralgaits.systems.family_run import TrainedSummary


@dataclass(frozen=True, eq=False, kw_only=True)
class HopperFacts(Record):
    """A hopper's file. Units are in the names; masses of hub and wheel count together."""

    robot: str
    upper_mass_kg: float
    foot_mass_kg: float
    wheel_inertia_kg_m2: float
    leg_m: Pair
    foot_radius_m: float
    force_limit_n: float
    torque_limit_nm: float
    friction: float
    gravity_m_s2: float


@dataclass(frozen=True, eq=False, kw_only=True)
class HopperTrained(TrainedSummary):
    """Result of `train`.

    Attributes:
        speeds: forward speed of the centre of mass in flight, at both ends of the tube (m/s).
        heights: how far it rises in flight, there (m).
        air_times: durations of flights, there (s).
    """

    speeds: Pair
    heights: Pair
    air_times: Pair
