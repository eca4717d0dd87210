"""Everything that figures show of a state of a gait, for many states at once."""

from collections.abc import Callable
from typing import Any

import jax
import numpy as np
from numpy.polynomial.chebyshev import chebval

from neuralgaits.barriers import Barrier, Gait, GaitSpec
from neuralgaits.errors import SpecError
from neuralgaits.gait import ZeroDynamics
from neuralgaits.interpreters import POINT, Program, evaluate, fold
from neuralgaits.interpreters.prune import prune
from neuralgaits.interpreters.tracer import trace
from neuralgaits.workflows.run import Run

ENDS = 1e-9
"""Phases and levels this near to an edge of a region are on it."""
Look = Callable[[np.ndarray], dict[str, np.ndarray]]
"""Quantities of many states: z [N, 2] to arrays [N, ...]."""
_OF_MOTION = ("dz", "foot", "z_after")


def looks(run: Run) -> tuple[Look, Look]:
    """Everything that is drawn of a state, and what moves it alone."""
    zd, gait, spec = run.zero_dynamics, run.gait, run.spec
    named = quantities(zd, gait, spec)
    try:
        program = trace(named, {"z": (2,)}, parameters=gait)
    except SpecError:
        # A ReLU has no place in a Program: compiling is slower, and does the same.
        return _compiled(named, None), _compiled(named, _OF_MOTION)
    return _evaluated(program), _evaluated(prune(program, list(_OF_MOTION)))


def _evaluated(program: Program) -> Look:
    folded = fold(program, POINT)
    return lambda z: evaluate(program, {"z": z}, POINT, folded)


def _compiled(named: Callable[[Any], dict[str, Any]], names: tuple[str, ...] | None) -> Look:
    def chosen(z: Any) -> dict[str, Any]:
        found = named(z)
        return found if names is None else {name: found[name] for name in names}

    function = jax.jit(jax.vmap(chosen))
    return lambda z: {name: np.asarray(array) for name, array in function(z).items()}


def quantities(zd: ZeroDynamics, gait: Gait, spec: GaitSpec) -> Callable[[Any], dict[str, Any]]:
    """Everything that is drawn of a state, by name, as a function of z."""

    def named(z: Any) -> dict[str, Any]:
        point = zd.point(z)
        found = {
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
            margins = condition.margins(gait, zd, point)
            found[f"margin/{condition.name}"] = margins / condition.scale
            if isinstance(condition, Barrier):
                found[f"barrier/{condition.name}"] = condition.function(point)
        return found

    return named


class Chart:
    """Fences and regions of a gait in NumPy."""

    def __init__(self, gait: Gait, spec: GaitSpec):
        self.start, self.guard = (float(end) for end in gait.span)
        self.unit = float(gait.tube.unit)
        self.series = [np.asarray(side) for side in (gait.tube.lower, gait.tube.upper)]
        self.spec = spec

    def fences(self, phase: np.ndarray) -> np.ndarray:
        """z2 on both fences [kg m^2/s]. [2, ...]."""
        zeta = [self.unit * chebval(2.0 * phase - 1.0, side) for side in self.series]
        return np.sqrt(2.0 * np.stack(zeta))

    def z(self, phase: np.ndarray, level: np.ndarray) -> np.ndarray:
        """States at chart points. [..., 2]."""
        low, high = 0.5 * self.fences(phase) ** 2
        z1 = self.start + phase * (self.guard - self.start)
        return np.stack([z1, np.sqrt(2.0 * (low + level * (high - low)))], axis=-1)

    def chart(self, z: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Phase and level of states. [...]."""
        phase = (z[..., 0] - self.start) / (self.guard - self.start)
        low, high = 0.5 * self.fences(phase) ** 2
        return phase, (0.5 * z[..., 1] ** 2 - low) / (high - low)

    def margins(self, found: dict[str, np.ndarray], phase: Any, level: Any) -> np.ndarray:
        """Least entry of each condition's margins where it applies, else NaN. [c, ...]."""
        rows = []
        for condition in self.spec.conditions:
            margin = found[f"margin/{condition.name}"]
            least = margin.reshape(*phase.shape, -1).min(axis=-1)
            applies = np.zeros(phase.shape, dtype=bool)
            for box in self.spec.regions[condition.region]:
                inside = np.ones(phase.shape, dtype=bool)
                for value, low, high in zip((phase, level), box.low, box.high, strict=True):
                    inside &= (value >= low - ENDS) & (value <= high + ENDS)
                applies |= inside
            rows.append(np.where(applies, least, np.nan))
        return np.stack(rows)

    def barriers(self, found: dict[str, np.ndarray], shape: tuple[int, ...]) -> np.ndarray:
        """Least value of each barrier function. [b, ...]."""
        names = [c.name for c in self.spec.conditions if isinstance(c, Barrier)]
        rows = [found[f"barrier/{name}"].reshape(*shape, -1).min(axis=-1) for name in names]
        return np.stack(rows) if rows else np.zeros((0, *shape))
