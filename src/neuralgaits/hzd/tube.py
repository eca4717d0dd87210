"""Fit the tube around the orbit of a given gait, as wide as its limits allow.

Where outputs are functions of z1 alone, zeta = z2^2 / 2 grows along a step by the same amount on
every trajectory, and an impact multiplies its distances by the slope of the Poincare map. So fences
that part along a step by the root of that slope have as much slack on the way as at the reset, and
nothing needs to be trained. Source: Westervelt, Grizzle, Koditschek (2003), section V.
"""

from collections.abc import Callable
from dataclasses import replace

import equinox as eqx
import numpy as np
from numpy.polynomial import chebyshev

from neuralgaits._types import Float
from neuralgaits.analysis.point_evaluator import PointEvaluator, quantities
from neuralgaits.barriers import Fence, Gait, GaitSpec, Inlet
from neuralgaits.barriers.hzd import FENCE_DEGREE, empty_tube
from neuralgaits.gait import ZeroDynamics
from neuralgaits.gait.tubes import Tube
from neuralgaits.gait.zero_coordinates import momenta_of, position_of, positions_of
from neuralgaits.hzd.given_orbit import Steady

KEPT = 0.25
"""Share of its margin on the orbit that each condition keeps on the fences."""
PHASES, LEVELS = 121, 9
"""Numbers of phases and levels at which conditions are evaluated."""


def fit_tube(zd: ZeroDynamics, spec: GaitSpec, walk: Steady) -> Tube:
    """Return the widest tube in which conditions that hold on an orbit keep their share of margin.

    Args:
        zd: zero dynamics of a policy of z1 alone.
        spec: the spec `hzd`.
        walk: periodic orbit of the gait.
    """
    start, guard = float(position_of(walk.z[0])), float(position_of(walk.z[-1]))
    bare = empty_tube(zd.robot, (start, guard))
    unit = float(bare.unit)
    phase = (positions_of(walk.z) - start) / (guard - start)
    zeta = 0.5 * momenta_of(walk.z) ** 2 / unit
    middle = chebyshev.chebfit(2.0 * phase - 1.0, zeta, FENCE_DEGREE)
    widening = 1.0 / np.sqrt(walk.multiplier)
    # 1 at phase 0, `widening` at phase 1.
    shape = np.zeros_like(middle)
    shape[:2] = 0.5 * (widening + 1.0), 0.5 * (widening - 1.0)

    def tube(width: float) -> Tube:
        sides = (middle - width * shape, middle + width * shape)
        return eqx.tree_at(lambda t: (t.lower, t.upper), bare, sides)

    # Widest and narrowest half width of the tube, as a share of the orbit's least zeta; the
    # narrowest applies where conditions leave no room for more.
    widest = 0.5
    narrowest = 0.01
    room = _room(zd, spec, tube(float(narrowest * zeta.min())), walk)
    low, high = narrowest * float(zeta.min()), widest * float(zeta.min())
    if room(tube(high)):
        return tube(high)
    for _ in range(24):
        half = 0.5 * (low + high)
        low, high = (half, high) if room(tube(half)) else (low, half)
    return tube(low)


def _room(zd: ZeroDynamics, spec: GaitSpec, any_tube: Tube, walk: Steady) -> Callable[[Tube], bool]:
    """Return whether all conditions that hold on the orbit keep `KEPT` of their margins in a tube.

    Conditions on the fences themselves are left out, because the fences are made for them.
    """
    conditions = tuple(c for c in spec.conditions if not isinstance(c, Fence | Inlet))
    evaluate = PointEvaluator(
        quantities(zd, Gait(zd.policy, any_tube), replace(spec, conditions=conditions))
    )
    places = [
        (c.name, [(box.low[0], box.high[0]) for box in spec.regions[c.region]]) for c in conditions
    ]

    def least(phase: np.ndarray, z: np.ndarray) -> dict[str, float]:
        """Return the smallest margin of each condition on its region, z [N, 2] at phases [N]."""
        values, smallest = evaluate(z), {}
        for name, boxes in places:
            margins = values[f"margin/{name}"].reshape(len(z), -1).min(axis=1)
            inside = np.any([(phase >= low) & (phase <= high) for low, high in boxes], axis=0)
            smallest[name] = float(margins[inside].min())
        return smallest

    start, guard = float(position_of(walk.z[0])), float(position_of(walk.z[-1]))
    orbit = least((positions_of(walk.z) - start) / (guard - start), walk.z)
    needed = {name: KEPT * margin for name, margin in orbit.items() if margin > 0.0}
    phases = np.linspace(0.0, 1.0, PHASES)

    def has_room(tube: Tube) -> bool:
        low, high = _fences(tube, phases)
        level = np.linspace(0.0, 1.0, LEVELS)[:, None]
        z2 = np.sqrt(2.0 * (low + level * (high - low)))
        z1 = np.broadcast_to(start + phases * (guard - start), z2.shape)
        smallest = least(np.tile(phases, LEVELS), np.stack([z1.ravel(), z2.ravel()], axis=1))
        return all(smallest[name] >= margin for name, margin in needed.items())

    return has_room


def _fences(tube: Tube, phases: np.ndarray) -> Float[np.ndarray, "2 n"]:
    """Return zeta on both fences [(kg m^2/s)^2]."""
    sides = (np.asarray(tube.lower), np.asarray(tube.upper))
    return np.stack([float(tube.unit) * chebyshev.chebval(2.0 * phases - 1.0, s) for s in sides])
