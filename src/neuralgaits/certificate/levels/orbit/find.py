"""Find the periodic orbit and bounds around it, as Chebyshev series, in plain numbers.

zeta(phase) solves a fixed-point equation: integrate F along the curve, reset at the guard, start
again there. The iteration contracts, because the flow is weak in zeta and the orbit attracts.
Nothing here is trusted: a bad series makes a premise fail, not a false one hold.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.polynomial import chebyshev

from neuralgaits._types import Float
from neuralgaits.certificate.level_target import grid
from neuralgaits.certificate.levels.orbit.phase_series import (
    antiderivative,
    coefficients,
    fitted,
    over_a_step,
    series_above,
    values_at,
)
from neuralgaits.certificate.levels.orbit.theorem import Attraction, OrbitConstants
from neuralgaits.certificate.levels.walking_set.find import CLEAR, STRIPS, Evaluator
from neuralgaits.certificate.levels.walking_set.theorem import WalkingSetConstants

Fences = Callable[[np.ndarray], Float[np.ndarray, "n 2"]]
"""Function from phases to zeta on both fences, in the tube's unit."""

BOUND_DEGREE = 12
"""Degree of the series that bound dF/dzeta."""
Z2_WIDTH = 1e-3
"""Width to which the orbit is enclosed [kg m^2/s]."""
THIN_ROOM = 0.02
"""Slack of a bound on dF/dzeta over the thin tube [1/phase]."""
COMFORT = 0.95
"""Largest contraction seen at points that leaves room for a bound on it."""


@dataclass(frozen=True, eq=False)
class ChartFlow:
    """The flow on a gait's chart, in the tube's unit of zeta.

    Attributes:
        evaluate: function from points to quantities.
        fences: zeta on both fences, as a function of phases.
        unit: unit of zeta [(kg m^2/s)^2].
    """

    evaluate: Evaluator
    fences: Fences
    unit: float

    def points(self, series: np.ndarray, phases: np.ndarray) -> Float[np.ndarray, "n 2"]:
        """Return chart points of a curve, a series of zeta, at some phases. [n, 2]."""
        low, high = self.fences(phases).T
        levels = (values_at(series, phases) - low) / (high - low)
        return np.stack([phases, levels], axis=1)

    def slope(self, points: Float[np.ndarray, "n 2"]) -> Float[np.ndarray, " n"]:
        """Return F = d zeta / d phase at chart points. [n]."""
        return self.evaluate(points)["slope"] / self.unit


class OrbitProposal(NamedTuple):
    """An orbit to be proved.

    Attributes:
        orbit: thin tube and series.
        least: what the outputs that enclose constants must reach.
    """

    orbit: OrbitConstants
    least: Mapping[str, float]


def find_orbit(flow: ChartFlow, walking: WalkingSetConstants) -> OrbitProposal | str:
    """Return a thin tube and bounds, or a sentence with the reason why there are none.

    Args:
        flow: flow of the gait.
        walking: parameters of the walking set.
    """
    # Largest defect of the series in dzeta/dphase = F, as a share of the thin tube's slack.
    largest_defect = 0.1
    for degree in (18, 24, 30, 36):
        orbit = _periodic(flow, _nodes(walking, degree), degree)
        if orbit is None:
            return "no periodic orbit was found in the tube"
        thin = _thin(flow, walking, orbit)
        if isinstance(thin, str):
            return thin
        if _defect(flow, orbit, walking) < largest_defect * thin.spare:
            break
    nodes = _nodes(walking, degree)
    parting = flow.evaluate(flow.points(orbit.series, nodes))["expansion"]
    width = fitted(nodes, thin.half, degree)
    middle = fitted(nodes, parting, BOUND_DEGREE)
    error = THIN_ROOM + np.max(np.abs(parting - values_at(middle, nodes)))
    shift = np.eye(1, BOUND_DEGREE + 1)[0] * error
    curves = [orbit.series - width, orbit.series, orbit.series + width]
    constants = OrbitConstants(
        thin.attraction,
        *_crossing(flow, curves, float(orbit.guard[0, 0])),
        lower=coefficients(flow.unit * curves[0]),
        upper=coefficients(flow.unit * curves[-1]),
        expansion=coefficients(thin.bound),
        slowest=coefficients(middle - shift),
        fastest=coefficients(middle + shift),
    )
    gain = float(flow.evaluate(orbit.guard)["gain"][0])
    least = {
        "orbit/gain": -thin.largest,
        "orbit/width": -Z2_WIDTH,
        "orbit/reset-gain-low": gain - 0.5 * THIN_ROOM * abs(gain),
        "orbit/reset-gain-high": -gain - 0.5 * THIN_ROOM * abs(gain),
    }
    return OrbitProposal(constants, least)


def find_contraction(evaluate: Evaluator, walking: WalkingSetConstants) -> OrbitProposal | str:
    """Return bounds on how walks part, or a sentence with the reason why there are none.

    Args:
        evaluate: function from points of (phase, level) to quantities, for many commands or robots
            at each.
        walking: parameters of the walking set.
    """
    phases, levels = np.linspace(*walking.ends, 61), np.linspace(0.0, 1.0, 5)
    series = series_above(phases, _largest(evaluate, phases, levels), BOUND_DEGREE)
    ends = np.linspace(1.0 - walking.guard_strip, 1.0 + walking.guard_strip, 3)
    guard = evaluate(grid(ends, levels))
    gain = float(np.abs(guard["moved_zeta" if walking.told else "gain"]).max())
    contraction = gain * np.exp(over_a_step(series))
    if not contraction < COMFORT:
        return f"walks do not converge: a step makes {contraction:.4g} of 1 at the worst"
    # Most of what is left is given away, more of it where bounds are hardest to get.
    room = -np.log(contraction)
    series[0] += (0.6 if walking.told else 0.3) * room
    least = {"orbit/gain": -gain * float(np.exp(0.2 * room))}
    if not walking.told:
        alone = OrbitConstants("contraction alone", expansion=coefficients(series))
        return OrbitProposal(alone, least)
    first = evaluate(np.stack([np.zeros_like(levels), levels], axis=1))
    z1_shift = float(np.abs(guard["moved_z1"]).max())
    along = float(np.abs(first["slope"] / first["stride"]).max())
    least |= {
        "orbit/moved": -z1_shift * 2.0 - 0.01 * gain / along,
        "orbit/along": -along * 2.0,
    }
    return OrbitProposal(OrbitConstants("any two walks", expansion=coefficients(series)), least)


class _ThinTube(NamedTuple):
    """Half width of the thin tube at the nodes of its series, and constants of its attraction.

    Attributes:
        half: half width in units of zeta.
        spare: least slack of its fences, zeta in units per phase.
        attraction: see `OrbitConstants`.
        bound: series above dF/dzeta on the walking set.
        largest: number above |rho| on its guard.
    """

    half: np.ndarray
    spare: float
    attraction: Attraction
    bound: np.ndarray
    largest: float


def _thin(flow: ChartFlow, walking: WalkingSetConstants, orbit: "_Orbit") -> _ThinTube | str:
    """Return the thin tube's form: as wide at each phase as neighbours part, and a little more."""
    nodes = _nodes(walking, len(orbit.series) - 1)
    bound, largest = _bounds(flow.evaluate, walking, float(orbit.guard[0, 0]))
    parting = flow.evaluate(flow.points(orbit.series, nodes))["expansion"]
    gain = abs(float(flow.evaluate(orbit.guard)["gain"][0]))
    multiplier = gain * np.exp(over_a_step(fitted(nodes, parting, BOUND_DEGREE)))
    if not multiplier < 1.0:
        return f"the orbit found does not attract: its multiplier is {multiplier:.4g}"
    attraction: Attraction = "contraction"
    rates, product = parting, multiplier
    if largest * np.exp(over_a_step(bound)) >= COMFORT:
        secants = _secants(flow, orbit, nodes)
        further = largest * np.exp(over_a_step(fitted(nodes, secants, BOUND_DEGREE)))
        if further < COMFORT:
            attraction = "nested tubes"
            rates = secants
            product = further
    # Half of the contraction is spent along the step, so that every premise has room.
    room = -0.5 * np.log(product)
    series = fitted(nodes, rates, BOUND_DEGREE)
    room_left = room - np.max(np.abs(values_at(series, nodes) - rates))
    spread = np.exp(values_at(antiderivative(series), nodes) + room * nodes)
    z2 = np.sqrt(2.0 * flow.unit * values_at(orbit.series, nodes))
    # The thin tube is 0.8 of that width where it is widest.
    half = 0.4 * Z2_WIDTH * spread * np.min(z2 / spread) / flow.unit
    return _ThinTube(half, max(room_left, 0.1 * room) * np.min(half), attraction, bound, largest)


def _secants(flow: ChartFlow, orbit: "_Orbit", nodes: np.ndarray) -> np.ndarray:
    """Return the fastest rate, over the levels, at which a trajectory parts from the orbit."""
    on_orbit = flow.points(orbit.series, nodes)
    slope = flow.slope(on_orbit)
    rates = [flow.evaluate(on_orbit)["expansion"]]
    low, high = flow.fences(nodes).T
    for level in np.linspace(0.0, 1.0, 17):
        away = low + level * (high - low) - values_at(orbit.series, nodes)
        points = np.stack([nodes, np.full_like(nodes, level)], axis=1)
        rate = (flow.slope(points) - slope) / away
        rates.append(np.where(np.abs(away) > 0.05 * (high - low), rate, -np.inf))
    return np.max(rates, axis=0)


class _Orbit(NamedTuple):
    """A periodic orbit: series of zeta / unit, and the chart point where it meets the guard."""

    series: np.ndarray
    guard: Float[np.ndarray, "1 2"]


def _crossing(flow: ChartFlow, curves: Sequence[np.ndarray], phase: float) -> tuple[float, float]:
    """Return the phases just before and behind the ground contact of all of some curves."""
    for width in STRIPS:
        before, behind = np.array([phase - width]), np.array([phase + width])
        above = [flow.evaluate(flow.points(curve, before))["foot"][0] for curve in curves]
        below = [flow.evaluate(flow.points(curve, behind))["foot"][0] for curve in curves]
        if min(above) > CLEAR and max(below) < -CLEAR:
            break
    return phase - 2.0 * width, phase + 2.0 * width


def _nodes(walking: WalkingSetConstants, degree: int) -> np.ndarray:
    """Return the phases at which a series is fitted, the strips included."""
    first, last = walking.ends
    return first + 0.5 * (last - first) * (chebyshev.chebpts1(2 * degree + 1) + 1.0)


def _defect(flow: ChartFlow, orbit: _Orbit, walking: WalkingSetConstants) -> float:
    """Return how far a curve is from a solution, at the worst of many phases."""
    phases = np.linspace(*walking.ends, 301)
    slope = flow.slope(flow.points(orbit.series, phases))
    along = 2.0 * chebyshev.chebval(2.0 * phases - 1.0, chebyshev.chebder(orbit.series))
    return float(np.max(np.abs(slope - along)))


def _bounds(
    evaluate: Evaluator, walking: WalkingSetConstants, guard: float
) -> tuple[np.ndarray, float]:
    """Return series above dF/dzeta on the walking set, and a number above |rho| on its guard."""
    levels, phases = np.linspace(0.0, 1.0, 33), np.linspace(*walking.ends, 121)
    room = 0.03  # Slack of the bound on dF/dzeta [1/phase]: less would cost more boxes.
    series = series_above(phases, _largest(evaluate, phases, levels), BOUND_DEGREE, room)
    gains = evaluate(np.stack([np.full_like(levels, guard), levels], axis=1))["gain"]
    return series, float(np.abs(gains).max() * (1.0 + THIN_ROOM))


def _largest(evaluate: Evaluator, phases: np.ndarray, levels: np.ndarray) -> np.ndarray:
    """Return dF/dzeta at some phases, at the worst of some levels."""
    return evaluate(grid(phases, levels))["expansion"].reshape(len(phases), -1).max(axis=1)


def _periodic(flow: ChartFlow, nodes: np.ndarray, degree: int) -> _Orbit | None:
    """Iterate the curve: integrate F along it, reset, start again there, until it stays.

    Where a curve leaves the tube on the way, F is unknown; its value at the fence stands in.
    Whole steps are the quickest; where the flow is strong they go to and fro, and shorter ones
    settle.
    """
    orbits = (_iterated(flow, nodes, degree, share) for share in (1.0, 0.5, 0.2))
    return next((orbit for orbit in orbits if orbit is not None), None)


def _iterated(flow: ChartFlow, nodes: np.ndarray, degree: int, share: float) -> _Orbit | None:
    """Do what `_periodic` does, by this share of each step; None if the curve does not settle."""
    constant = np.eye(1, degree + 1)[0]
    middle = fitted(nodes, np.mean(flow.fences(nodes), axis=1), degree)
    orbit = _Orbit(middle, np.array([[1.0, 0.5]]))
    settled = 1e-12  # Relative change that ends the iteration.
    for _ in range(400):
        crossing = orbit.guard[:, 0]
        points = flow.points(orbit.series, np.concatenate([nodes, crossing]))
        quantities = flow.evaluate(np.clip(points, [-np.inf, 0.0], [np.inf, 1.0]))
        rise = antiderivative(fitted(nodes, quantities["slope"][:-1] / flow.unit, degree - 1))
        phase, zeta = quantities["after"][-1]
        series = rise + constant * (zeta / flow.unit - values_at(rise, np.array([phase]))[0])
        step = quantities["foot"][-1] * quantities["pace"][-1] / quantities["foot_rate"][-1]
        if share < 1.0:
            series = orbit.series + share * (series - orbit.series)
        change = np.max(np.abs(values_at(series, nodes) - values_at(orbit.series, nodes)))
        if not np.isfinite(change):
            return None
        ahead = np.clip(crossing - step, 0.9, 1.05)
        orbit = _Orbit(series, flow.points(series, ahead))
        if change < settled * abs(series[0]) and abs(step) < settled:
            levels = flow.points(series, nodes)[:, 1]
            return orbit if np.all((levels > 0.0) & (levels < 1.0)) else None
    return None
