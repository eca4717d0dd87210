"""Target of the search for a level's set, and the functions that search."""

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
"""Chart points [n, 2] to quantities by name: "foot" [m], "foot_rate" [m/s], "slope", "expansion",
"pace", "gain" and "after" (phase, zeta) [n, 2]."""
Margins = dict[str, Float[Array, "..."]]


@dataclass(frozen=True)
class ControlAssumption:
    """Assumptions of levels 4 and 5 about the controller.

    Attributes:
        bandwidth: double pole of the outputs, for which the largest set is looked for [rad/s];
            None for the usual one, and the usual set.
        free_clock: whether ticks of level 5 may miss touchdowns.
        scheduled: whether level 5 is about scheduled PD, and not about exact linearisation.
    """

    bandwidth: float | None = None
    free_clock: bool = False
    scheduled: bool = False


USUAL_CONTROL = ControlAssumption()


@dataclass(frozen=True)
class SearchTarget:
    """A gait under its spec, of which sets are looked for.

    Attributes:
        spec, gait, zd: of a run.
        evaluator: makes the function that the finders of levels 2 and 3 evaluate.
        disturbance: bound on what may be added to dz at level 2 (m/s, N m).
        floor: bound on how much higher or lower than meant a foothold may lie [m].
        pushed: whether the set at full order is to stand a disturbance as well (level 5).
        control: what is assumed of the controller at full order.
        left: what the search of a level left to those above it, by its number.
    """

    spec: GaitSpec
    gait: AnyGait
    zd: ZeroDynamics
    evaluator: Callable[[], Evaluator]
    disturbance: tuple[float, float] = (0.0, 0.0)
    floor: float = 0.0
    pushed: bool = False
    control: ControlAssumption = USUAL_CONTROL
    left: dict[int, Any] = field(default_factory=dict)

    @cached_property
    def gains(self) -> ScheduledGains | None:
        """Gains of scheduled PD, as arrays of doubles; None if that is not the law."""
        if not self.control.scheduled:
            return None
        assert isinstance(self.gait, Gait)
        found = ScheduledGains.of(self.zd.robot, self.gait)
        return ScheduledGains(np.asarray(found.torque), np.asarray(found.inertia))

    @cached_property
    def look(self) -> Evaluator:
        """Function that the finders of levels 2 and 3 evaluate, made when it is first asked for."""
        return self.evaluator()


class LevelSearch(NamedTuple):
    """Search for the set of a level, and its premises.

    Attributes:
        find: of a subject and the parameters below: parameters, and what outputs that enclose
            constants must reach; or one sentence that says why there are none.
        margins: its premises as functions of all parameters, a chart point and xi of the unit ball.
    """

    find: Callable[[SearchTarget, Parameters], tuple[Any, Mapping[str, float]] | str]
    margins: Callable[[GaitSpec, Gait, ZeroDynamics, Parameters, Array, Array], Margins]
