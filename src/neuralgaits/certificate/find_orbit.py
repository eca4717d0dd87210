"""The periodic orbit and bounds around it, as Chebyshev series, found in plain numbers.

zeta(phase) solves a fixed-point equation: integrate F along the curve, reset at the guard,
start again there. It contracts, for the flow is weak in zeta and the orbit attracts. Nothing here
is trusted: a bad series makes a premise fail, not a false one hold.
"""

from collections.abc import Callable, Mapping
from typing import NamedTuple

import numpy as np
from numpy.polynomial import chebyshev

from neuralgaits._types import Float
from neuralgaits.certificate.theorems import Orbit, WalkingSet

Look = Callable[[Float[np.ndarray, "n 2"]], Mapping[str, np.ndarray]]
"""Points (phase, level) [n, 2] to slope and expansion, foot, foot_rate, pace, after and gain."""
Fences = Callable[[np.ndarray], Float[np.ndarray, "n 2"]]
"""Phases to zeta on both fences, in the tube's unit."""

DEGREE = 18
"""Of the series of the orbit; its slope is then good to about 1e-6."""
BOUND_DEGREE = 12
"""Of the series that bound dF/dzeta."""
ROUNDS, SETTLED = 400, 1e-12
"""Iterations of the fixed point, and the relative change that ends them."""
Z2_WIDTH = 1e-3
"""Width to which the orbit is enclosed [kg m^2/s]."""
USED = 0.8
"""Share of that width that the thin tube uses where it is widest."""
ROOM = 0.03
"""Slack of a bound on dF/dzeta over the whole set [1/phase]: less would cost more boxes."""
THIN_ROOM = 0.02
"""The same over the thin tube."""


class Found(NamedTuple):
    """An orbit to be proved.

    Attributes:
        orbit: thin tube and series.
        least: what the outputs that enclose constants must reach.
    """

    orbit: Orbit
    least: Mapping[str, float]


def find_orbit(look: Look, fences: Fences, unit: float, shape: WalkingSet) -> Found | str:
    """Thin tube and bounds, or one sentence that says why there are none.

    Args:
        look: quantities at points.
        fences: of the walking set.
        unit: of zeta [(kg m^2/s)^2].
        shape: of the walking set.
    """
    nodes = 0.5 * (chebyshev.chebpts1(2 * DEGREE + 1) + 1.0)
    curve = _periodic(look, fences, unit, nodes)
    if curve is None:
        return "no periodic orbit was found in the tube"
    series, guard = curve

    def on_orbit(phases: np.ndarray) -> np.ndarray:
        return np.stack([phases, _level(fences, phases, _at(series, phases))], axis=1)

    parting = look(on_orbit(nodes))["expansion"]
    gain = float(look(np.array([guard]))["gain"][0])
    total = _antiderivative(_fit(nodes, parting, BOUND_DEGREE))
    multiplier = abs(gain) * np.exp(_at(total, np.ones(1))[0])
    if not multiplier < 1.0:
        return f"the orbit found does not attract: its multiplier is {multiplier:.4g}"
    # Half of the contraction is spent along the step, so that every premise has room.
    spread = np.exp(_at(total, nodes) - 0.5 * np.log(multiplier) * nodes)
    z2 = np.sqrt(2.0 * unit * _at(series, nodes))
    half = 0.5 * USED * Z2_WIDTH * spread * np.min(z2 / spread) / unit
    width = _fit(nodes, half, DEGREE)
    levels = np.linspace(0.0, 1.0, 33)
    phases = np.linspace(*shape.ends, 121)
    grid = np.stack(np.meshgrid(phases, levels, indexing="ij"), axis=-1)
    largest = look(grid.reshape(-1, 2))["expansion"].reshape(grid.shape[:2]).max(axis=1)
    strip = np.stack([np.full_like(levels, guard[0]), levels], axis=1)
    bound = _fit(phases, largest, BOUND_DEGREE)
    bound[0] += ROOM + np.max(largest - _at(bound, phases))
    middle = _fit(nodes, parting, BOUND_DEGREE)
    error = THIN_ROOM + np.max(np.abs(parting - _at(middle, nodes)))
    shift = np.eye(1, BOUND_DEGREE + 1)[0] * error
    room = 0.5 * THIN_ROOM * abs(gain)
    orbit = Orbit(
        unit=unit,
        lower=_numbers(series - width),
        upper=_numbers(series + width),
        expansion=_numbers(bound),
        slowest=_numbers(middle - shift),
        fastest=_numbers(middle + shift),
    )
    least = {
        "orbit/gain": -float(np.abs(look(strip)["gain"]).max() * (1.0 + THIN_ROOM)),
        "orbit/width": -Z2_WIDTH,
        "orbit/reset-gain-low": gain - room,
        "orbit/reset-gain-high": -gain - room,
    }
    return Found(orbit, least)


def _periodic(
    look: Look, fences: Fences, unit: float, nodes: np.ndarray
) -> tuple[np.ndarray, np.ndarray] | None:
    """Series of zeta / unit on the orbit, and where it meets the guard, as a chart point."""
    start = float(np.mean(fences(np.zeros(1))))
    series = np.eye(1, DEGREE + 1)[0] * start
    crossing = 1.0
    for _ in range(ROUNDS):
        ends = np.array([crossing])
        phases = np.concatenate([nodes, ends])
        found = look(np.stack([phases, _level(fences, phases, _at(series, phases))], axis=1))
        slope = _antiderivative(_fit(nodes, found["slope"][:-1] / unit, DEGREE - 1))
        after_phase, after_zeta = found["after"][-1]
        here = after_zeta / unit - _at(slope, np.array([after_phase]))[0]
        moved = slope + np.eye(1, DEGREE + 1)[0] * here
        change = np.max(np.abs(_at(moved, nodes) - _at(series, nodes)))
        series = moved
        step = found["foot"][-1] * found["pace"][-1] / found["foot_rate"][-1]
        crossing = float(np.clip(crossing - step, 0.9, 1.05))
        if not np.isfinite(change):
            return None
        if change < SETTLED * abs(start) and abs(step) < SETTLED:
            level = _level(fences, np.array([crossing]), _at(series, np.array([crossing])))
            inside = _level(fences, nodes, _at(series, nodes))
            whole = np.all((inside > 0.0) & (inside < 1.0))
            return (series, np.array([crossing, level[0]])) if whole else None
    return None


def _level(fences: Fences, phases: np.ndarray, zeta: np.ndarray) -> np.ndarray:
    low, high = fences(phases).T
    return (zeta - low) / (high - low)


def _fit(phases: np.ndarray, values: np.ndarray, degree: int) -> np.ndarray:
    return chebyshev.chebfit(2.0 * phases - 1.0, values, degree)


def _at(series: np.ndarray, phases: np.ndarray) -> np.ndarray:
    return chebyshev.chebval(2.0 * phases - 1.0, series)


def _antiderivative(series: np.ndarray) -> np.ndarray:
    """Series of the integral from phase 0."""
    return chebyshev.chebint(series, scl=0.5, lbnd=-1.0)


def _numbers(series: np.ndarray) -> tuple[float, ...]:
    return tuple(float(value) for value in series)
