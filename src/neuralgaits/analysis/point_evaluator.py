"""Quantities that figures show of the states of a gait, for many states at once."""

from collections.abc import Callable
from typing import Any

import jax
import numpy as np
from numpy.polynomial.chebyshev import chebval

from neuralgaits._quick_jit import quick_jit
from neuralgaits.barriers import Barrier, Gait, GaitSpec
from neuralgaits.errors import SpecError
from neuralgaits.gait import ZeroDynamics
from neuralgaits.gait.zero_coordinates import momenta_of, positions_of
from neuralgaits.programs import POINT, Program, evaluate, fold
from neuralgaits.programs.prune import prune
from neuralgaits.programs.tracing.tracer import trace

ENDS = 1e-9
"""Distance in phase or level within which a point is on the edge of a region."""


class PointEvaluator:
    """Evaluator of quantities of many states: z [N, 2] to arrays [N, ...] by name."""

    def __init__(self, named: Callable[[Any], dict[str, Any]], program: Program | None = None):
        """Trace a function of one z; what cannot be traced is compiled, which takes longer.

        Args:
            named: quantities by name, as a function of z.
            program: Program of the same function, if it is known.
        """
        self._named = named
        try:
            self._program = trace(named, {"z": (2,)}) if program is None else program
        except SpecError:
            # A ReLU has no place in a Program.
            self._program = None
            self._compiled = quick_jit(jax.vmap(named))
        else:
            self._folded = fold(self._program, POINT)

    def __call__(self, z: np.ndarray) -> dict[str, np.ndarray]:
        """Evaluate the quantities at states. [N, 2]."""
        if self._program is not None:
            return evaluate(self._program, {"z": z}, POINT, self._folded)
        return {name: np.asarray(array) for name, array in self._compiled(z).items()}

    def only(self, *names: str) -> "PointEvaluator":
        """Return an evaluator of some of the quantities, which does not compute the rest."""

        def some_quantities(z: Any) -> dict[str, Any]:
            quantities = self._named(z)
            return {name: quantities[name] for name in names}

        return PointEvaluator(
            some_quantities, None if self._program is None else prune(self._program, list(names))
        )

    def each(self, *names: str) -> list[Callable[[np.ndarray], np.ndarray]]:
        """Return a function of states for each of these, computed separately where possible."""

        def alone(name: str) -> Callable[[np.ndarray], np.ndarray]:
            # What has no Program would be compiled once more for each.
            evaluate = self if self._program is None else self.only(name)
            return lambda z: evaluate(z)[name]

        return [alone(name) for name in names]


def quantities(zd: ZeroDynamics, gait: Gait, spec: GaitSpec) -> Callable[[Any], dict[str, Any]]:
    """Return all quantities to draw of a state, by name, as a function of z."""

    def named(z: Any) -> dict[str, Any]:
        point = zd.point(z)
        quantities = {
            "dz": point.dz,
            "nominal_dz": point.nominal_dz,
            "foot": point.foot,
            "foot_velocity": point.foot_velocity,
            "z_after": point.z_after,
            "q": point.q,
            "dq": point.dq,
            "theta": point.theta,
            "torque": point.torque,
            "force": point.force,
        }
        for condition in spec.conditions:
            margins = condition.margins(point, gait)
            quantities[f"margin/{condition.name}"] = margins / condition.scale
            if isinstance(condition, Barrier):
                quantities[f"barrier/{condition.name}"] = condition.function(point)
        return quantities

    return named


class PlaneChart:
    """Fences and regions of a gait in NumPy."""

    def __init__(self, gait: Gait, spec: GaitSpec):
        self.start, self.guard = (float(end) for end in gait.span)
        self.unit = float(gait.tube.unit)
        self.series = [np.asarray(side) for side in (gait.tube.lower, gait.tube.upper)]
        self.spec = spec

    def fences(self, phase: np.ndarray) -> np.ndarray:
        """Return z2 on both fences [kg m^2/s]. [2, ...]."""
        zeta = [self.unit * chebval(2.0 * phase - 1.0, side) for side in self.series]
        return np.sqrt(2.0 * np.stack(zeta))

    def section(self, points: int) -> np.ndarray:
        """Return z2 between the fences at mid-step, z1 = 0 [kg m^2/s]. [points]."""
        low, high = self.fences(np.array(-self.start / (self.guard - self.start)))
        return np.linspace(low, high, points)

    def z(self, phase: np.ndarray, level: np.ndarray) -> np.ndarray:
        """Return the states at chart points. [..., 2]."""
        low, high = 0.5 * self.fences(phase) ** 2
        z1 = self.start + phase * (self.guard - self.start)
        return np.stack([z1, np.sqrt(2.0 * (low + level * (high - low)))], axis=-1)

    def chart(self, z: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the phase and level of states. [...]."""
        phase = (positions_of(z) - self.start) / (self.guard - self.start)
        low, high = 0.5 * self.fences(phase) ** 2
        return phase, (0.5 * momenta_of(z) ** 2 - low) / (high - low)

    def margins(self, values: dict[str, np.ndarray], phase: Any, level: Any) -> np.ndarray:
        """Return each condition's least margin where it applies, else NaN. [c, ...]."""
        rows = []
        for condition in self.spec.conditions:
            least = _least(values[f"margin/{condition.name}"], phase.shape)
            applies = np.zeros(phase.shape, dtype=bool)
            for box in self.spec.regions[condition.region]:
                inside = np.ones(phase.shape, dtype=bool)
                for value, low, high in zip((phase, level), box.low, box.high, strict=True):
                    inside &= (value >= low - ENDS) & (value <= high + ENDS)
                applies |= inside
            rows.append(np.where(applies, least, np.nan))
        return np.stack(rows)

    def barriers(self, values: dict[str, np.ndarray], shape: tuple[int, ...]) -> np.ndarray:
        """Return the least value of each barrier function. [b, ...]."""
        names = [c.name for c in self.spec.conditions if isinstance(c, Barrier)]
        rows = [_least(values[f"barrier/{name}"], shape) for name in names]
        return np.stack(rows) if rows else np.zeros((0, *shape))


def _least(values: np.ndarray, shape: tuple[int, ...]) -> np.ndarray:
    """Return the least entry at each state, in the shape of the states: [N, ...] to [shape]."""
    entries = int(np.prod(values.shape[1:]))
    return values.reshape(*shape, entries).min(axis=-1)
