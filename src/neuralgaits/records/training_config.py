"""Settings of a training: `config.json` of a run, without the entries that `runs` adds."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Any, Literal, Protocol

from neuralgaits._checks import SEEDS
from neuralgaits.errors import RunError
from neuralgaits.records.level_words import HIGHEST, HIGHEST_OF_MANY, ORBIT_LEVEL
from neuralgaits.records.record import Pair, Record, build, shape_of
from neuralgaits.runs.json_files import refuse_misshapen
from neuralgaits.runs.names import CONFIG
from neuralgaits.runs.shape import NUMBER, TEXT, list_of, table_of, whole

HIGHEST_DEGREE = 20
"""Highest degree of output polynomials; above it Bernstein's form would lose digits."""
WIDEST = 2**14
"""Widest hidden layer of a config; a wider one means damage, and would fill the memory."""
DEEPEST = 16
"""Largest number of hidden layers of a config."""
Seed = Annotated[int, whole(0, SEEDS - 1)]
Steps = Annotated[int, whole(0, 2**31 - 1)]
Degree = Annotated[int, whole(1, HIGHEST_DEGREE)]
Widths = Annotated[tuple[int, ...], list_of(whole(1, WIDEST), *range(1, DEEPEST + 1))]
Spec = Annotated[
    Mapping[str, Any],
    {
        "recipe": {"learning_rate?": NUMBER, "samples?": table_of(NUMBER)},
        "conditions": list_of({"name": TEXT, "region": TEXT, "scale": NUMBER}),
    },
]


class Folder(Protocol):
    """Interface of a run folder that has a config."""

    @property
    def path(self) -> Path:
        """Path of the run folder itself."""
        ...

    @property
    def config(self) -> Mapping[str, Any]:
        """Content of the run's `config.json`, parsed."""
        ...


@dataclass(frozen=True)
class Proving:
    """Proofs during training. Attributes: budget_s: time for all of them; None for no limit."""

    budget_s: float | None


@dataclass(frozen=True)
class ConditionRecord:
    """A condition of a run's spec. Attributes: data: all of it, see `barriers.description`."""

    name: str
    region: str
    scale: float
    data: Mapping[str, Any]


@dataclass(frozen=True)
class Range:
    """Range of a command of a gait.

    Attributes:
        low, high: ends of the range (see `gait.commands` for units).
        largest_change: largest change from one step to the next; None for any.
    """

    low: float
    high: float
    largest_change: float | None = None


@dataclass(frozen=True)
class GaitOrigin:
    """Origin of a gait that was not trained.

    Attributes:
        by: the verb that made the run.
        degree: degree of the polynomials of its outputs.
        speed: mean speed requested of an optimisation (m/s); None for an imported gait.
    """

    by: Literal["import-gait", "optimise"]
    degree: Degree
    speed: float | None = None


@dataclass(frozen=True, eq=False, kw_only=True)
class TrainingConfig(Record):
    """Configuration of a training.

    Attributes:
        robot, spec: names, for people: the run has copies of both.
        seed: seed of weights and samples.
        init: what the weights start from.
        hidden: widths of the hidden layers; None for a policy without a network.
        steps: gradient steps.
        described: the spec as plain data, see `GaitSpec.describe`.
        not_provable_because: None if the gait can be certified.
        certify: None if no proof was asked for.
        rate: share of the recipe's learning rate.
        disturbance: what may be added to dz (m/s, N m); None if nothing.
        parent: the run that this one was refined from; None for one that was trained.
        commands: what the gait is told at each touchdown, by name.
        speed: mean speed that is aimed at (m/s); None for whatever comes.
        parameters: box of robots that the gait is meant for, half widths by kind (shares of the
            file's value; metres for com); none for the robot of the file alone.
        given: origin of a gait that was imported or optimised without training; None for another.
    """

    robot: str
    spec: str
    seed: Seed
    init: Literal["posture", "random"]
    hidden: Widths | None
    steps: Steps
    described: Spec
    not_provable_because: str | None
    certify: Proving | None = None
    rate: float = 1.0
    disturbance: Pair | None = None
    parent: str | None = None
    commands: Mapping[str, Range] = field(default_factory=dict)
    speed: float | None = None
    parameters: Mapping[str, float] = field(default_factory=dict)
    given: GaitOrigin | None = None

    def omitted(self) -> Collection[str]:
        """Return the fields that `--json` omits: settings of `refine` if none, and empty ones."""
        refined = () if self.parent is not None else ("rate", "disturbance", "parent")
        optional = ("commands", "speed", "parameters", "given")
        return (*refined, *(name for name in optional if not getattr(self, name)))

    @property
    def as_given(self) -> GaitOrigin | None:
        """Origin of an imported or optimised gait; None if the gait was trained or refined."""
        return self.given if self.parent is None else None

    @property
    def last_level(self) -> int:
        """Highest level that a certificate of this run can reach."""
        many = self.described.get("parameters") or self.described.get("ground")
        if self.on_flat_feet:
            return ORBIT_LEVEL
        return HIGHEST_OF_MANY if self.commands or many else HIGHEST

    @property
    def on_flat_feet(self) -> bool:
        """Whether a condition of the spec keeps a flat foot on the floor."""
        quantities = (one.get("quantity") for one in self.described["conditions"])
        return any(
            isinstance(one, Mapping) and one.get("function") == "pressure_reserve"
            for one in quantities
        )

    @property
    def recipe_steps(self) -> int:
        """Gradient steps that the recipe asks for; 0 if it names none."""
        steps = self.described["recipe"].get("steps")
        return steps if isinstance(steps, int) else 0

    @property
    def learning_rate(self) -> float | None:
        """Learning rate of the recipe; None if the recipe has none."""
        return self.described["recipe"].get("learning_rate")

    @property
    def samples(self) -> Mapping[str, int]:
        """Number of fresh samples in each region for one gradient step."""
        return self.described["recipe"].get("samples") or {}

    @property
    def conditions(self) -> Sequence[ConditionRecord]:
        """Conditions of the run's spec, in its order."""
        rows = self.described["conditions"]
        return [ConditionRecord(row["name"], row["region"], row["scale"], row) for row in rows]

    @property
    def regions(self) -> Mapping[str, Any]:
        """Boxes of every region, by name."""
        return self.described["regions"]


def config_of(folder: Folder) -> TrainingConfig:
    """Return the settings of a run. Raises: RunError if its config is not that of a training."""
    if (family := folder.config.get("family")) is not None:
        raise RunError(
            f"expected a walker's run, found one of family {family!r} at {folder.path}: it has "
            "verbs of its own, as docs/cartpole.md says"
        )
    refuse_misshapen(folder.config, shape_of(TrainingConfig), folder.path / CONFIG)
    return build(TrainingConfig, folder.config)
