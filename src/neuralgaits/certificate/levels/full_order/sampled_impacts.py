"""Impacts at points, and the constants of the full-order theorem that follow from them."""

from dataclasses import dataclass

import numpy as np

from neuralgaits.certificate.level_target import grid
from neuralgaits.certificate.levels.full_order.norm_plans import Plan
from neuralgaits.certificate.levels.full_order.samples import (
    SampleEvaluators,
    Samples,
    slope_norms,
    sphere,
)

MARGIN = 1.08
"""Factor of a constant over the values seen at points."""
AMPLE = 1.3
"""Factor for an impact: the theorem has room there, and bounds cost the most."""
CROSSINGS = (1e-9, 1e-8, 1e-7, 1e-5, 1e-4, 3e-4, 1e-3, 3e-3, 6e-3, 0.01, 0.02, 0.03)
"""Half widths tried around the crossing of the guard at eta = 0, in phases."""


@dataclass(frozen=True)
class SampledImpacts:
    """Impacts from eta = 0 on phase 1 and around it, and from outputs on the rim of the set."""

    line: Samples
    """At phase 1 and xi = 0."""
    crossing: Samples
    """At xi = 0, around phase 1."""
    rim: Samples
    """At outputs on the rim of the set, in the guard's strip."""
    ample: float
    """Factor of slopes over the values seen."""

    @classmethod
    def sample(
        cls,
        evaluators: SampleEvaluators,
        levels: np.ndarray,
        crossing: float,
        strip: float,
        radius: float,
        plan: Plan | None,
    ) -> "SampledImpacts":
        """Evaluate impacts around phase 1.

        Args:
            evaluators: functions that evaluate the gait.
            levels: levels of the tube.
            crossing: half width of the strip in which outputs of zero cross the guard [phases].
            strip: that of all outputs in the set [phases].
            radius: bound on sqrt(V) there [rad].
            plan: norm and factors, if these are given.
        """
        line = grid(np.array([1.0]), levels)
        near = grid(np.linspace(1.0 - crossing, 1.0 + crossing, 3), levels)
        edge = grid(np.linspace(1.0 - strip, 1.0 + strip, 5), levels)
        return cls(
            evaluators.guard(line, np.zeros((len(line), evaluators.size))),
            evaluators.guard(near, np.zeros((len(near), evaluators.size))),
            evaluators.guard(edge, sphere(len(edge), evaluators.size, radius)),
            AMPLE if plan is None else plan.planned.impact,
        )

    @property
    def mismatch(self) -> float:
        """Largest sqrt(V) after an impact on the line, with room [rad]."""
        rounding = 1e-6  # Most that float64 bounds lose at an impact [rad].
        return MARGIN * float(np.linalg.norm(self.line["after"], axis=1).max()) + rounding

    @property
    def drift(self) -> float:
        """Largest slope of xi after an impact in the phase, around the crossing."""
        return AMPLE * float(np.linalg.norm(self.crossing["drift"], axis=1).max())

    @property
    def gain(self) -> float:
        """Largest slope of xi after an impact in xi, on the rim: Frobenius norm."""
        squares = (self.rim["after/slope"] ** 2).sum(axis=(1, 2))
        return self.ample * float(np.sqrt(squares.max()))

    @property
    def landing(self) -> float:
        """Farthest a step starts from phase 0, for outputs of zero."""
        return 1.5 * float(np.abs(self.crossing["landing"]).max()) + CROSSINGS[0]

    @property
    def landing_slope(self) -> float:
        """Largest slope of that in xi, on the rim."""
        return AMPLE * float(slope_norms(self.rim, "landing").max())

    def landing_at(self, radius: float) -> float:
        """Return the bound on the landing for outputs of this size."""
        return self.landing + self.landing_slope * radius

    @property
    def constants(self) -> dict[str, float]:
        """All five, by their names in `FullOrderConstants`."""
        return {
            "mismatch": self.mismatch,
            "drift": self.drift,
            "gain": self.gain,
            "landing": self.landing,
            "landing_slope": self.landing_slope,
        }
