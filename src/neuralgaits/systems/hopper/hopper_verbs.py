"""The hopper's own part of its verbs: reading, training, episodes, and words."""

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from matplotlib.figure import Figure
from typing_extensions import override

from neuralgaits._checks import SEEDS
from neuralgaits._types import Array, Float
from neuralgaits.errors import RunError
from neuralgaits.records.certified import Conclusion
from neuralgaits.runs.shell_words import command, named
from neuralgaits.systems.controller_header import ControllerHeader
from neuralgaits.systems.family_run import FamilyRun, NetworkConfig
from neuralgaits.systems.family_verbs import NetworkVerbs
from neuralgaits.systems.hopper import (
    FAMILY,
    hop_conditions,
    hop_tube,
    hopper_model,
    length_policy,
)
from neuralgaits.systems.hopper.hop_conditions import HopController, hop_margins
from neuralgaits.systems.hopper.hop_episodes import (
    HopEpisodes,
    HopSimulation,
    simulate_hops,
    trace_hops,
)
from neuralgaits.systems.hopper.hop_export import forces_of, header_of, random_states
from neuralgaits.systems.hopper.hop_figures import draw_hops, draw_tube
from neuralgaits.systems.hopper.hop_levels import TABLE, conclude
from neuralgaits.systems.hopper.hop_training import DEGREE, sampled_hops, train_hopper
from neuralgaits.systems.hopper.hop_tube import HopTube
from neuralgaits.systems.hopper.hopper_data import HopperData
from neuralgaits.systems.hopper.hopper_file import read_hopper
from neuralgaits.systems.hopper.hopper_model import Hopper
from neuralgaits.systems.hopper.hopper_records import (
    HopperFacts,
    HopperTrained,
)
from neuralgaits.systems.hopper.length_policy import LengthPolicy
from neuralgaits.systems.network_system import NetworkSystem
from neuralgaits.systems.system_family import Screen
from neuralgaits.systems.trained_system import TrainingProgress

SHOWN_HOPS = 10
"""Hops of an episode in the pictures."""


class HopperSystem(NetworkSystem):
    """Model, training, proofs and words of hoppers."""

    family, table = FAMILY, TABLE
    summary = HopperTrained
    spec_name = "hopping"
    steps = 600
    hidden = 8
    # After a hop the distance of two hops, times 1 + rate, is at most that before.
    rate = 0.2
    highest = 3
    state_size = 13
    spec_files = tuple(
        Path(str(one.__file__)) for one in (hop_conditions, hop_tube, length_policy, hopper_model)
    )
    why_highest = "a hopper's levels are about its hybrid zero dynamics"
    about_proofs = "the rigid model's hybrid zero dynamics: flights as their ends"
    robot_file = Path(__file__).with_name("hopper.xml")

    @override
    def read(self, text: str, name: str) -> tuple[Hopper, HopperData]:
        return read_hopper(text, name)

    def robot_facts(self, robot: Hopper, data: HopperData) -> HopperFacts:
        """Return masses, lengths and limits of a hopper's file for `inspect`."""
        return HopperFacts(
            robot=robot.name,
            upper_mass_kg=robot.upper_mass,
            foot_mass_kg=robot.foot_mass,
            wheel_inertia_kg_m2=robot.wheel_inertia,
            leg_m=(robot.shortest, robot.longest),
            foot_radius_m=data.foot_radius,
            force_limit_n=robot.force_limit,
            torque_limit_nm=robot.torque_limit,
            friction=robot.friction,
            gravity_m_s2=robot.gravity,
        )

    def robot_screen(self, facts: HopperFacts) -> Screen:
        """Return a hopper's numbers for a person."""
        low, high = facts.leg_m
        masses = f"{facts.upper_mass_kg:.4g} kg with its wheel, foot {facts.foot_mass_kg:.4g} kg"
        wheel = f"{facts.wheel_inertia_kg_m2:.4g} kg m^2, up to {facts.torque_limit_nm:.4g} N m"
        leg = f"from {low:.4g} to {high:.4g} m, up to {facts.force_limit_n:.4g} N"
        return Screen(
            facts=[
                ("robot", f"{facts.robot}, a hopper"),
                ("hub", masses),
                ("wheel", wheel),
                ("leg", leg),
                ("floor", f"friction {facts.friction:g}"),
            ]
        )

    @override
    def untrained(self, config: NetworkConfig) -> HopController:
        width, powers = config.width, np.zeros(DEGREE + 1)
        network = np.zeros((width, 2)), np.zeros(width), np.zeros(width)
        policy = LengthPolicy(np.zeros(4), np.zeros(()), *network, powers, np.zeros(()))
        return HopController(policy, HopTube(powers, powers[:-1], powers[:-1]))

    def refuse_controller(self, controller: HopController, file: Path) -> None:
        """Refuse ends that no stance has. Raises: RunError."""
        first, last = np.asarray(controller.policy.ends)[:2]
        if not -1.0 < first < last < 1.0:
            raise RunError(
                f"expected leans at touchdown and lift-off in this order from -1 to 1 rad in "
                f"{file}, found {first:.3g} and {last:.3g}: the file was changed; train again"
            )

    def train(
        self, robot: Hopper, config: NetworkConfig, progress: TrainingProgress | None
    ) -> HopController:
        """Train a policy and its tube."""
        return train_hopper(
            robot,
            seed=config.seed,
            steps=config.steps,
            rate=config.rate,
            width=config.width,
            progress=progress,
        )

    def measured(self, run: FamilyRun) -> dict[str, Any]:
        """Return the margins at fresh random states, and hops at both ends of the tube."""
        count = 2**15
        key = jax.random.key(SEEDS)  # No run has that seed.
        margins = sampled_hops(run.robot, run.controller, run.config.rate, key, count)
        hop, tube = run.controller.policy.flight(run.robot), run.controller.tube
        end = jnp.ones(())
        sigma = [float(tube.momentum(end, jnp.asarray(level))) for level in (0.0, 1.0)]
        rises = [float(hop.upward) * one for one in sigma]
        gravity = run.robot.gravity
        return {
            "margins": {name: float(np.min(rows)) for name, rows in margins.items()},
            "samples": count,
            "speeds": tuple(float(hop.forward) * one for one in sigma),
            "heights": tuple(0.5 * one * one / gravity for one in rises),
            "air_times": tuple(2.0 * one / gravity for one in rises),
        }

    def sizes(self, summary: HopperTrained) -> str:
        """Return speeds and flights of the tube in words."""
        (slow, fast), (low, high) = summary.speeds, summary.heights
        return f"{slow:.3g} to {fast:.3g} m/s, hops of {low * 1e3:.3g} to {high * 1e3:.3g} mm"

    def margins(self, run: FamilyRun, u: Float[Array, "2"]) -> Mapping[str, Array]:
        """Return the margins at a point of the chart: progress of the stance and level."""
        return hop_margins(run.robot, run.controller, run.config.rate, u)

    def place(self, run: FamilyRun, u: Float[Array, "2"]) -> tuple[float, float]:
        """Return lean and momentum at a point of the chart."""
        policy, tube = run.controller.policy, run.controller.tube
        return float(policy.lean(u[0])), float(tube.momentum(u[0], u[1]))

    def place_in_words(self, place: tuple[float, float]) -> str:
        """Return lean and momentum in words."""
        return f"lean {place[0]:.4g} rad, momentum {place[1]:.4g} kg m^2/s"

    def spec_numbers(self, config: NetworkConfig) -> Mapping[str, float]:
        """Return the rate of approach that is asked for."""
        return {"rate": config.rate}

    @override
    def conclude(
        self, bounds: Mapping[str, float | None], config: NetworkConfig, level: int
    ) -> tuple[Conclusion, ...]:
        return conclude(bounds, config.rate, level)

    @override
    def header(self, run: FamilyRun) -> ControllerHeader:
        return header_of(run)

    def law(self, run: FamilyRun) -> Callable[[Float[Array, "13"]], dict[str, Array]]:
        """Return the forces of stance and flight."""
        return forces_of(run)

    def states(self, run: FamilyRun, count: int, seed: int) -> Float[np.ndarray, "count 13"]:
        """Return random states of stances and flights."""
        return random_states(run, count, seed)

    def episodes(self, run: FamilyRun, count: int, seed: int) -> tuple[HopEpisodes, bool]:
        """Hop in MuJoCo from momenta of the tube. Returns: record, whether all stayed up."""
        record = simulate_hops(run, count, seed)
        return record, record.stayed_up == record.episodes

    def episodes_screen(self, record: HopEpisodes) -> Screen:
        """Return how many hops were done, and how they went."""
        good = record.stayed_up == record.episodes
        hops = record.hops * record.episodes
        return Screen(
            "hops" if good else "falls",
            f": {record.stayed_up} of {record.episodes} episodes of {record.hops} hops stayed up",
            None,
            [
                (
                    "hops",
                    f"{record.done} of {hops}, {100.0 * record.in_tube:.4g} % of landings in the "
                    "tube",
                ),
                ("speed", f"{record.speed:.3g} m/s, {record.air_time:.3g} s in the air each"),
                (
                    "leg",
                    f"asked for {record.largest_force:.4g} of {record.force_limit:g} N in stance",
                ),
                (
                    "wheel",
                    f"asked for {record.largest_torque:.4g} of {record.torque_limit:g} N m",
                ),
                ("clamped", f"{100.0 * record.clamped:.2g} % of ticks"),
                ("next", command("report", named(record.run))),
            ],
        )

    def page_lines(self, run: FamilyRun) -> list[str]:
        """Return the sentences at the head of a run's page, about robot and tube."""
        summary = HopperTrained.read(run.path / "summary.json")
        return [
            f"Tube: {self.sizes(summary)}.",
            f"Limits: {run.robot.force_limit:g} N of the leg's motor, {run.robot.torque_limit:g} "
            f"N m of the wheel's; friction {run.robot.friction:g}.",
        ]

    def page_figures(self, run: FamilyRun) -> Sequence[tuple[Figure, str]]:
        """Draw the tube, and hops in MuJoCo."""
        simulation = HopSimulation(run)
        traces = [trace_hops(simulation, level, SHOWN_HOPS) for level in (0.0, 0.5, 1.0)]
        tube = draw_tube(run.robot, run.controller, traces)
        return (
            (tube, "The tube's fences, lengths of the leg at them, and levels in MuJoCo"),
            (draw_hops(traces[0]), "An episode of MuJoCo from the low fence, over time"),
        )


SYSTEM = HopperSystem()
VERBS = NetworkVerbs(SYSTEM).by_name()
