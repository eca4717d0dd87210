"""The part of a family's verbs that follows where its proved set is an ellipsoid at rest."""

from abc import abstractmethod
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import jax
import numpy as np
from jaxtyping import PRNGKeyArray
from matplotlib.figure import Figure
from typing_extensions import override

from neuralgaits._checks import SEEDS
from neuralgaits._types import Array, Float
from neuralgaits.errors import RunError
from neuralgaits.records.certified import Conclusion
from neuralgaits.runs.shell_words import command, named
from neuralgaits.systems.equilibrium.ellipsoid import Ball, direction
from neuralgaits.systems.equilibrium.ellipsoid_levels import EllipsoidLevels
from neuralgaits.systems.equilibrium.ellipsoid_training import (
    EllipsoidRecipe,
    EllipsoidStart,
    sampled_margins,
    train_ellipsoid,
)
from neuralgaits.systems.equilibrium.radial_conditions import EllipsoidController, radial_margins
from neuralgaits.systems.equilibrium.rest_episodes import (
    RestEpisodes,
    law_of,
    simulate_at_rest,
    traces_of,
)
from neuralgaits.systems.equilibrium.rest_figures import StateLabels, draw_planes, draw_times
from neuralgaits.systems.equilibrium.velocity_policy import Controls
from neuralgaits.systems.family_run import FamilyRun, NetworkConfig, TrainedSummary
from neuralgaits.systems.network_system import NetworkSystem
from neuralgaits.systems.system_family import Screen
from neuralgaits.systems.trained_system import TrainingProgress

EPISODES = 12
"""Episodes in the pictures, each from the set's face."""
SHOWN_S = 8.0
"""Length of an episode in the pictures [s]."""


@dataclass(frozen=True, eq=False, kw_only=True)
class EllipsoidTrained(TrainedSummary):
    """Result of `train`.

    Attributes:
        widths: half widths of the set's projections on the coordinates of a state (SI units).
        volume: volume of the set, in the product of their units.
    """

    widths: tuple[float, ...]
    volume: float


class EquilibriumSystem(NetworkSystem):
    """A family whose trajectories come to rest in an ellipsoid of states.

    Attributes:
        levels: what follows from its conditions.
        recipe: numbers of its training.
        state_names, state_units: names and units of coordinates and rates.
        widest: coordinate that is largest at the start of the first episode.
    """

    summary = EllipsoidTrained
    highest = 3
    # Required decay of the set's radius [1/s].
    rate = 0.05
    about_proofs = "the rigid model's full state, in continuous time"
    levels: EllipsoidLevels
    recipe: EllipsoidRecipe
    state_names: Sequence[str]
    state_units: Sequence[str]
    widest: int

    @abstractmethod
    def start(self, robot: Any, width: int, key: PRNGKeyArray) -> EllipsoidStart:
        """Return weights of a linear controller that comes to rest, and a small ellipsoid."""

    @abstractmethod
    def labels(self, robot: Any) -> StateLabels:
        """Return the words of the figures' axes."""

    @abstractmethod
    def episode_record(self, run: FamilyRun, fields: dict[str, Any], largest: float) -> Any:
        """Return the record of episodes.

        Args:
            run: the run.
            fields: fields of a `RestEpisodes`.
            largest: value of the first coordinate, on either side.
        """

    @abstractmethod
    def reach_in_words(self, episodes: Any) -> tuple[str, str]:
        """Return name and words of how far the first coordinate went."""

    @override
    def untrained(self, config: NetworkConfig) -> EllipsoidController:
        return EllipsoidController(Controls.zeros(config.width), Ball(np.zeros((4, 4))))

    def refuse_controller(self, controller: EllipsoidController, file: Path) -> None:
        """Refuse a ball that is no lower triangular matrix: its radius is solved for by rows.

        Raises: RunError.
        """
        shape = np.asarray(controller.ball.shape)
        least_width = 1e-9  # Least half width of the set along each of its axes (SI units).
        if not np.array_equal(shape, np.tril(shape)) or not np.all(np.diag(shape) >= least_width):
            raise RunError(
                f"expected a lower triangular matrix with a diagonal of {least_width:g} or more "
                f"for the set in {file}, found another: the file was changed; train again"
            )

    def train(
        self, robot: Any, config: NetworkConfig, progress: TrainingProgress | None
    ) -> EllipsoidController:
        """Train a controller and its ellipsoid."""
        key = jax.random.key(config.seed)
        start = self.start(robot, config.width, key)
        return train_ellipsoid(
            robot,
            start,
            self.recipe,
            key=key,
            steps=config.steps,
            rate=config.rate,
            progress=progress,
        )

    def measured(self, run: FamilyRun) -> dict[str, Any]:
        """Return the margins at fresh random states, and the set's sizes."""
        count = 2**16
        ball = run.controller.ball
        key = jax.random.key(SEEDS)  # No run has that seed.
        margins = sampled_margins(run.robot, run.controller, run.config.rate, key, count)
        return {
            "margins": {name: float(np.min(rows)) for name, rows in margins.items()},
            "samples": count,
            "widths": ball.widths,
            "volume": ball.volume,
        }

    def sizes(self, summary: EllipsoidTrained) -> str:
        """Return the half widths of the set in words."""
        rows = zip(self.state_names, summary.widths, self.state_units, strict=True)
        return ", ".join(f"{name} +-{width:.3g} {unit}" for name, width, unit in rows)

    def margins(self, run: FamilyRun, u: Float[Array, "4"]) -> Mapping[str, Array]:
        """Return the margins at a point of the chart: radius and angles."""
        return radial_margins(run.robot, run.controller, run.config.rate, u[0], direction(u[1:]))

    def place(self, run: FamilyRun, u: Float[Array, "4"]) -> tuple[float, float]:
        """Return the coordinates of the state at a point of the chart."""
        first, second = run.controller.ball.state(u[0], direction(u[1:]))[:2]
        return float(first), float(second)

    def place_in_words(self, place: tuple[float, float]) -> str:
        """Return the coordinates of a state in words."""
        rows = zip(self.state_names, place, self.state_units, strict=False)
        return ", ".join(f"{name} = {value:.4g} {unit}" for name, value, unit in rows)

    def spec_numbers(self, config: NetworkConfig) -> Mapping[str, float]:
        """Return the rate that descent and settling are about."""
        return {"rate": config.rate}

    @override
    def conclude(
        self, bounds: Mapping[str, float | None], config: NetworkConfig, level: int
    ) -> tuple[Conclusion, ...]:
        return self.levels.conclude(bounds, config.rate, level)

    def law(self, run: FamilyRun) -> Callable[[Float[Array, "4"]], dict[str, Array]]:
        """Return the exported controller: force and barrier."""
        law = law_of(run)

        def outputs(state: Float[Array, "4"]) -> dict[str, Array]:
            force, radius_squared = law(state)
            return {"force": force, "barrier": 1.0 - radius_squared}

        return outputs

    def states(self, run: FamilyRun, count: int, seed: int) -> Float[np.ndarray, "count 4"]:
        """Return random states of the set's face."""
        ball: Ball = run.controller.ball
        return ball.face(count, seed, self.widest)

    def episodes(self, run: FamilyRun, count: int, seed: int) -> tuple[RestEpisodes, bool]:
        """Simulate in MuJoCo from the set's face."""
        fields, traces = simulate_at_rest(run, episodes=count, seed=seed, widest=self.widest)
        first = max(float(np.abs(one.state[:, 0]).max()) for one in traces)
        record = self.episode_record(run, fields, first)
        return record, record.stayed == record.episodes

    def episodes_screen(self, record: RestEpisodes) -> Screen:
        """Return how many episodes stayed in the set, and how close they came to its limits."""
        good = record.stayed == record.episodes
        rest = "not all" if record.settled_s is None else f"within {record.settled_s:.3g} s"
        return Screen(
            "balances" if good else "leaves the set",
            f": {record.stayed} of {record.episodes} episodes of {record.seconds:g} s stayed in it",
            None,
            [
                ("at rest", rest),
                ("force", f"up to {record.largest_force:.4g} of {record.force_limit:g} N"),
                self.reach_in_words(record),
                ("radius", f"up to {record.largest_radius:.6g}; 1 is the set's face"),
                ("next", command("report", named(record.run))),
            ],
        )

    def page_figures(self, run: FamilyRun) -> Sequence[tuple[Figure, str]]:
        """Draw episodes of MuJoCo from the set's face."""
        labels = self.labels(run.robot)
        traces = traces_of(run, self.states(run, EPISODES, seed=0), SHOWN_S)
        planes = draw_planes(traces, run.controller.ball.shape, labels)
        times = draw_times(traces, run.config.rate, labels)
        return (
            (planes, "Episodes of MuJoCo from the set's face, in two planes"),
            (times, f"Radius, force and {labels.moved} of the same episodes over time"),
        )
