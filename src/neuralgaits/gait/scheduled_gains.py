"""Feed-forward torque and feedback gains of a gait as polynomials of phase and level.

On the zero dynamics manifold the outputs need the torque u0(z). Off it, to first order,

    u0(z) - M(z) (w^2 y + 2 w dy)

lets them decay as under exact linearisation, M being the inertia that their accelerations feel,
the policy's feedback of z included: M = du/d(ddy), m by m and not symmetric. Both are functions of
z alone, so polynomials fitted to them once replace the mass matrix of every tick.
"""

import math
from dataclasses import dataclass

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from numpy.polynomial.chebyshev import chebvander

from neuralgaits._quick_jit import quick_filter_jit
from neuralgaits._types import Actuated, Array, Float
from neuralgaits.errors import InputError
from neuralgaits.gait.full_order import FullPoint
from neuralgaits.gait.gaits import Gait
from neuralgaits.gait.stepping_robot import SteppingRobot
from neuralgaits.gait.tubes import chebyshev

MARGIN = np.array([0.04, 0.1])
"""How far beyond the tube the polynomials are fitted, in phase and in level."""
DEGREES = {"torque": (16, 8), "inertia": (10, 3)}
"""Degrees in phase and level. They leave 0.004 N m and 0.5 % on AMBER-3M, walking, seed 0."""
EARLIER_DEGREES = ({"torque": (16, 5), "inertia": (8, 2)},)
"""Degrees that proof files from before may have."""
_NODES = (32, 12)
"""Number of Chebyshev points along phase and level that the polynomials are fitted at."""


class ScheduledGains(eqx.Module):
    """Chebyshev series of torque and inertia over phase and level, each mapped to [-1, 1].

    Attributes:
        torque: coefficients of u0 [N m]. [m, 17, 9]
        inertia: coefficients of M [kg m^2]. [m, m, 11, 4]
    """

    torque: Float[Array, "m i j"]
    inertia: Float[Array, "m m k l"]

    @classmethod
    def of(cls, robot: SteppingRobot, gait: Gait) -> "ScheduledGains":
        """Fit a gait's torque and inertia, by least squares with the Chebyshev weight.

        At Chebyshev points the polynomials are orthogonal, so the sums need no linear solve.

        Args:
            robot: the model that torques are for.
            gait: policy and tube, both smooth up to `MARGIN` beyond the tube.
        """
        x, y = (np.cos(np.pi * (np.arange(count) + 0.5) / count) for count in _NODES)
        nodes = np.stack(np.meshgrid(x, y, indexing="ij"), axis=-1).reshape(-1, 2)
        values = torque_and_inertia(robot, gait, 0.5 + (0.5 + MARGIN) * nodes)
        series = {}
        for name, value in zip(DEGREES, values, strict=True):
            along, across = (
                chebvander(points, degree) * ([1.0] + [2.0] * degree) / len(points)
                for points, degree in zip((x, y), DEGREES[name], strict=True)
            )
            grid = np.asarray(value).reshape(*_NODES, *value.shape[1:])
            series[name] = np.einsum("pi,lj,pl...->...ij", along, across, grid)
        return cls(**series)

    @classmethod
    def from_lists(
        cls, torque: Float[Array, " t"], inertia: Float[Array, " k"], m: int
    ) -> "ScheduledGains":
        """Return the gains with these coefficients, whose number tells the degrees.

        Raises: InputError if no degrees have so many.
        """
        for degrees in (DEGREES, *EARLIER_DEGREES):
            sizes = {name: tuple(n + 1 for n in pair) for name, pair in degrees.items()}
            if len(torque) == m * math.prod(sizes["torque"]):
                shapes = (m, *sizes["torque"]), (m, m, *sizes["inertia"])
                if len(inertia) == math.prod(shapes[1]):
                    return cls(torque.reshape(shapes[0]), inertia.reshape(shapes[1]))
        raise InputError(
            f"expected the coefficients of torque and inertia that {m} joints have under "
            f"scheduled-pd, found {len(torque)} and {len(inertia)}: prove the run again"
        )

    def torque_at(self, u: Float[Array, "2"]) -> Actuated:
        """Return the feed-forward torque at (phase, level). [m] (N m)."""
        return _value(self.torque, u)

    def inertia_at(self, u: Float[Array, "2"]) -> Float[Array, "m m"]:
        """Return the inertia of the outputs at (phase, level). [m, m] (kg m^2)."""
        return _value(self.inertia, u)


@dataclass(frozen=True)
class GainErrors:
    """Largest errors of a gait's gains at states of its tube; sampled, not bounded.

    Infinite where the tube cannot be widened by `MARGIN`.

    Attributes:
        torque: largest error of a joint's feed-forward torque [N m].
        inertia: largest norm of 1 - M^-1 M_fitted.
    """

    torque: float
    inertia: float

    @classmethod
    def of(
        cls,
        robot: SteppingRobot,
        gait: Gait,
        gains: ScheduledGains,
        counts: tuple[int, int] = _NODES,
    ) -> "GainErrors":
        """Compare gains with the model at evenly spaced states of the tube, edges included."""
        axes = np.meshgrid(*(np.linspace(0.0, 1.0, count) for count in counts), indexing="ij")
        charts = np.stack(axes, axis=-1).reshape(-1, 2)
        torque, inertia = map(np.asarray, torque_and_inertia(robot, gait, charts))
        fitted_torque, fitted_inertia = map(np.asarray, _evaluate(gains, charts))
        if not (np.all(np.isfinite(fitted_torque)) and np.all(np.isfinite(fitted_inertia))):
            return cls(np.inf, np.inf)
        lost = np.eye(inertia.shape[1]) - np.linalg.solve(inertia, fitted_inertia)
        return cls(
            float(np.max(np.abs(fitted_torque - torque))),
            float(np.max(np.linalg.norm(lost, 2, axis=(1, 2)))),
        )


@quick_filter_jit
def torque_and_inertia(
    robot: SteppingRobot, gait: Gait, charts: Float[Array, "N 2"]
) -> tuple[Float[Array, "N m"], Float[Array, "N m m"]]:
    """Return the model's u0 [N m] and M = du/d(ddy) [kg m^2] at chart points (phase, level)."""

    def at(u: Array) -> tuple[Array, Array]:
        z, m = gait.z(u), robot.n - 1

        def torque(acceleration: Array) -> Array:
            # The bandwidth has no say where the acceleration is given.
            return FullPoint(robot, gait.policy, z, jnp.zeros(2 * m), 1.0, acceleration).torque

        value, derivative = jax.linearize(torque, jnp.zeros(m))
        return value, jax.vmap(derivative)(jnp.eye(m)).T

    return jax.vmap(at)(charts)


@quick_filter_jit
def _evaluate(gains: ScheduledGains, charts: Float[Array, "N 2"]) -> tuple[Array, Array]:
    return jax.vmap(lambda u: (gains.torque_at(u), gains.inertia_at(u)))(charts)


def _value(series: Float[Array, "..."], u: Float[Array, "2"]) -> Array:
    """Return the value of Chebyshev series, whose last two axes are degrees in phase and level."""
    phase, level = (2.0 * u - 1.0) / (1.0 + 2.0 * MARGIN)
    in_level = jnp.asarray(series) @ chebyshev(level, series.shape[-1])
    return in_level @ chebyshev(phase, series.shape[-2])
