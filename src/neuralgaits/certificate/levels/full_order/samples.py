"""Evaluations of a gait at points, which choose the constants of the full-order theorem."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np

from neuralgaits._types import Float
from neuralgaits.certificate.levels.full_order.norm import doubled

Samples = Mapping[str, np.ndarray]
SampleEvaluator = Callable[[Float[np.ndarray, "n 2"], Float[np.ndarray, "n k"]], Samples]
"""Chart points [n, 2] and xi [n, 2m] to quantities [n, k] and their slopes in xi [n, k, 2m]."""


@dataclass(frozen=True)
class SampleEvaluators:
    """Functions that the finder of the full-order theorem evaluates.

    Attributes:
        step: pace, inertia, foot, foot-rate, contact, torque, rate, reading, h, with slopes.
        guard: foot, after, landing, reset, with slopes along the guard;
            fall, foot/slope: those of the foot height in phase and xi; drift: of after in phase.
        size: number of elements of xi.
    """

    step: SampleEvaluator
    guard: SampleEvaluator
    size: int
    pushed: Callable[[Float[np.ndarray, "n 2"]], Samples] | None = None

    def in_norm(self, matrix: np.ndarray) -> "SampleEvaluators":
        """Return these functions with xi and pushes in the norm of S."""
        inverse = np.linalg.inv(matrix)
        back, pushed = doubled(inverse).T, self.pushed

        def seen(look: SampleEvaluator) -> SampleEvaluator:
            return lambda u, xi: in_norm(look(u, xi @ back), matrix)

        def seen_off(u: Float[np.ndarray, "n 2"]) -> Samples:
            assert pushed is not None
            found = dict(pushed(u))
            found |= {n: d @ inverse for n, d in found.items() if n.endswith("/push")}
            found["jerk/slope"] = found["jerk/slope"] @ doubled(inverse)
            for name in ("jerk/slope", "jerk/push"):
                found[name] = matrix @ found[name]
            return found | {"jerk": found["jerk"] @ matrix.T}

        off = None if pushed is None else seen_off
        return replace(self, step=seen(self.step), guard=seen(self.guard), pushed=off)


def grid(phases: np.ndarray, levels: np.ndarray) -> np.ndarray:
    """Return all pairs of these phases and levels. [n, 2]."""
    return np.stack(np.meshgrid(phases, levels, indexing="ij"), axis=-1).reshape(-1, 2)


def sphere(count: int, size: int, radius: float) -> np.ndarray:
    """Return points on the sphere of a radius. [count, size]."""
    draw = np.random.default_rng(0).normal(size=(count, size))
    return radius * draw / np.linalg.norm(draw, axis=1, keepdims=True)


def slope_norms(seen: Samples, name: str) -> np.ndarray:
    """Return the length of the slope of each element. [n, k]."""
    return np.linalg.norm(seen[f"{name}/slope"], axis=2)


def in_norm(samples: Mapping[str, np.ndarray], matrix: np.ndarray) -> dict[str, np.ndarray]:
    """Convert samples from plain coordinates to those of a norm; slopes are in S xi then."""
    both, back = doubled(matrix), doubled(np.linalg.inv(matrix))
    found = dict(samples)
    for name in samples:
        if name.endswith("/slope"):
            found[name] = samples[name] @ back
    for name in ("after", "drift"):
        if name in samples:
            found[name] = samples[name] @ both.T
    if "after/slope" in samples:
        found["after/slope"] = both @ found["after/slope"]
    return found
