"""The cart-pole's own part of its verbs: names, units and words."""

from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import PRNGKeyArray
from typing_extensions import override

from neuralgaits.systems.cartpole import FAMILY, LEVELS, cartpole_model
from neuralgaits.systems.cartpole.cartpole_data import CartPoleData
from neuralgaits.systems.cartpole.cartpole_model import CartPole
from neuralgaits.systems.cartpole.cartpole_records import CartPoleEpisodes, CartPoleFacts
from neuralgaits.systems.cartpole.cartpole_training import RECIPE, linear_start
from neuralgaits.systems.cartpole.mjcf import read_cartpole
from neuralgaits.systems.controller_header import ControllerHeader
from neuralgaits.systems.equilibrium import radial_conditions
from neuralgaits.systems.equilibrium.ellipsoid_training import EllipsoidStart
from neuralgaits.systems.equilibrium.equilibrium_system import (
    EquilibriumSystem,
)
from neuralgaits.systems.equilibrium.rest_figures import StateLabels
from neuralgaits.systems.family_run import FamilyRun
from neuralgaits.systems.family_verbs import NetworkVerbs
from neuralgaits.systems.system_family import Screen


class CartPoleSystem(EquilibriumSystem):
    """Model, training, proofs and words of cart-poles."""

    family = FAMILY
    levels = LEVELS
    table = LEVELS.table
    recipe = RECIPE
    spec_name = "balancing"
    steps = 3000
    hidden = 16
    state_size = 4
    why_highest = "a cart-pole's levels 2 and 3 are about the full order already"
    spec_files = (Path(radial_conditions.__file__), Path(cartpole_model.__file__))
    robot_file = Path(__file__).with_name("cartpole.xml")
    state_names = ("x", "theta", "x'", "theta'")
    state_units = ("m", "rad", "m/s", "rad/s")
    widest = 1

    @override
    def read(self, text: str, name: str) -> tuple[CartPole, CartPoleData]:
        return read_cartpole(text, name)

    def start(self, robot: CartPole, width: int, key: PRNGKeyArray) -> EllipsoidStart:
        """Return weights of a linear-quadratic policy, and a small ellipsoid."""
        return linear_start(robot, width, key)

    @override
    def labels(self, robot: CartPole) -> StateLabels:
        names = ("cart x [m]", "pole theta [rad]", "cart x' [m/s]", "rate [rad/s]")
        return StateLabels(names, "cart", robot.rail, "force [N]", robot.force_limit)

    def robot_facts(self, robot: CartPole, data: CartPoleData) -> CartPoleFacts:
        """Return masses, lengths and limits of a cart-pole's file for `inspect`."""
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

    def robot_screen(self, facts: CartPoleFacts) -> Screen:
        """Return a cart-pole's numbers for a person."""
        low, high = facts.rail_m
        pole = (
            f"{facts.pole_mass_kg:.4g} kg, centre of mass {facts.com_distance_m:.4g} m from its "
            f"hinge, inertia about it {facts.inertia_kg_m2:.4g} kg m^2"
        )
        motor = f"{facts.motor or 'no name'}, up to {facts.force_limit_n:.4g} N on the cart"
        return Screen(
            facts=[
                ("robot", f"{facts.robot}, a cart-pole"),
                ("cart", f"{facts.cart_mass_kg:.4g} kg, rail from {low:g} to {high:g} m"),
                ("pole", pole),
                ("motor", motor),
                ("joints", f"{facts.slide} (slide), {facts.hinge or 'no name'} (hinge)"),
            ]
        )

    def episode_record(
        self, run: FamilyRun, fields: dict[str, Any], largest: float
    ) -> CartPoleEpisodes:
        """Add the cart's reach to the figures of its episodes."""
        return CartPoleEpisodes(**fields, largest_x=largest, rail=run.robot.rail)

    def reach_in_words(self, episodes: CartPoleEpisodes) -> tuple[str, str]:
        """Return how far the cart went."""
        return "cart", f"up to {episodes.largest_x:.4g} of {episodes.rail:g} m from the middle"

    @override
    def header(self, run: FamilyRun) -> ControllerHeader:
        robot = run.robot
        return ControllerHeader(
            file="cartpole",
            function="ng_cartpole_force",
            title=f"the cart-pole {run.config.robot}",
            about="The force on the cart at a measured state (x, theta, x', theta') in m, rad, "
            "m/s, rad/s: x\n * from the middle of the rail, theta from the upright, positive where "
            "the pole leans to +x.\n * barrier is 1 - r^2, not negative in the set",
            advice="Clamp the force at NG_FORCE_LIMIT",
            constants={
                "FORCE_LIMIT": (robot.force_limit, "N"),
                "RAIL": (robot.rail, "m, from the middle of the rail to its end"),
            },
            output="force",
            unit="N",
            limit=robot.force_limit,
            proved="states in the set, in\n * continuous time and exact arithmetic: there the "
            "force is within the limit",
        )

    @override
    def page_lines(self, run: FamilyRun) -> list[str]:
        x, theta, velocity, turning = run.controller.ball.widths
        return [
            f"Set: cart up to {x:.3g} m from the middle of a rail of +-{run.robot.rail:g} m, pole "
            f"up to {np.degrees(theta):.3g} degrees from the upright, at up to {velocity:.3g} m/s "
            f"and {turning:.3g} rad/s.",
            f"Force limit: {run.robot.force_limit:g} N.",
        ]


SYSTEM = CartPoleSystem()
VERBS = NetworkVerbs(SYSTEM).by_name()
