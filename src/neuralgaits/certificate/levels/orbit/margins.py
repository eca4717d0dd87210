"""Margins of a thin tube around the orbit and of the return map (level 3).

Bounds on the expansion of trajectories are Chebyshev series over the phase, whose integral over
a step is exact, so no slice of a step has to be summed. A thin tube around the orbit is
invariant like the walking set; the fixed point is in it.
"""

import jax.numpy as jnp
import numpy as np

from neuralgaits._types import Array, Float, Scalar
from neuralgaits.barriers import Gait, Tube
from neuralgaits.certificate.chart import PLANE
from neuralgaits.certificate.levels.orbit.return_map import expansion, landing, slope
from neuralgaits.certificate.levels.orbit.theorem import OrbitConstants
from neuralgaits.gait import ZeroDynamics
from neuralgaits.gait.tubes import chebyshev


def thin_gait(gait: Gait, orbit: OrbitConstants) -> Gait:
    """Return the gait with the thin tube around its orbit."""
    tube = Tube(
        np.array(orbit.lower),
        np.array(orbit.upper),
        np.array(1.0),
        gait.tube.span,
        False,
    )
    return Gait(gait.policy, tube)


def margins(
    gait: Gait, zd: ZeroDynamics, orbit: OrbitConstants, u: Float[Array, " n"]
) -> dict[str, Float[Array, "..."]]:
    """Return margins at one point of the walking set's chart or of the thin tube's.

    Outputs of the return map over the whole set are functions of u in the set's chart; those of
    the orbit take u in the chart of the thin tube.
    """
    if orbit.attraction == "any two walks":
        return _any_two_walks(gait, zd, orbit, u)
    wide_gain = landing(gait, zd, u[:PLANE]).gain
    contracting = {
        "orbit/expansion": _series(orbit.expansion, u[0]) - expansion(gait, zd, u[:PLANE]),
        "orbit/gain": jnp.stack([wide_gain, -wide_gain]),
    }
    if orbit.attraction == "contraction alone":
        return contracting
    thin = thin_gait(gait, orbit)
    point = zd.point(thin.z(u))
    low, high = thin.tube.fences(u[0])
    low_slope, high_slope = thin.tube.fence_slopes(u[0])
    along = slope(thin, point)
    ends = jnp.stack([gait.level(point.z)])
    z_low, z_high = jnp.sqrt(2.0 * low), jnp.sqrt(2.0 * high)
    parting = expansion(thin, zd, u)
    reset = landing(thin, zd, u)
    level = thin.level(point.z_after)
    nested = {}
    if orbit.attraction == "nested tubes":
        nested = {
            "orbit/nested-above": _narrowing(gait, thin, zd, u, 1),
            "orbit/nested-below": _narrowing(gait, thin, zd, u, 0),
        }
    return {
        **nested,
        **contracting,
        "orbit/fence-lower": (along - low_slope) / (high - low),
        "orbit/fence-upper": (high_slope - along) / (high - low),
        "orbit/foot-above": point.foot_above_ground,
        "orbit/foot-below": -point.foot_above_ground,
        "orbit/reset-level": jnp.stack([level, 1.0 - level]),
        "orbit/inside": jnp.concatenate([ends, 1.0 - ends]),
        "orbit/width": z_low - z_high,
        "orbit/slowest": parting - _series(orbit.slowest, u[0]),
        "orbit/fastest": _series(orbit.fastest, u[0]) - parting,
        "orbit/reset-gain-low": reset.gain,
        "orbit/reset-gain-high": -reset.gain,
    }


def _any_two_walks(
    gait: Gait, zd: ZeroDynamics, orbit: OrbitConstants, u: Float[Array, " n"]
) -> dict[str, Float[Array, "..."]]:
    """Return how walks part along a step and across its reset, independent of the next command."""
    u = u[:PLANE]
    landed, (start, guard) = landing(gait, zd, u), gait.span
    along = slope(gait, zd.point(gait.z(u))) / (guard - start)
    return {
        "orbit/expansion": _series(orbit.expansion, u[0]) - expansion(gait, zd, u),
        "orbit/gain": jnp.stack([landed.moved_zeta, -landed.moved_zeta]),
        "orbit/moved": jnp.stack([landed.moved_z1, -landed.moved_z1]),
        "orbit/along": jnp.stack([along, -along]),
    }


def _narrowing(gait: Gait, thin: Gait, zd: ZeroDynamics, u: Float[Array, "2"], side: int) -> Scalar:
    """Return the rate at which a trajectory outside the thin tube approaches it, per phase.

    Distance r is measured from the thin tube's middle in its half widths, so {|r| <= s} is a
    tube for every s, each inside the next. u[1] goes from the thin tube's fence to the set's.
    """
    fences, slopes = thin.tube.fences(u[0]), thin.tube.fence_slopes(u[0])
    zeta = fences[side] + u[1] * (gait.tube.fences(u[0])[side] - fences[side])
    middle, middle_slope = 0.5 * (fences[0] + fences[1]), 0.5 * (slopes[0] + slopes[1])
    along = slope(gait, zd.point(gait.state(u[0], zeta)))
    widening = (slopes[1] - slopes[0]) / (fences[1] - fences[0])
    return widening - (along - middle_slope) / (zeta - middle)


def _series(coefficients: tuple[float, ...], phase: Scalar) -> Scalar:
    return np.array(coefficients) @ chebyshev(2.0 * phase - 1.0, len(coefficients))
