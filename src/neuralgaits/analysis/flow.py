"""The hybrid zero dynamics of many states at once, in NumPy: without compiling anything.

The hip moves forward in a step, so z1 stands for time: d z2 / d z1 = dz2 / dz1. That makes the
section a fixed line, and a batch keeps in step. A state whose hip stops has no step: NaN.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from neuralgaits._types import Bool, Float

Motion = Callable[[np.ndarray], dict[str, np.ndarray]]
"""z [N, 2] to "dz" [N, 2] (m/s, N m), "foot" [N, 2] (m) and "z_after" [N, 2]."""

STEPS = 60
"""Fourth-order steps over the usual length of a step: errors near 1e-8 of z2."""
BEHIND = 0.3
"""A foot that has not landed this far behind the usual guard does not, in lengths of a step."""
SLOWEST_M_S = 1e-3
"""A hip slower than this has stopped [m/s]."""
SECANT_STEPS = 12
"""That find where the foot meets the ground within one step: bracketed, to rounding."""


class Swing(NamedTuple):
    """Stance phases up to the guard. K nodes, N states."""

    z: Float[np.ndarray, "K N 2"]
    """States; those behind the guard stay on it (m, kg m^2/s)."""
    t: Float[np.ndarray, "K N"]
    """Time since the start [s]."""
    landed: Bool[np.ndarray, " N"]
    """Whether the guard was met; the last node is NaN else."""


class Returns(NamedTuple):
    """The Poincare map of the section z1 = 0. NaN where a state does not come back."""

    z2: Float[np.ndarray, " N"]
    """At the section one step later [kg m^2/s]."""
    duration: Float[np.ndarray, " N"]
    """Of the step [s]."""
    before: Float[np.ndarray, "N 2"]
    """State just before the impact."""
    length: Float[np.ndarray, " N"]
    """Between the feet at impact [m]."""


class Orbit(NamedTuple):
    """A fixed point of the Poincare map; NaN if there is none between the fences."""

    z2: float
    """At the section [kg m^2/s]."""
    multiplier: float
    """Slope of the map there [1]."""
    period_s: float
    """Duration of a step [s]."""
    step_length_m: float
    """Between the feet at impact [m]."""
    before: Float[np.ndarray, "2"]
    """State just before the impact."""


def swing(
    motion: Motion, start: np.ndarray, span: tuple[float, float], steps: int = STEPS
) -> Swing:
    """Flow states to the guard: the swing foot falls through the ground with z1 > 0.

    Args:
        motion: what is known of a state.
        start: all with the same z1. [N, 2]
        span: usual z1 at the start of a step and at the guard [m].
        steps: over the length of the span.
    """
    step = (span[1] - span[0]) / steps
    last = span[1] + BEHIND * (span[1] - span[0])
    z1 = np.array(start[:, 0])
    y = np.stack([start[:, 1], np.zeros(len(start))], axis=1)
    nodes, ended, end = [_join(z1, y)], np.zeros(len(z1), bool), np.full((len(z1), 3), np.nan)
    while not ended.all() and z1[0] < last:
        ahead = _step(motion, z1, y, np.full(len(z1), step))
        foot = _foot(motion, z1 + step, ahead)
        now = ~ended & (foot < 0.0) & (z1 + step > 0.0)
        if now.any():
            end[now] = _landing(motion, z1[now], y[now], step)
            ended |= now
        z1, y = z1 + step, ahead
        ended |= ~np.isfinite(y).all(axis=1)
        nodes.append(np.where(ended[:, None], end, _join(z1, y)))
    path = np.stack(nodes)
    path[-1, ~ended] = np.nan
    return Swing(path[..., :2], path[..., 2], np.isfinite(path[-1, :, 0]))


def to_section(motion: Motion, start: np.ndarray, steps: int = STEPS) -> np.ndarray:
    """Flow states forward to z1 = 0. Returns: z2 and time there. [N, 2] (kg m^2/s, s)."""
    z1, y = np.array(start[:, 0]), np.stack([start[:, 1], np.zeros(len(start))], axis=1)
    count = max(steps // 2, 1)
    step = -z1 / count
    for _ in range(count):
        y = _step(motion, z1, y, step)
        z1 = z1 + step
    return y


def returns(motion: Motion, z2: np.ndarray, span: tuple[float, float]) -> Returns:
    """One application of the Poincare map to many z2. [N]."""
    start = np.stack([np.zeros(len(z2)), z2], axis=1)
    swung = swing(motion, start, span)
    before = swung.z[-1]
    known = motion(before)
    after = to_section(motion, known["z_after"])
    return Returns(after[:, 0], swung.t[-1] + after[:, 1], before, known["foot"][:, 0])


def fixed_point(
    motion: Motion, z2: np.ndarray, mapped: np.ndarray, span: tuple[float, float]
) -> Orbit:
    """The attracting fixed point between samples of the map, polished.

    Args:
        motion: what is known of a state.
        z2: increasing. [N]
        mapped: one step later. [N]
        span: as of `swing`.
    """
    gap = mapped - z2
    found = np.flatnonzero((gap[:-1] >= 0.0) & (gap[1:] < 0.0))
    if not len(found):
        nan = float("nan")
        return Orbit(nan, nan, nan, nan, np.full(2, nan))
    low = found[0]
    share = gap[low] / (gap[low] - gap[low + 1])
    guess = z2[low] + share * (z2[low + 1] - z2[low])
    slope = float("nan")
    for _ in range(3):
        change = 1e-4 * guess
        step = returns(motion, guess + np.array([-change, 0.0, change]), span)
        slope = (step.z2[2] - step.z2[0]) / (2.0 * change)
        moved = (step.z2[1] - guess) / (1.0 - slope)
        guess = guess + moved
        if abs(moved) <= 1e-10 * guess:
            break
    period, length = float(step.duration[1]), float(step.length[1])
    return Orbit(float(guess), float(slope), period, length, step.before[1])


def cycle(motion: Motion, orbit: Orbit, span: tuple[float, float]) -> Swing:
    """One step of an orbit from landing to landing, N = 1; no nodes if there is no orbit."""
    if not np.isfinite(orbit.z2):
        return Swing(np.zeros((0, 1, 2)), np.zeros((0, 1)), np.zeros(1, dtype=bool))
    return swing(motion, motion(orbit.before[None])["z_after"], span)


def _rate(motion: Motion, z1: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Slopes of (z2, t) in z1. [N, 2]."""
    dz = motion(np.stack([z1, y[:, 0]], axis=1))["dz"]
    pace = np.where(dz[:, 0] > SLOWEST_M_S, dz[:, 0], np.nan)
    return np.stack([dz[:, 1] / pace, 1.0 / pace], axis=1)


def _step(motion: Motion, z1: np.ndarray, y: np.ndarray, h: np.ndarray) -> np.ndarray:
    """One step of the classical fourth-order method of Runge and Kutta. [N, 2]."""
    wide = h[:, None]
    first = _rate(motion, z1, y)
    second = _rate(motion, z1 + 0.5 * h, y + 0.5 * wide * first)
    third = _rate(motion, z1 + 0.5 * h, y + 0.5 * wide * second)
    fourth = _rate(motion, z1 + h, y + wide * third)
    return y + wide / 6.0 * (first + 2.0 * second + 2.0 * third + fourth)


def _foot(motion: Motion, z1: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Height of the swing foot [m]. [N]."""
    return motion(np.stack([z1, y[:, 0]], axis=1))["foot"][:, 1]


def _landing(motion: Motion, z1: np.ndarray, y: np.ndarray, step: float) -> np.ndarray:
    """Where the foot meets the ground within one step, by the Illinois method. [N, 3]."""
    low, high = np.zeros(len(z1)), np.full(len(z1), step)
    at_low = np.maximum(_foot(motion, z1, y), 0.0)
    at_high = _foot(motion, z1 + high, _step(motion, z1, y, high))
    for _ in range(SECANT_STEPS):
        fall = at_high - at_low
        share = np.divide(at_high, fall, out=np.zeros_like(fall), where=fall != 0.0)
        middle = high - share * (high - low)
        value = _foot(motion, z1 + middle, _step(motion, z1, y, middle))
        crossed = value * at_high < 0.0
        low, at_low = np.where(crossed, high, low), np.where(crossed, at_high, 0.5 * at_low)
        high, at_high = middle, value
    return _join(z1 + high, _step(motion, z1, y, high))


def _join(z1: np.ndarray, y: np.ndarray) -> np.ndarray:
    return np.concatenate([z1[:, None], y], axis=1)
