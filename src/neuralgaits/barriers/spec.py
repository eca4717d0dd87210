"""A gait specification: conditions on regions, where training starts and how it proceeds."""

from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass, field, replace
from numbers import Real
from typing import Any, Literal, NamedTuple

from jaxtyping import PRNGKeyArray

from neuralgaits._names import meant, why_no_name
from neuralgaits._printable import shown
from neuralgaits._types import Array, Float
from neuralgaits.barriers.aims import AbstractAim
from neuralgaits.barriers.conditions import AbstractCondition
from neuralgaits.barriers.description import describe_condition
from neuralgaits.barriers.regions import Box
from neuralgaits.errors import SpecError
from neuralgaits.gait import ZeroDynamics
from neuralgaits.gait.commands import Commands
from neuralgaits.gait.gaits import Gait
from neuralgaits.gait.policies.commanded_gait import AnyGait
from neuralgaits.robots.mjcf.parameters import ParameterAxis

Init = Literal["posture", "random"]


@dataclass(frozen=True)
class Recipe:
    """Settings of a spec's training, each of them a choice made where the spec is written.

    Attributes:
        steps: gradient steps.
        samples: fresh samples a step in each region.
        learning_rate: learning rate of AdamW, for the widths that the spec itself gives a network.
        weight_decay: weight decay of AdamW.
        warmup: share of the steps over which the rate rises from zero: without it some seeds jump
            into a poor minimum in their first steps.
        milestones: shares of the steps at which the rate drops to a tenth; None for a cosine
            schedule.
        overshoot: reach of samples beyond the chart's edges in (phase, level).
        aim: margin below which a condition is penalised, in its scale.
        worst_weight: weight of the worst sample's violation beside the mean.
        logarithmic: let a condition's penalty grow like a logarithm above one, so that one
            condition far off cannot drown the rest.
        effort: weight of the mean squared torque in units of `effort_torque`.
        effort_torque: [N m].
        posture_steps: supervised steps towards the nominal posture before training.
        curriculum: share of the steps over which the range of commands grows from its middle.
        widened: share of the range of a command that training adds beyond each of its ends; a
            narrow range of speeds is widened by more.
        faster_changes: share by which training exceeds the largest change of a command, because
            calibration stretches changes.
        corners: share of the samples of a command's axis that lie on its ends.
        strip: phases before and behind phase 1 in which samples of the guard lie.
        largest_gradient: norm that gradients are clipped to; None for any.

    Raises: SpecError on milestones or an overshoot that training would not read as meant.
    """

    steps: int
    samples: Mapping[str, int]
    learning_rate: float
    weight_decay: float
    warmup: float = 0.0
    milestones: tuple[float, ...] | None = None
    overshoot: tuple[float, float] = (0.0, 0.0)
    aim: float = 0.0
    worst_weight: float = 0.0
    logarithmic: bool = False
    effort: float = 0.0
    effort_torque: float = 1.0
    posture_steps: int = 0
    curriculum: float = 0.0
    widened: float = 0.0
    faster_changes: float = 0.0
    corners: float = 0.0
    strip: float = 0.0
    largest_gradient: float | None = None

    def __post_init__(self):
        """Refuse milestones that are no shares, and an overshoot of other than two axes."""
        shares = self.milestones
        if shares is not None and not (_numbers(shares) and all(0.0 < one < 1.0 for one in shares)):
            raise SpecError(
                "recipe.milestones: expected shares of the steps between 0 and 1, as in "
                f"(0.1, 0.4, 0.8), found {shown(shares)}: mend them, or write None for a cosine"
            )
        # One number would leave the level as it is; a third would reach into the commands' axes.
        if not (_numbers(self.overshoot) and len(self.overshoot) == 2):
            raise SpecError(
                "recipe.overshoot: expected two numbers, of phase and level, as in (0.02, 0.03), "
                f"found {shown(self.overshoot)}: give both"
            )


def _numbers(values: Any) -> bool:
    """Return whether a setting is a tuple or a list of numbers."""
    return isinstance(values, tuple | list) and all(
        isinstance(one, Real) and not isinstance(one, bool) for one in values
    )


class ChartPoint(NamedTuple):
    """Point of the chart, split into its groups of axes."""

    plane: Float[Array, "2"]
    """Phase and level of the point."""
    commands: Float[Array, " c"]
    """Point of the commands' axes."""
    errors: Float[Array, " k"]
    """Errors of the robot's parameters."""


@dataclass(frozen=True)
class GaitSpec:
    """Conditions that make a policy walk, with everything needed to train for them.

    Attributes:
        name: name of the spec.
        conditions: conditions with unique names.
        regions: name to boxes of the tube's chart.
        new_gait: (key, init, hidden widths or None) to an untrained gait.
        recipe: training settings.
        weights: factor of each condition's loss; 1 where absent.
        commands: commands that the gait receives at each touchdown.
        aims: goals of training beside the conditions; no certificate makes a claim about them.
        parameters: by which the robot may differ from its file, of `parameters.axes_of`: the
            conditions are meant for every robot of that box.
        ground: kinds of `parameter_box.GROUND` that the conditions are also meant for.
    """

    name: str
    conditions: tuple[AbstractCondition, ...]
    regions: Mapping[str, tuple[Box, ...]]
    new_gait: Callable[[PRNGKeyArray, Init, tuple[int, ...] | None], AnyGait]
    recipe: Recipe
    weights: Mapping[str, float] = field(default_factory=dict)
    commands: Commands = ()
    aims: tuple[AbstractAim, ...] = ()
    parameters: tuple[ParameterAxis, ...] = ()
    ground: Mapping[str, float] = field(default_factory=dict)

    def __post_init__(self):
        """Refuse names that are none or not unique, unknown regions, regions without samples."""
        if not self.regions:
            raise SpecError(
                f"spec {self.name!r}: expected at least one region, found none: name the boxes "
                'that conditions are about, as in regions={"tube": (Box((0.0, 0.0), (1.0, 1.0)),)}'
            )
        names = [condition.name for condition in self.trained_for]
        for what, names_of_kind in (("condition", names), ("region", self.regions)):
            for name in names_of_kind:
                if why := why_no_name(name):
                    raise SpecError(
                        f"spec {self.name!r}: expected a printable name without a slash for each "
                        f"{what}, found {why}; rename it"
                    )
        for name, boxes in self.regions.items():
            for box in boxes:
                if why := box.why_not_of(self.chart_size):
                    raise SpecError(f"region {name!r} of spec {self.name!r}: {why}")
        repeated = sorted({name for name in names if names.count(name) > 1})
        if repeated:
            raise SpecError(
                f"spec {self.name!r}: condition names must differ, found {repeated}: take the old "
                f'one out first, `.without("{repeated[0]}")`, or name the new one otherwise'
            )
        for condition in self.trained_for:
            if condition.region not in self.regions:
                region_names = ", ".join(self.regions)
                raise SpecError(
                    f"condition {condition.name!r}: unknown region {condition.region!r}; "
                    f"the regions of spec {self.name!r} are {region_names}"
                )
            if not condition.scale > 0:
                raise SpecError(
                    f"condition {condition.name!r}: expected scale > 0, found {condition.scale}"
                )
        counts = self.recipe.samples
        missing = sorted({c.region for c in self.trained_for} - set(counts))
        if missing:
            raise SpecError(f"spec {self.name!r}: recipe.samples has no entry for {missing}")
        unknown = sorted(set(counts) - set(self.regions))
        if unknown:
            raise SpecError(f"spec {self.name!r}: recipe.samples names no regions {unknown}")
        empty = sorted(name for name, count in counts.items() if count < 1)
        if empty:
            raise SpecError(f"spec {self.name!r}: expected at least 1 sample in {empty}")
        stray = sorted(set(self.weights) - set(names))
        if stray:
            raise SpecError(f"spec {self.name!r}: weights name no conditions {stray}")

    @property
    def trained_for(self) -> tuple[AbstractCondition, ...]:
        """Return the conditions, then the aims."""
        return (*self.conditions, *self.aims)

    @property
    def chart_size(self) -> int:
        """Number of axes: phase, level, two a command, and one a parameter of the robot."""
        return 2 + 2 * len(self.commands) + len(self.parameters)

    def parted(self, u: Float[Array, " n"]) -> "ChartPoint":
        """Split a chart point into plane, commands and parameters of the robot."""
        end = 2 + 2 * len(self.commands)
        return ChartPoint(u[:2], u[2:end], u[end:])

    def with_conditions(self, *more: AbstractCondition) -> "GaitSpec":
        """Return a copy of the spec with further conditions."""
        return replace(self, conditions=(*self.conditions, *more))

    def without(self, *names: str) -> "GaitSpec":
        """Return a copy of the spec without the named conditions.

        Raises: SpecError on names that it has not.
        """
        unknown = sorted(set(names) - {condition.name for condition in self.conditions})
        if unknown:
            condition_names = [condition.name for condition in self.conditions]
            hints = [hint for name in unknown if (hint := meant(name, condition_names))]
            message = f"spec {self.name!r} has no conditions {unknown}"
            raise SpecError("; ".join((message, *hints)))
        conditions = tuple(c for c in self.conditions if c.name not in names)
        weights = {name: value for name, value in self.weights.items() if name not in names}
        return replace(self, conditions=conditions, weights=weights)

    def describe(self) -> dict[str, Any]:
        """Describe everything about the spec as plain data, which a run saves.

        Conditions and quantities of this package are described in full, by name and numbers; a
        user's own functions by their names alone.
        """
        recipe = asdict(self.recipe)
        # Fields of a recipe that are not described for a spec without commands, on one floor.
        of_commands = "curriculum widened faster_changes corners largest_gradient strip"
        for name in of_commands.split():
            if not recipe[name]:
                del recipe[name]
        described = {
            "name": self.name,
            "recipe": recipe,
            "regions": dict(self.regions),
            "weights": dict(self.weights),
            "conditions": [describe_condition(condition) for condition in self.conditions],
        }
        if self.aims:
            described["aims"] = [describe_condition(aim) for aim in self.aims]
        if self.commands:
            described["commands"] = [asdict(command) for command in self.commands]
        if self.parameters:
            described["parameters"] = [axis._asdict() for axis in self.parameters]
        if self.ground:
            described["ground"] = dict(self.ground)
        return described

    def margins(
        self, gait: Gait, zd: ZeroDynamics, u: Float[Array, " n"]
    ) -> dict[str, Float[Array, "..."]]:
        """Return the margins of all conditions at one chart point, each in its own units."""
        point = zd.point(gait.z(u))
        return {c.name: c.margins(point, gait) for c in self.conditions}
