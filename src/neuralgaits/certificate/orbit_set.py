"""The periodic orbit and its attraction: margins of a thin tube and of the return map (level 3).

Bounds on the expansion of trajectories are Chebyshev series over the phase, whose integral over
a step is exact, so no slice of a step has to be summed. A thin tube around the orbit is
invariant like the walking set; the fixed point is in it.
"""

import jax.numpy as jnp
import numpy as np

from neuralgaits._types import Array, Float, Scalar
from neuralgaits.barriers import Gait, Tube
from neuralgaits.barriers.regions import chebyshev
from neuralgaits.certificate.return_map import expansion, landing, slope
from neuralgaits.certificate.theorems import Orbit
from neuralgaits.gait import ZeroDynamics


def thin_gait(gait: Gait, orbit: Orbit) -> Gait:
    """The gait with the thin tube around its orbit."""
    tube = Tube(
        np.array(orbit.lower),
        np.array(orbit.upper),
        np.array(orbit.unit),
        gait.tube.span,
        False,
    )
    return Gait(gait.policy, tube)


def margins(
    gait: Gait, zd: ZeroDynamics, orbit: Orbit, u: Float[Array, "2"]
) -> dict[str, Float[Array, "..."]]:
    """Margins at one point, of the walking set's chart or of the thin tube's.

    Outputs of the return map over the whole set are functions of u in the set's chart; those of
    the orbit take u in the chart of the thin tube.
    """
    thin = thin_gait(gait, orbit)
    wide_gain = landing(gait, zd, u).gain
    point = zd.point(thin.z(u))
    low, high = thin.tube.fences(u[0])
    low_slope, high_slope = thin.tube.fence_slopes(u[0])
    along = slope(thin, point)
    ends = jnp.stack([gait.level(point.z)])
    z_low, z_high = jnp.sqrt(2.0 * low), jnp.sqrt(2.0 * high)
    parting = expansion(thin, zd, u)
    reset = landing(thin, zd, u)
    level = thin.level(point.z_after)
    return {
        "orbit/expansion": _series(orbit.expansion, u[0]) - expansion(gait, zd, u),
        "orbit/gain": jnp.stack([wide_gain, -wide_gain]),
        "orbit/fence-lower": (along - low_slope) / (high - low),
        "orbit/fence-upper": (high_slope - along) / (high - low),
        "orbit/reset-level": jnp.stack([level, 1.0 - level]),
        "orbit/inside": jnp.concatenate([ends, 1.0 - ends]),
        "orbit/width": z_low - z_high,
        "orbit/slowest": parting - _series(orbit.slowest, u[0]),
        "orbit/fastest": _series(orbit.fastest, u[0]) - parting,
        "orbit/reset-gain-low": reset.gain,
        "orbit/reset-gain-high": -reset.gain,
    }


def _series(coefficients: tuple[float, ...], phase: Scalar) -> Scalar:
    return np.array(coefficients) @ chebyshev(2.0 * phase - 1.0, len(coefficients))
