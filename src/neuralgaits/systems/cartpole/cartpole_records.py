"""Records of cart-poles: numbers of a file, and of episodes."""

from dataclasses import dataclass

from neuralgaits.records.record import Pair, Record
from neuralgaits.systems.equilibrium.rest_episodes import RestEpisodes


@dataclass(frozen=True, eq=False)
class CartPoleFacts(Record):
    """A cart-pole's file. Units are in the names.

    Attributes:
        cart_mass_kg: mass of the cart, with the rotor's reflected mass.
        com_distance_m: distance from the hinge to the pole's centre of mass.
        inertia_kg_m2: inertia of the pole about the hinge.
        lean_rad: room for the pole on either side of the upright; at most a quarter turn.
        slide, hinge, motor: names in the file.
    """

    robot: str
    cart_mass_kg: float
    pole_mass_kg: float
    com_distance_m: float
    inertia_kg_m2: float
    cart_damping_ns_m: float
    pole_damping_nms_rad: float
    gravity_m_s2: float
    rail_m: Pair
    lean_rad: float
    force_limit_n: float
    slide: str
    hinge: str
    motor: str


@dataclass(frozen=True, eq=False, kw_only=True)
class CartPoleEpisodes(RestEpisodes):
    """Result of `simulate`.

    Attributes:
        largest_x, rail: largest distance from the rail's middle, and half the rail's length (m).
    """

    largest_x: float
    rail: float
