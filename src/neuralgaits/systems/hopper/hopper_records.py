"""Records of hoppers: numbers of a file, configuration and result of a training."""

from dataclasses import dataclass
from typing import Annotated

from neuralgaits.records.record import Pair, Record
from neuralgaits.runs.shape import POSITIVE, whole
from neuralgaits.systems.family_run import FamilyConfig, TrainedSummary

WIDEST_NETWORK = 256
"""Largest width of the hidden layer."""


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
class HopperConfig(FamilyConfig):
    """Configuration of a training.

    Attributes:
        width: of the network's hidden layer.
        rate: after a hop the distance of two hops, times 1 + rate, is at most that before.
    """

    width: Annotated[int, whole(1, WIDEST_NETWORK)]
    rate: Annotated[float, POSITIVE]

    def __post_init__(self) -> None:
        # A file may have it as a whole number.
        object.__setattr__(self, "rate", float(self.rate))


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
