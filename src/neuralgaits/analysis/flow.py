"""The hybrid zero dynamics of many states at once, in NumPy: without compiling anything.

The hip moves forward in a step, so z1 replaces time: d z2 / d z1 = dz2 / dz1. That makes the
section a fixed line, and a batch keeps in step. A state whose hip stops has no step: NaN.

The foot is on the ground at the start of a step too, so the guard only counts while the hip is
ahead of the foot (z1 > 0) and the foot is falling.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from neuralgaits._types import Bool, Float
from neuralgaits.gait.runge_kutta import DOPRI5
from neuralgaits.gait.zero_coordinates import momenta_of, positions_of

Quantity = Callable[[np.ndarray], np.ndarray]
"""Function of states [N, 2] (m, kg m^2/s)."""
STEPS = 60
"""Fifth-order steps over the usual length of a step: errors near 1e-11 of z2."""
GROUND_TOLERANCE_M = 1e-15
"""Distance to the ground below which a foot is on it, to rounding [m]."""


class FlowQuantities(NamedTuple):
    """Functions that make up the flow, kept apart: most of its steps need the rate alone."""

    dz: Quantity
    """Rate of z. [N, 2] (m/s, N m)."""
    foot: Quantity
    """Position of the swing foot ahead of the stance foot and above the ground. [N, 2] (m)."""
    z_after: Quantity
    """State after an impact here. [N, 2] (m, kg m^2/s)."""


class Mesh(NamedTuple):
    """Step of the integration of the flow, and its reach."""

    step: float
    """Step of z1 [m]."""
    last: float
    """Value of z1 beyond which a foot does not land any more [m]."""

    @classmethod
    def of_gait(cls, start: float, guard: float, steps: int = STEPS) -> "Mesh":
        """Return the mesh of a gait whose steps usually go from a start to a guard (m)."""
        late = 0.3  # Lengths of a step behind the usual guard: beyond, a foot does not land.
        return cls((guard - start) / steps, guard + late * (guard - start))

    @classmethod
    def of_leg(cls, length: float) -> "Mesh":
        """Return a mesh for any gait of a robot with legs of this length (m).

        It reaches one leg's length, since a hip that far ahead of the foot is on the ground
        itself.
        """
        step = 0.012 * length  # No usual length of a gait's step is known.
        return cls(step, length)


class Swing(NamedTuple):
    """Stance phases up to the guard. K nodes, N states."""

    z: Float[np.ndarray, "K N 2"]
    """States; those behind the guard stay on it (m, kg m^2/s)."""
    t: Float[np.ndarray, "K N"]
    """Time since the start [s]."""
    landed: Bool[np.ndarray, " N"]
    """Whether the flow reached the guard; if not, the last node is NaN."""


class Returns(NamedTuple):
    """The Poincare map of the section z1 = 0. NaN where a state does not come back."""

    z2: Float[np.ndarray, " N"]
    """Momentum z2 at the section one step later [kg m^2/s]."""
    duration: Float[np.ndarray, " N"]
    """Duration of the step [s]."""
    before: Float[np.ndarray, "N 2"]
    """State just before the impact."""
    length: Float[np.ndarray, " N"]
    """Distance between the feet at impact [m]."""


def swing(motion: FlowQuantities, start: np.ndarray, mesh: Mesh) -> Swing:
    """Follow states to the guard: the swing foot falls through the ground with z1 > 0.

    Args:
        motion: functions that make up the flow.
        start: states with the same z1. [N, 2]
        mesh: mesh of z1.
    """
    y, h = _with_time(start), np.full(len(start), mesh.step)
    nodes = [y]
    finished = np.zeros(len(y), bool)
    end = np.full((len(y), 3), np.nan)
    while not finished.all() and y[0, 0] < mesh.last:
        ahead = _step(motion, y, h)
        # A node on the ground is the landing, on whichever side of it rounding puts the foot.
        now = ~finished & (_foot(motion, ahead) < GROUND_TOLERANCE_M) & (ahead[:, 0] > 0.0)
        if now.any():
            end[now] = _landing(motion, y[now], mesh.step)
            finished |= now
        y = ahead
        finished |= ~np.isfinite(y).all(axis=1)
        nodes.append(np.where(finished[:, None], end, y))
    path = np.stack(nodes)
    path[-1, ~finished] = np.nan
    return Swing(path[..., :2], path[..., 2], np.isfinite(path[-1, :, 0]))


def to_section(motion: FlowQuantities, start: np.ndarray, mesh: Mesh) -> np.ndarray:
    """Flow states forward to z1 = 0. Returns: z1, z2 and time there. [N, 3] (m, kg m^2/s, s)."""
    y = _with_time(start)
    farthest = float(np.max(np.abs(y[:, 0]), initial=0.0, where=np.isfinite(y[:, 0])))
    count = int(np.ceil(farthest / mesh.step))
    h = -y[:, 0] / max(count, 1)
    for _ in range(count):
        y = _step(motion, y, h)
    return y


def returns(motion: FlowQuantities, z2: np.ndarray, mesh: Mesh) -> Returns:
    """Apply the Poincare map once to many z2. [N]."""
    swung = swing(motion, np.stack([np.zeros(len(z2)), z2], axis=1), mesh)
    before = swung.z[-1]
    after = to_section(motion, motion.z_after(before), mesh)
    length = motion.foot(before)[:, 0]
    return Returns(after[:, 1], swung.t[-1] + after[:, 2], before, length)


def _with_time(z: np.ndarray) -> np.ndarray:
    """Return states with the elapsed time, which are integrated together. [N, 3]."""
    return np.column_stack([z, np.zeros(len(z))])


def _rate(motion: FlowQuantities, y: np.ndarray) -> np.ndarray:
    """Return slopes of (z1, z2, t) in z1. [N, 3]."""
    dz = motion.dz(y[:, :2])
    stopped = 1e-3  # Velocity of the hip [m/s].
    pace = np.where(positions_of(dz) > stopped, positions_of(dz), np.nan)
    return np.stack([np.ones(len(y)), momenta_of(dz) / pace, 1.0 / pace], axis=1)


def _step(motion: FlowQuantities, y: np.ndarray, h: np.ndarray) -> np.ndarray:
    """Take one step of length h [N] of the method of Dormand and Prince. [N, 3]."""
    slopes: list[np.ndarray] = []
    for shares in DOPRI5.stages:
        slopes.append(_rate(motion, _ahead(y, h, shares, slopes)))
    return _ahead(y, h, DOPRI5.weights, slopes)


def _ahead(
    y: np.ndarray, h: np.ndarray, shares: np.ndarray, slopes: list[np.ndarray]
) -> np.ndarray:
    """Return the states after a step h [N] along shares [s] of the slopes known so far. [N, 3]."""
    pairs = zip(shares, slopes, strict=False)
    return y + h[:, None] * sum(share * slope for share, slope in pairs if share)


def _foot(motion: FlowQuantities, y: np.ndarray) -> np.ndarray:
    """Return the height of the swing foot [m]. [N]."""
    return motion.foot(y[:, :2])[:, 1]


def _landing(motion: FlowQuantities, y: np.ndarray, step: float) -> np.ndarray:
    """Find the foot's contact within one step by the Illinois method. [N, 3]."""
    low, high = np.zeros(len(y)), np.full(len(y), step)
    at_low = np.maximum(_foot(motion, y), 0.0)
    at_high = _foot(motion, _step(motion, y, high))
    # Bracketed secant steps to the foot's contact within one step.
    for _ in range(12):
        fall = at_high - at_low
        share = np.divide(at_high, fall, out=np.zeros_like(fall), where=fall != 0.0)
        middle = high - share * (high - low)
        value = _foot(motion, _step(motion, y, middle))
        crossed = value * at_high < 0.0
        low, at_low = np.where(crossed, high, low), np.where(crossed, at_high, 0.5 * at_low)
        high, at_high = middle, value
        if np.all(np.abs(value) < GROUND_TOLERANCE_M):
            break
    return _step(motion, y, high)
