"""The sets of levels 2 and 3 of a gait: found at points, traced, and laid out for the search."""

from collections.abc import Mapping
from dataclasses import dataclass, field

import jax.numpy as jnp
import numpy as np
from numpy.polynomial.chebyshev import chebval

from neuralgaits._types import Array, Float
from neuralgaits.barriers import Gait, GaitSpec
from neuralgaits.certificate.levels.chart import PLAIN, Chart, Corner
from neuralgaits.certificate.levels.ladder import LEVELS, labelled_premises
from neuralgaits.certificate.levels.level import Parameters
from neuralgaits.certificate.levels.orbit import margins as orbit_set
from neuralgaits.certificate.levels.orbit import return_map
from neuralgaits.certificate.levels.orbit.find import Fences, Look, find_orbit
from neuralgaits.certificate.levels.orbit.theorem import Orbit
from neuralgaits.certificate.levels.walking_set import margins as walking_set
from neuralgaits.certificate.levels.walking_set.find import find_set
from neuralgaits.certificate.levels.walking_set.theorem import SET, WalkingSet
from neuralgaits.certificate.search.branch_and_bound import Confirm
from neuralgaits.certificate.search.problem import Problem
from neuralgaits.gait import Residuals, ZeroDynamics
from neuralgaits.programs import POINT, Program, evaluate, fold
from neuralgaits.programs.prune import prune
from neuralgaits.programs.tracing.tracer import trace
from neuralgaits.records.certified import Counterexample
from neuralgaits.robots import PlanarBiped

CLAIMED = 0.4
"""Share of the margin that is claimed where its size does not matter: fewer boxes to check."""
NO_RESIDUALS = Residuals()


@dataclass(frozen=True)
class Sets:
    """What levels 2 and 3 are about.

    Attributes:
        walking: the walking set; None if none was looked for or found.
        orbit: thin tube and bounds; likewise.
        reason: why one that was looked for was not found.
        least: what outputs that enclose constants must reach, to be proved; 0 for the others.
    """

    walking: WalkingSet | None = None
    orbit: Orbit | None = None
    reason: str | None = None
    least: Mapping[str, float] = field(default_factory=dict)

    @property
    def parameters(self) -> Parameters:
        """Of the levels whose sets were found."""
        known = {2: self.walking, 3: self.orbit}
        return {number: part for number, part in known.items() if part is not None}


def find_sets(
    spec: GaitSpec,
    gait: Gait,
    zd: ZeroDynamics,
    level: int,
    disturbance: tuple[float, float],
) -> Sets:
    """Look for the sets that a level speaks of. Raises: SpecError if nothing can be traced."""
    if level < 2:
        return Sets()
    look = look_at(gait, zd)
    walking = find_set(spec, look, disturbance)
    if isinstance(walking, str):
        return Sets(reason=walking)
    least = {"set/reset-phase": -walking.start_strip}
    if level < 3:
        return Sets(walking, least=least)
    found = find_orbit(look, fences_of(gait), float(gait.tube.unit), walking)
    if isinstance(found, str):
        return Sets(walking, reason=found, least=least)
    return Sets(walking, found.orbit, least=least | dict(found.least))


def look_at(gait: Gait, zd: ZeroDynamics) -> Look:
    """What the finders look at, as a function of chart points. Raises: SpecError."""
    program = trace(lambda u: _quantities(gait, zd, u), {"u": (2,)}, parameters=gait)
    folded = fold(program, POINT)

    def look(u: np.ndarray) -> dict[str, np.ndarray]:
        with np.errstate(all="ignore"):
            return evaluate(program, {"u": u}, POINT, folded)

    return look


def fences_of(gait: Gait) -> Fences:
    """The fences of a gait's tube as a function of phases."""
    series = [np.asarray(side) for side in (gait.tube.lower, gait.tube.upper)]

    def fences(phases: np.ndarray) -> np.ndarray:
        return np.stack([chebval(2.0 * phases - 1.0, side) for side in series], axis=1)

    return fences


def _quantities(gait: Gait, zd: ZeroDynamics, u: Float[Array, "2"]) -> dict[str, Array]:
    """Flow, swing foot, reset and how trajectories part, at one chart point."""
    point, landed = zd.point(gait.z(u)), return_map.landing(gait, zd, u)
    start, guard = gait.span
    return {
        "foot": point.foot_above_ground,
        "foot_rate": point.foot_velocity[1],
        "pace": point.dz[0] / (guard - start),
        "slope": return_map.slope(gait, point),
        "expansion": return_map.expansion(gait, zd, u),
        "after": jnp.stack([landed.phase, landed.zeta]),
        "gain": landed.gain,
    }


def trace_certificate(
    spec: GaitSpec,
    robot: PlanarBiped,
    gait: Gait,
    sets: Sets,
    residuals: Residuals = NO_RESIDUALS,
) -> Program:
    """Margins of the spec's conditions and of the sets, as one Program of the chart point u.

    Raises: SpecError naming the operation and line that cannot be traced.
    """
    zd = ZeroDynamics(robot, gait.policy, *residuals)

    def margins(u):
        return spec.margins(gait, zd, u) | set_margins(spec, gait, zd, sets, u)

    parameters = {"policy": gait.policy, "tube": gait.tube}
    return trace(margins, {"u": (2,)}, parameters=parameters | _named(sets))


def _named(sets: Sets) -> dict[str, dict[str, np.ndarray]]:
    """Parameters of the sets under the names that constants of the Program get."""
    known = sets.parameters
    return {
        level.part: {
            name: np.array(value) for name, value in level.constants(known[level.number]).items()
        }
        for level in LEVELS
        if level.number in known
    }


def set_margins(
    spec: GaitSpec, gait: Gait, zd: ZeroDynamics, sets: Sets, u: Float[Array, "2"]
) -> dict[str, Float[Array, "..."]]:
    """Margins of the sets at one chart point, by output name."""
    found = {}
    if sets.walking is not None:
        found |= walking_set.margins(spec, gait, zd, sets.walking, u)
    if sets.orbit is not None:
        found |= orbit_set.margins(gait, zd, sets.orbit, u)
    return found


def condition_boxes(spec: GaitSpec) -> list[tuple[str, Corner, Corner]]:
    """Every box of every condition of the spec, by condition name."""
    return [
        (condition.name, box.low, box.high)
        for condition in spec.conditions
        for box in spec.regions[condition.region]
    ]


def condition_problems(spec: GaitSpec, program: Program, chart: Chart = PLAIN) -> list[Problem]:
    """One for each box of each region that has conditions."""
    problems = []
    for region, boxes in spec.regions.items():
        conditions = [c for c in spec.conditions if c.region == region]
        names = tuple(condition.name for condition in conditions)
        scales = tuple(float(condition.scale) for condition in conditions)
        part = prune(program, names) if names else program
        problems += [
            Problem(region, *chart.whole(box.low, box.high), names, scales, part)
            for box in boxes
            if names
        ]
    return problems


def confirmer(spec: GaitSpec, gait: Gait, zd: ZeroDynamics, sets: Sets) -> Confirm:
    """Asks the margins' own Python functions, in float64, about one point."""
    conditions = {condition.name: condition for condition in spec.conditions}

    def confirm(name: str, u: np.ndarray) -> Counterexample | None:
        z = gait.z(u)
        if name in conditions:
            condition = conditions[name]
            margin = np.min(condition.margins(gait, zd, zd.point(z))) / condition.scale
        else:
            margin = np.min(set_margins(spec, gait, zd, sets, jnp.asarray(u))[name])
        if not margin < 0.0:
            return None
        state = (float(z[0]), float(z[1]))
        return Counterexample((float(u[0]), float(u[1])), state, float(margin))

    return confirm


def premise_problems(
    spec: GaitSpec, sets: Sets, program: Program, chart: Chart = PLAIN
) -> list[Problem]:
    """Root boxes of levels 2 and 3 with what must hold on each."""
    scales = {condition.name: float(condition.scale) for condition in spec.conditions}
    roots: dict[tuple[str, Corner, Corner], list[str]] = {}
    found = labelled_premises(sets.parameters, condition_boxes(spec))
    for region, name, low, high in found:
        names = roots.setdefault((region, low, high), [])
        if name not in names:
            names.append(name)
    return [
        Problem(
            region,
            *chart.whole(low, high),
            tuple(names),
            tuple(scales.get(name, 1.0) for name in names),
            prune(program, names),
            least=tuple(sets.least.get(name, 0.0) for name in names),
            claimed=Problem.claimed if region == SET else CLAIMED,
            tight=Problem.tight if region == SET else 0.0,
        )
        for (region, low, high), names in roots.items()
    ]
