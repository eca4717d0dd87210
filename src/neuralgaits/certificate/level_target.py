"""Target of the search for a level's set, and the functions that search."""

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from neuralgaits._types import Array, Float
from neuralgaits.barriers import Gait, GaitSpec
from neuralgaits.certificate.level import Parameters
from neuralgaits.gait import ZeroDynamics
from neuralgaits.gait.policies.commanded_gait import AnyGait
from neuralgaits.gait.scheduled_gains import ScheduledGains

Evaluator = Callable[[Float[np.ndarray, "n 2"]], Mapping[str, np.ndarray]]
"""Chart points [n, 2] to quantities by name: "foot" [m], "foot_rate" [m/s], "pace" [1/s], "slope"
d zeta / d phase and its "expansion" d slope / d zeta, "stride" [m], "steepness" of both fences
[n, 2], and of a reset "after" (phase, zeta) [n, 2], "gain", "moved_zeta" and "moved_z1" as
`orbit.return_map.Landing` has them."""
Margins = dict[str, Float[Array, "..."]]
SearchResult = tuple[Any, Mapping[str, float]] | str
"""Parameters of a level, and lower bounds to be proved of outputs that enclose constants; or one
sentence with the reason why there are none."""


@dataclass(frozen=True)
class ControlAssumption:
    """Assumptions of levels 4 and 5 about the controller.

    Attributes:
        bandwidth: double pole of the outputs, for which the largest set is looked for [rad/s];
            None for the usual one, and the usual set.
        free_clock: whether ticks of level 5 may miss touchdowns.
        scheduled: whether level 5 is about scheduled PD, and not about exact linearisation.
        error: bound on |S e| of torques when they are set, at level 5 [rad/s^2].
        state_error: bounds on the error of each angle and of each rate of the state that torques of
            level 5 are computed from (rad, rad/s); None for the true state.
        model_box: errors of the file's masses [1], centres of mass [m] and inertias [1] at level 5;
            None for the file's robot alone.
    """

    bandwidth: float | None = None
    free_clock: bool = False
    scheduled: bool = False
    error: float = 0.0
    state_error: tuple[float, float] | None = None
    model_box: tuple[float, float, float] | None = None


USUAL_CONTROL = ControlAssumption()


@dataclass(frozen=True)
class SearchTarget:
    """A gait under its spec, of which sets are looked for.

    Attributes:
        spec, gait, zd: of a run.
        make_evaluator: makes the function that the finders of levels 2 and 3 evaluate.
        disturbance: bound on what may be added to dz at level 2 (m/s, N m).
        floor: bound on how much higher or lower than meant a foothold may lie [m].
        disturbed: whether the set at full order is to stand a disturbance as well (level 5).
        control: assumptions about the controller at full order.
        shared: objects that the search of a level hands to those above it, by its number.
    """

    spec: GaitSpec
    gait: AnyGait
    zd: ZeroDynamics
    make_evaluator: Callable[[], Evaluator]
    disturbance: tuple[float, float] = (0.0, 0.0)
    floor: float = 0.0
    disturbed: bool = False
    control: ControlAssumption = USUAL_CONTROL
    shared: dict[int, Any] = field(default_factory=dict)

    @cached_property
    def gains(self) -> ScheduledGains | None:
        """Gains of scheduled PD, as arrays of doubles; None if that is not the law."""
        if not self.control.scheduled:
            return None
        assert isinstance(self.gait, Gait)
        traced = ScheduledGains.of(self.zd.robot, self.gait)
        return ScheduledGains(np.asarray(traced.torque), np.asarray(traced.inertia))

    @cached_property
    def evaluate(self) -> Evaluator:
        """Function that the finders of levels 2 and 3 evaluate, made when it is first asked for."""
        return self.make_evaluator()


class PremisePoint(NamedTuple):
    """Point of a gait at which the premises of levels are evaluated.

    Attributes:
        spec, gait, zd: of a run.
        parameters: parameters of all levels, by number of the level.
        u: chart point.
        xi: outputs, a point of the unit ball; None if no set is about outputs off zero.
    """

    spec: GaitSpec
    gait: Gait
    zd: ZeroDynamics
    parameters: Parameters
    u: Array
    xi: Any


class LevelSearch(ABC):
    """Search for the set of a level, and its premises as functions of a gait."""

    @abstractmethod
    def find(self, target: SearchTarget, parameters: Parameters) -> SearchResult:
        """Find the parameters of the level, from those of the levels below.

        Raises: SpecError if something cannot be traced.
        """

    @abstractmethod
    def margins(self, point: PremisePoint) -> Margins:
        """Return the margins of the premises at a point, by output name."""


def grid(phases: np.ndarray, levels: np.ndarray) -> Float[np.ndarray, "n 2"]:
    """Return all points of the chart at these phases and levels, phase by phase. [n, 2]."""
    return np.stack(np.meshgrid(phases, levels, indexing="ij"), axis=-1).reshape(-1, 2)
