"""Robot, gait and spec at full order: quantities of level 4 at outputs off zero."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from neuralgaits._types import Array, Float, Scalar, ZeroState
from neuralgaits.barriers import Barrier, Gait, GaitSpec
from neuralgaits.certificate.levels.full_order.theorem import (
    LOWER,
    STIFF,
    UPPER,
)
from neuralgaits.errors import SpecError
from neuralgaits.gait import Point
from neuralgaits.gait.full_order import FullPoint
from neuralgaits.gait.stepping_robot import SteppingRobot
from neuralgaits.gait.zero_coordinates import momentum_of, position_of

Vector = Float[Array, " _"]
"""A vector of any length."""
Outputs = Float[Array, " two_m"]
Columns = Float[Array, "_ *columns"]
"""A vector of any length, or columns of them, to which a linear map is applied."""
Quantities = dict[str, Float[Array, "..."]]
Weights = Sequence[float] | Vector
"""Weights of a norm, as in `FullOrderConstants.weights`."""


def weighted(weights: Weights, x: Columns) -> Columns:
    """Return S x for the upper triangular S of a norm. [m], or [m, columns]."""
    if len(weights) == 0:
        return x
    rows = []
    start = 0
    size = len(x)
    for i in range(size):
        rows.append(sum(weights[start + j - i] * x[j] for j in range(i, size)))
        start += size - i
    return jnp.stack(rows)


def unweighted(weights: Weights, x: Vector) -> Vector:
    """Return the y with S y = x, solved from the last row up. [m]."""
    if len(weights) == 0:
        return x
    size = len(x)
    y: dict[int, Scalar] = {}
    for i in reversed(range(size)):
        start = i * size - i * (i - 1) // 2
        rest = sum(weights[start + j - i] * y[j] for j in range(i + 1, size))
        y[i] = (x[i] - rest) / weights[start]
    return jnp.stack([y[i] for i in range(size)])


def output_coordinates(xi: Outputs, bandwidth: float | Scalar, weights: Weights = ()) -> Outputs:
    """Return the outputs eta = (y, dy) of scaled coordinates, V = |xi|^2. [2m] (rad, rad/s)."""
    rate, mixed = (unweighted(weights, part) for part in jnp.split(xi, 2))
    return jnp.concatenate([(1.0 / float(STIFF)) * mixed - rate, bandwidth * rate])


def scaled_coordinates(eta: Columns, bandwidth: float | Scalar, weights: Weights = ()) -> Columns:
    """Return scaled coordinates: the inverse of `output_coordinates`. [2m] (rad), or columns."""
    y, dy = (weighted(weights, part) for part in jnp.split(eta, 2))
    rate = dy / bandwidth
    return jnp.concatenate([rate, float(STIFF) * (y + rate)])


BANDWIDTH = 30.0
"""Double pole of the outputs [rad/s]: that of `control.fblin`."""


def size_of(robot: SteppingRobot) -> int:
    """Return the number of elements of eta and of xi: two for each actuated joint."""
    return 2 * (robot.n - 1)


@dataclass(frozen=True)
class FullOrderModel:
    """Robot, gait and spec whose full order is evaluated. Raises SpecError for flat feet.

    Attributes:
        robot, gait, spec: those of a run.
        bandwidth: w, the double pole of the outputs [rad/s].
        weights: weights of the norm.
    """

    robot: SteppingRobot
    gait: Gait
    spec: GaitSpec
    bandwidth: float | Scalar = BANDWIDTH
    weights: Weights = ()

    def __post_init__(self):
        """Refuse flat feet: with joints off their targets they do not land flat."""
        if self.robot.feet is not None:
            raise SpecError(
                "it is about point feet: a flat foot whose joints are off their targets does not "
                "land flat, and such a landing is not modelled"
            )

    @property
    def size(self) -> int:
        """Number of elements of eta, 2m."""
        return size_of(self.robot)

    @property
    def tightened(self) -> list[Barrier]:
        """Return the spec's barrier conditions; they read outputs, so they are tightened."""
        return [c for c in self.spec.conditions if isinstance(c, Barrier)]

    @property
    def names(self) -> list[str]:
        """Return the names of all barriers of the theorem; each element of a vector has its own."""
        barrier_names = [LOWER, UPPER]
        for condition in self.tightened:
            size = jax.eval_shape(partial(self._on_manifold, condition), np.zeros(2)).size
            alone = [condition.name]
            barrier_names += alone if size == 1 else [f"{condition.name}[{k}]" for k in range(size)]
        return barrier_names

    def point(self, u: Float[Array, "2"], xi: Outputs, push: Vector | None = None) -> FullPoint:
        """Return the robot at a chart point with scaled outputs.

        Args:
            u: phase and level.
            xi: scaled outputs [rad]. [2m]
            push: S times an addition to the outputs' acceleration [rad/s^2]; None for none. [m]
        """
        w = self.bandwidth
        eta = output_coordinates(xi, w, self.weights)
        acceleration = None
        if push is not None:
            y, dy = jnp.split(eta, 2)
            acceleration = unweighted(self.weights, push) - (w * w) * y - (2.0 * w) * dy
        return FullPoint(self.robot, self.gait.policy, self.gait.z(u), eta, w, acceleration)

    def barriers(self, z: ZeroState) -> Vector:
        """Return h_Z of every barrier. [I]."""
        level = self.gait.level(z)
        own = [self._on_manifold(condition, z) for condition in self.tightened]
        return jnp.concatenate([jnp.stack([level, 1.0 - level]), *own])

    def _on_manifold(self, condition: Barrier, z: ZeroState) -> Vector:
        """Return h of a barrier condition on the zero dynamics manifold."""
        point = Point(self.robot, self.gait.policy, None, z)
        return jnp.ravel(condition.function(point))

    def rates(self, point: FullPoint) -> Vector:
        """Return dh_Z/dt of every barrier in a full state [h/s]. [I]."""
        return jax.jvp(self.barriers, (point.z,), (point.dz,))[1]

    def readings(self, point: FullPoint) -> Vector:
        """Return the reading of every barrier on the robot [h]; 0 for a fence. [I]."""
        own = [jnp.ravel(condition.function(point)) for condition in self.tightened]
        return jnp.concatenate([jnp.zeros(2), *own])

    def in_step(self, point: FullPoint) -> Quantities:
        """Return quantities between impacts, each as a vector.

        pace [1/s], inertia [kg m], foot [m], foot-rate [m/s], contact [body weights]: normal
        force and both slacks of the friction cone, torque: slack of both limits [limits].
        """
        robot = self.robot
        tangential, normal = point.force / (robot.mass * robot.gravity)
        cone = float(robot.friction) * normal
        # Of the whole limit: a spec's conditions of level 1 may ask for less, as TORQUE_SHARE does.
        share = point.torque / robot.torque_limit
        quantities = {
            "pace": self.gait.pace(point.dz),
            "inertia": -point.transversal_inertia,
            "foot": point.foot[1],
            "foot-rate": point.foot_velocity[1],
            "contact": jnp.stack([normal, cone - tangential, cone + tangential]),
            "torque": jnp.concatenate([1.0 - share, 1.0 + share]),
        }
        return {name: jnp.atleast_1d(value) for name, value in quantities.items()}

    def at_impact(self, point: FullPoint) -> Quantities:
        """Return quantities of an impact in this state, each as a vector.

        foot [m], impulse [N s]: normal and both slacks of the friction cone, after: xi after it
        [rad], momentum: z2 after it, landing: phase after it, reset: all barriers after it [h].
        """
        tangential, normal = point.impact.impulse
        cone = float(self.robot.friction) * normal
        quantities = {
            "foot": point.foot[1],
            "impulse": jnp.stack([normal, cone - tangential, cone + tangential]),
            "after": scaled_coordinates(point.eta_after, self.bandwidth, self.weights),
            "momentum": momentum_of(point.z_after),
            "landing": self.gait.phase(position_of(point.z_after)),
            "reset": self.barriers(point.z_after),
        }
        return {name: jnp.atleast_1d(value) for name, value in quantities.items()}

    def at_crossing(self, u: Float[Array, "2"]) -> tuple[Quantities, Vector]:
        """Return `at_impact` from eta = 0, and the slope in the phase of xi after it [rad]."""

        def impact_at(phase: Scalar) -> Quantities:
            return self.at_impact(self.point(jnp.stack([phase, u[1]]), jnp.zeros(self.size)))

        quantities, slopes = jax.jvp(impact_at, (u[0],), (jnp.ones_like(u[0]),))
        return quantities, slopes["after"]

    def guard_slopes(self, u: Float[Array, "2"], xi: Outputs) -> "GuardSlopes":
        """Return d/d xi of `at_impact` along the guard; the phase moves to keep the foot height."""
        phase, level = u

        def impact_at(at: Vector) -> Quantities:
            return self.at_impact(self.point(jnp.stack([at[0], level]), at[1:]))

        slopes = jax.jacfwd(impact_at)(jnp.concatenate([phase[None], xi]))
        foot = slopes.pop("foot")[0]
        gives = -foot[1:] / foot[0]
        along = {name: d[:, 1:] + d[:, :1] * gives[None, :] for name, d in slopes.items()}
        return GuardSlopes(foot[0], foot[1:], along)


class GuardSlopes(NamedTuple):
    """First derivatives of quantities at an impact."""

    fall: Scalar
    """Slope of the foot height in the phase [m]."""
    foot: Vector
    """Slope of the foot height in xi at a fixed phase [m/rad]. [2m]"""
    along: Quantities
    """Slope of every other quantity in xi along the guard. [k, 2m] each"""
