"""Effect of a robot whose links are not the file's, in the coordinates of a set at full order.

A state (q, dq) keeps its coordinates, which the file's model defines. Under the same torque the
other robot's accelerations are D^-1 (Y v + dD ddq) beside the file's, with Y and dD linear in the
shares v of `LinkShares`. Everything here is a slope at the file's robot. Source:
docs/level5_model.md.
"""

from typing import NamedTuple

import jax
import jax.numpy as jnp

from neuralgaits._types import Array, Float, Scalar
from neuralgaits.certificate.levels.full_order.measured_state import (
    state_movements,
    weighted_error_slopes,
)
from neuralgaits.certificate.levels.full_order.model import (
    FullOrderModel,
    Outputs,
    Vector,
    Weights,
    scaled_coordinates,
    unweighted,
    weighted,
)
from neuralgaits.gait.full_order import FullPoint
from neuralgaits.gait.output_laws import state_after_impact
from neuralgaits.gait.policy import output_jet
from neuralgaits.gait.third_order import ThirdOrderPolicy
from neuralgaits.gait.zero_coordinates import momentum_of, position_of
from neuralgaits.gait.zero_dynamics import ZeroDynamics
from neuralgaits.robots.linear import solve
from neuralgaits.robots.mjcf.link_shares import LinkShares

Chart = Float[Array, "2"]
"""Phase and level."""


class Moves(NamedTuple):
    """Effects of K shares between impacts, in one state under exact torques.

    Attributes:
        acceleration, output, momentum: to Q ddq [n, K], to the rate of xi [2m, K] (rad/s) and to
            that of z2 [K] (N m).
        growth: to S de/dt at a constant torque [rad/s^3]. [m, K]
        contact: to the slacks of the contact force [body weights]. [3, K]
    """

    acceleration: Float[Array, "n K *more"]
    output: Float[Array, "two_m K *more"]
    momentum: Float[Array, "K *more"]
    growth: Float[Array, "m K *more"]
    contact: Float[Array, "3 K *more"]


class Feeds(NamedTuple):
    """Slopes in Q ddq, Q dq and S e of what shares add, and of what decides it.

    Attributes:
        moves: of each of `Moves` in S e: one more axis of m.
        acceleration, output, momentum, pace, contact: in Q ddq of what shares add to Q ddq
            [n, K, n], to the rate of xi [2m, K, n], of z2 [K, n] and of the rate of z1 [K, n], and
            to the slacks of contact [3, K, n].
        error: of S e in Q dq at a constant torque. [m, n]
        error_push: of that in S e. [m, n, m]
        force: of the slacks of contact in Q ddq. [3, n]
    """

    moves: Moves
    acceleration: Float[Array, "n K n"]
    output: Float[Array, "two_m K n"]
    momentum: Float[Array, "K n"]
    pace: Float[Array, "K n"]
    contact: Float[Array, "3 K n"]
    error: Float[Array, "m n"]
    error_push: Float[Array, "m n m"]
    force: Float[Array, "3 n"]


class Landed(NamedTuple):
    """Effects of K shares in an impact.

    Attributes:
        rates, output, momentum, pace: to Q dq [n, K], to xi [2m, K] (rad), to z2 [K] (kg m^2/s) and
            to the rate of z1 [K] (m/s).
        impulse: to the slacks of the impulse [N s]. [3, K]
    """

    rates: Float[Array, "n K *more"]
    output: Float[Array, "two_m K *more"]
    momentum: Float[Array, "K *more"]
    pace: Float[Array, "K *more"]
    impulse: Float[Array, "3 K *more"]


class ShareUnits(NamedTuple):
    """Units of shares and of accelerations.

    Attributes:
        shares: unit of each share. [K]
        metric: Q, an upper triangular matrix, row by row from its diagonal on.
    """

    shares: Float[Array, " K"]
    metric: Float[Array, " l"]

    def inverse(self, n: int) -> Float[Array, "n n"]:
        """Return the inverse of Q."""
        columns = jnp.eye(n, dtype=self.metric.dtype)
        return jnp.stack([unweighted(self.metric, column) for column in columns], axis=1)


def moves(model: FullOrderModel, u: Chart, xi: Outputs, units: ShareUnits) -> Moves:
    """Return what shares add in a state of the set."""
    return _in_state(model, u, xi, units)[0]


def feeds(model: FullOrderModel, u: Chart, xi: Outputs, units: ShareUnits) -> Feeds:
    """Return what feeds the effects of shares in a state of the set."""
    return _in_state(model, u, xi, units)[1]


def _in_state(
    model: FullOrderModel, u: Chart, xi: Outputs, units: ShareUnits
) -> tuple[Moves, Feeds]:
    point, shares = model.point(u, xi), LinkShares.of(model.robot)
    q, dq, ddq = point.q, point.dq, point.ddq
    scale, unit = units.shares, units.inverse(len(q))
    inverse, none = _inverse(shares, q), jnp.zeros(model.size // 2)
    output = _slopes_in_rates(model, point)
    weight = model.robot.mass * model.robot.gravity

    def errors(e: Vector) -> Float[Array, "m n"]:
        return weighted_error_slopes(model, point, e)[:, len(q) :]

    def slacks(ddq: Vector) -> tuple[Array, Array]:
        force, in_shares = shares.force(q, dq, ddq)
        return _cone(model, force) / weight, _cone(model, in_shares * scale[None, :]) / weight

    needed, in_mass = shares.torque(q, dq, ddq) * scale[None, :], _in_mass(shares, q, scale)
    acceleration, fed = inverse @ needed, jnp.tensordot(inverse, in_mass, 1)
    push = jax.jacfwd(lambda push: model.point(u, xi, push).ddq)(none)
    error, error_push = errors(none), jax.jacfwd(errors)(none)
    force, contact_fed = jax.jacfwd(slacks)(ddq)
    in_push, pace = fed @ push, point.coordinates.mechanism.position_rows[0]
    # Both the slope of e in the rates and what shares add to ddq move with e.
    growth_push = jnp.einsum("ija,jk->ika", error_push, acceleration)
    own = Moves(
        weighted(units.metric, acceleration),
        output @ acceleration,
        # z2 is minus the first momentum, so its slope times the inverse of D is minus a unit row.
        -needed[0],
        error @ acceleration,
        slacks(ddq)[1],
    )
    in_errors = Moves(
        _weighted(units.metric, in_push),
        jnp.tensordot(output, in_push, 1),
        -in_mass[0] @ push,
        growth_push + jnp.tensordot(error, in_push, 1),
        contact_fed @ push,
    )
    fed = fed @ unit
    return own, Feeds(
        in_errors,
        _weighted(units.metric, fed),
        jnp.tensordot(output, fed, 1),
        -in_mass[0] @ unit,
        jnp.tensordot(pace, fed, 1),
        contact_fed @ unit,
        error @ unit,
        jnp.einsum("ija,jk->ika", error_push, unit),
        force @ unit,
    )


def landings(model: FullOrderModel, u: Chart, xi: Outputs, units: ShareUnits) -> Landed:
    """Return what shares add at an impact in a state."""
    return _at_impact(model, u, xi, units)[0]


def impulse_feeds(
    model: FullOrderModel, u: Chart, xi: Outputs, units: ShareUnits
) -> tuple[Float[Array, "3 n"], Float[Array, "3 K n"]]:
    """Return slopes in Q dq after an impact of the impulse's slacks, and of their slopes."""
    return _at_impact(model, u, xi, units)[1]


def _at_impact(
    model: FullOrderModel, u: Chart, xi: Outputs, units: ShareUnits
) -> tuple[Landed, tuple[Array, Array]]:
    point, shares = model.point(u, xi), LinkShares.of(model.robot)
    after, landed = point.impact, state_after_impact(point)
    output = _slopes_in_rates(model, landed)
    scale, unit = units.shares, units.inverse(len(after.q))
    lost = shares.lost_momentum(point.q, point.dq, after.dq) * scale[None, :]
    rates = _inverse(shares, after.q) @ lost
    pace = point.coordinates.mechanism.position_rows[0]

    def slacks(dq: Vector) -> tuple[Array, Array]:
        impulse, in_shares = shares.impulse(point.q, point.dq, dq)
        return _cone(model, impulse), _cone(model, in_shares * scale[None, :])

    in_rates, in_both = jax.jacfwd(slacks)(after.dq)
    own = Landed(
        weighted(units.metric, rates),
        output @ rates,
        -lost[0],
        pace @ rates,
        slacks(after.dq)[1],
    )
    return own, (in_rates @ unit, in_both @ unit)


def barrier_slopes(model: FullOrderModel, u: Chart) -> Vector:
    """Return the slope of each barrier in z2 [h s/(kg m^2)]. [I]."""
    z = model.gait.z(u)
    more = jnp.stack([jnp.zeros_like(position_of(z)), jnp.ones_like(momentum_of(z))])
    return jax.jvp(model.barriers, (z,), (more,))[1]


def output_curvature(
    model: FullOrderModel, u: Chart, xi: Outputs
) -> tuple[Float[Array, " two_m"], Float[Array, " two_m"]]:
    """Return second derivatives of xi in the rates: in that of z1 and z2, and in z2 twice.

    Rates of outputs are dq - dy_d/dz1 dz1 - dy_d/dz2 dz2, with dz2 a function of q. So they are
    linear in the rates of joints and of z1, and all that is not linear is y_d in z2.

    Returns: [2m] (rad s/m per kg m^2/s), [2m] (rad per (kg m^2/s)^2).
    """
    point = model.point(u, xi)
    policy = ThirdOrderPolicy.of(point.policy, point.z)
    joints = jnp.zeros(model.size // 2)
    momentum_rate = ZeroDynamics(point.robot, policy).coordinates.rate(point.q, point.dq)

    def outputs(pace: Scalar, momentum: Scalar) -> Vector:
        z = jnp.stack([position_of(point.z), momentum])
        desired = output_jet(policy, z)
        rate = desired.rate(jnp.stack([pace, momentum_of(momentum_rate)]))
        eta = jnp.concatenate([-desired.y, joints - rate])
        return scaled_coordinates(eta, model.bandwidth, model.weights)

    at = position_of(point.dz), momentum_of(point.z)
    in_momentum = jax.jacfwd(outputs, 1)
    return jax.jacfwd(in_momentum, 0)(*at), jax.jacfwd(in_momentum, 1)(*at)


def _weighted(weights: Weights, slopes: Float[Array, "n K k"]) -> Float[Array, "n K k"]:
    """Return the weighting matrix times slopes."""
    flat = slopes.reshape(len(slopes), -1)
    return weighted(weights, flat).reshape(slopes.shape)


def _slopes_in_rates(model: FullOrderModel, point: FullPoint) -> Float[Array, "two_m n"]:
    """Return the slopes of xi in the rates of the coordinates."""
    return state_movements(model, point).xi[:, model.robot.n :]


def _inverse(shares: LinkShares, q: Vector) -> Float[Array, "n n"]:
    """Return the inverse of the file's mass matrix."""
    robot = shares.family.nominal
    mass = robot.mass_matrix(q)
    return jnp.stack([solve(mass, row) for row in jnp.eye(len(q), dtype=q.dtype)], axis=1)


def _in_mass(shares: LinkShares, q: Vector, scale: Float[Array, " K"]) -> Float[Array, "n K n"]:
    """Return the slopes of the mass matrix in the shares. [n, K, n]."""
    return jnp.transpose(shares.mass_matrix(q) * scale[None, None, :], (0, 2, 1))


def _cone(model: FullOrderModel, force: Float[Array, "2 *columns"]) -> Float[Array, "3 *columns"]:
    """Return the normal force and both slacks of the friction cone."""
    tangential, normal = force
    cone = float(model.robot.friction) * normal
    return jnp.stack([normal, cone - tangential, cone + tangential])
