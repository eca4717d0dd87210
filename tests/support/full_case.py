"""Level 4 of a checker case: its outputs, for a set and constants around nothing in particular."""

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from neuralgaits.barriers import Gait
from neuralgaits.certificate.levels.full_order.model import FullOrderModel
from neuralgaits.certificate.levels.full_order.theorem import BarrierConstants, FullOrderConstants
from neuralgaits.certificate.levels.level_search import LevelSets
from neuralgaits.programs import POINT, evaluate
from support.checker_case import SetCase

NARROW, WIDE = 1e-7, 3e-3
"""Radii of the ball of outputs [rad]."""


@dataclass(frozen=True)
class FullCase(SetCase):
    """The outputs of levels 1 and 4, for a set and constants around nothing in particular.

    Attributes:
        radius: of the outputs, in the step and at the guard [rad].
    """

    radius: float = NARROW

    @cached_property
    def full_model(self) -> FullOrderModel:
        assert isinstance(self.gait, Gait)
        return FullOrderModel(self.robot, self.gait, self.spec)

    @cached_property
    def shape(self) -> FullOrderConstants:
        draw = np.random.default_rng(9)
        rows = tuple(
            BarrierConstants(name, *draw.uniform(0.5, 2.0, size=7).tolist())
            for name in self.full_model.names
        )
        inertia, mismatch, drift, gain, landing, slope = draw.uniform(0.5, 2.0, size=6).tolist()
        return FullOrderConstants(
            bandwidth=30.0,
            radius=self.radius,
            shrink=0.5,
            guard_radius=self.radius,
            start_strip=0.003,
            guard_strip=0.002,
            crossing=0.001,
            risen=0.06,
            pace=(0.9, 3.0),
            inertia=inertia,
            mismatch=mismatch,
            drift=drift,
            gain=gain,
            landing=landing,
            landing_slope=slope,
            barriers=rows,
        )

    @cached_property
    def sets(self) -> LevelSets:
        return LevelSets({4: self.shape})

    @cached_property
    def table(self) -> dict[str, Any]:
        found = super().table
        (claim,) = found["statements"]
        change = {"conditions": ["full/pace"], "region": "full order"}
        change |= {"scales": {"full/pace": 1.0}, "bounds": {"full/pace": -9.0}}
        return found | {"statements": [claim | change]}

    def values(self, u: np.ndarray, xi: np.ndarray | None = None) -> dict[str, np.ndarray]:
        """At points of the chart and of the unit ball, its centre if none are given."""
        xi = np.zeros((len(u), self.full_model.size)) if xi is None else xi
        values = evaluate(self.program, {"u": u, "xi": xi}, POINT)
        return {name: value.reshape(len(value), -1) for name, value in values.items()}


def in_the_ball(draw, count: int, size: int) -> np.ndarray:
    """Points of the unit ball, half of them on its surface."""
    found = draw.normal(size=(count, size))
    found /= np.linalg.norm(found, axis=1, keepdims=True)
    return found * np.where(np.arange(count) % 2, draw.uniform(size=count), 1.0)[:, None]
