"""Contents of a cart-pole's file in the terms of the theory."""

from dataclasses import dataclass
from pathlib import Path

from neuralgaits.errors import InputError
from neuralgaits.records.installed import BuiltIn, CatalogueEntry
from neuralgaits.records.record import Pair, Record
from neuralgaits.runs.atomic import write_new
from neuralgaits.runs.shell_words import command
from neuralgaits.systems.cartpole import FAMILY
from neuralgaits.systems.cartpole.mjcf import BUILT_IN, cartpole_text, read_cartpole


@dataclass(frozen=True, eq=False)
class CartPoleFacts(Record):
    """A cart-pole's file. Units are in the names.

    Attributes:
        cart_mass_kg: with the rotor's reflected mass.
        com_distance_m: from the hinge to the pole's centre of mass.
        inertia_kg_m2: of the pole about the hinge.
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


def inspect_cartpole(source: str | Path) -> CartPoleFacts:
    """Describe a cart-pole's file. Raises: RobotError with all that is wrong with it."""
    robot, data = read_cartpole(*cartpole_text(source))
    return CartPoleFacts(
        robot=robot.name,
        cart_mass_kg=data.cart_mass + data.cart_armature,
        pole_mass_kg=data.pole_mass,
        com_distance_m=data.distance,
        inertia_kg_m2=robot.inertia,
        cart_damping_ns_m=data.cart_damping,
        pole_damping_nms_rad=data.pole_damping,
        gravity_m_s2=data.gravity,
        rail_m=(data.rail_low, data.rail_high),
        lean_rad=data.lean,
        force_limit_n=data.force_limit,
        slide=data.slide,
        hinge=data.hinge,
        motor=data.motor,
    )


def write_cartpole(out: Path | None) -> BuiltIn:
    """Write the built-in cart-pole's file. Raises: InputError if there is a file, or no name."""
    if out is None:
        line = command("robots", BUILT_IN, "--out", f"{BUILT_IN}.xml")
        raise InputError(f"expected a file to write {BUILT_IN} to, found none: write `{line}`")
    text, _ = cartpole_text(BUILT_IN)
    write_new(out, text)
    return BuiltIn((CatalogueEntry(BUILT_IN, FAMILY.built_in[BUILT_IN]),), (), str(out))
