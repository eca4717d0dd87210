"""A small dense quadratic program, by a primal-dual interior-point method.

Source: Mehrotra's predictor and corrector as in Nocedal and Wright (2006), section 16.6. Repeated
in `simulation/native/c/clf_qp.c`. No LAPACK, see `robots.linear`, and at most a fixed number of
rounds, so that it can be compiled into a control tick and vmapped.
"""

from typing import NamedTuple

import jax
import jax.numpy as jnp

from neuralgaits._types import Array, Bool, Float, Scalar
from neuralgaits.robots.linear import solve


class QuadraticProgram(NamedTuple):
    """Minimise sum_i (weight_i x_i^2 / 2 + cost_i x_i) so that rows x <= bound."""

    weight: Float[Array, " n"]
    """Positive weights. [n]"""
    cost: Float[Array, " n"]
    """Linear costs. [n]"""
    rows: Float[Array, "k n"]
    """Left sides of the inequalities. [k, n]"""
    bound: Float[Array, " k"]
    """Right sides of the inequalities. [k]"""


class _Point(NamedTuple):
    x: Float[Array, " n"]
    slack: Float[Array, " k"]
    multiplier: Float[Array, " k"]


class Solution(NamedTuple):
    """Result of the solver: solution, multipliers and convergence."""

    x: Float[Array, " n"]
    """Minimiser. [n]"""
    multiplier: Float[Array, " k"]
    """Multiplier of each row, not negative. [k]"""
    converged: Bool[Array, ""]
    """Whether the gap was closed."""


def minimise(program: QuadraticProgram) -> Solution:
    """Solve a program that has points strictly inside all bounds. Returns: `Solution`."""
    weight, cost, rows, bound = program
    x = -cost / weight
    slack = jnp.maximum(bound - rows @ x, 1.0)
    first = _Point(x, slack, jnp.ones_like(slack))

    # Mean product of slack and multiplier at which the rounds end, in units of the problem.
    gap = 1e-11
    # Size below which a round that does not reduce it is not taken, since rounding dominates.
    closed = 1e-10

    def one(point: _Point, _) -> tuple[_Point, None]:
        before, after = _gap(point), _round(program, point)
        converged = (before < gap) | (before < closed) & ~(_gap(after) < before)
        return jax.tree.map(lambda new, old: jnp.where(converged, old, new), after, point), None

    last, _ = jax.lax.scan(one, first, None, length=30)
    return Solution(last.x, last.multiplier, _gap(last) < closed)


def _gap(point: _Point) -> Scalar:
    return jnp.mean(point.slack * point.multiplier)


def _round(program: QuadraticProgram, point: _Point) -> _Point:
    weight, cost, rows, bound = program
    x, slack, multiplier = point
    dual = weight * x + cost + rows.T @ multiplier
    primal = rows @ x + slack - bound
    matrix = jnp.diag(weight) + rows.T @ ((multiplier / slack)[:, None] * rows)

    def towards(product: Float[Array, " k"]) -> _Point:
        """The Newton step that takes `product` from each slack times its multiplier."""
        right = rows.T @ ((product - multiplier * primal) / slack) - dual
        dx = solve(matrix, right)
        dslack = -primal - rows @ dx
        return _Point(dx, dslack, -(product + multiplier * dslack) / slack)

    gap = _gap(point)
    ahead = towards(slack * multiplier)
    far = _longest(point, ahead)
    left = jnp.mean((slack + far * ahead.slack) * (multiplier + far * ahead.multiplier))
    centring = (left / gap) ** 3
    step = towards(slack * multiplier + ahead.slack * ahead.multiplier - centring * gap)
    # Not all of the way to the nearest bound.
    length = 0.995 * _longest(point, step)
    return jax.tree.map(lambda value, change: value + length * change, point, step)


def _longest(point: _Point, step: _Point) -> Scalar:
    """Share of a step, at most 1, that leaves slacks and multipliers positive."""
    value = jnp.concatenate([point.slack, point.multiplier])
    change = jnp.concatenate([step.slack, step.multiplier])
    until = jnp.where(change < 0.0, -value / jnp.where(change < 0.0, change, -1.0), jnp.inf)
    return jnp.minimum(1.0, jnp.min(until))
