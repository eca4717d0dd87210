"""Margins of level 5 beside those of level 4; none may be negative.

Forces and torques are affine in e, so the worst e of a ball |S e| <= peak takes peak times the
length of their slope in S e. The jerk of the outputs under held torques is bounded by its size at
eta = 0 and by its slopes: enclosures of the jerk itself, over all outputs, are far wider.
"""

import jax
import jax.numpy as jnp
import numpy as np

from neuralgaits._types import Array, Float, Scalar
from neuralgaits.certificate.levels.disturbed.theorem import OF_BARRIER, DisturbedConstants, series
from neuralgaits.certificate.levels.full_order.margins import TheoremArrays
from neuralgaits.certificate.levels.full_order.model import (
    FullOrderModel,
    Outputs,
    Quantities,
    weighted,
)
from neuralgaits.certificate.levels.full_order.theorem import FullOrderConstants
from neuralgaits.gait.full_order import error_after_impact, held_jerk
from neuralgaits.robots.linear import pivots

FORCES = ("contact", "torque")


def margins(
    model: FullOrderModel,
    full: FullOrderConstants,
    shape: DisturbedConstants,
    u: Float[Array, "2"],
    xi: Outputs,
) -> Quantities:
    """Return all margins of the theorem at one chart point and one xi of the unit ball."""
    its = TheoremArrays.of(full, model.names)
    model = its.model(model)
    parts = {name: jnp.asarray(np.array(values)) for name, values in series(shape).items()}
    rows = parts["barriers"].reshape(-1, len(OF_BARRIER))
    bound, guard = its.bound(u[0]), its.set["guard_radius"] * xi
    xi = bound * xi
    found = _forces(model, u, xi, parts["peak"][0] + parts["peak"][1] * bound)
    if shape.hold != 0.0:
        found |= _growth(model, u, xi, parts["jerk"])
    if shape.free_clock:
        kicked = _forces(model, u, xi, parts["kick"][3])
        found["disturbed/kick-contact"] = kicked["disturbed/contact"]
        found |= _kicks(model, u, guard, parts["kick"])
    centre = model.point(u, jnp.zeros_like(xi))
    rate, h = model.rates(centre), model.barriers(centre.z)
    coupling = jax.jacfwd(lambda moved: model.rates(model.point(u, moved)))(xi)
    for k, name in enumerate(model.names):
        alpha, weight, lost = rows[k]
        # dh/dt + alpha h - p |d(dh/dt)/d xi|^2 - q >= 0.
        spent = weight * (coupling[k] @ coupling[k]) + lost
        found[f"disturbed/decrease {name}"] = rate[k] + alpha * h[k] - spent
    return found


def _forces(model: FullOrderModel, u: Float[Array, "2"], xi: Outputs, peak: Scalar) -> Quantities:
    """Return the slacks of forces less the most that e may take of them."""

    def slacks(e: Float[Array, " m"]) -> Quantities:
        found = model.in_step(model.point(u, xi, e))
        return {name: found[name] for name in FORCES}

    none = jnp.zeros(model.size // 2)
    found, slopes = slacks(none), jax.jacfwd(slacks)(none)
    # v - P |dv/d(S e)| > 0 for each slack v.
    return {
        f"disturbed/{name}": found[name]
        - peak * jnp.sqrt(jnp.sum(slopes[name] * slopes[name], axis=1))
        for name in FORCES
    }


def growth_slope(
    jerk_slope: Float[Array, "m two_m"], bandwidth: float | Scalar
) -> Float[Array, "m two_m"]:
    """Return the slope of S de/dt in xi, given that of the outputs' jerk [rad/s^3 per rad]."""
    m = len(jerk_slope)
    # S de/dt = S d^3y/dt^3 - w^3 (xi_1 + xi_2) + 2 w S e.
    return jerk_slope - bandwidth**3 * np.concatenate([np.eye(m), np.eye(m)], axis=1)


def _kicks(
    model: FullOrderModel, u: Float[Array, "2"], xi: Outputs, bounds: Float[Array, "4"]
) -> Quantities:
    """Return margins of the error right after an impact under the torque from before it."""

    def kick(xi: Outputs, e: Float[Array, " m"]) -> Float[Array, " m"]:
        return weighted(model.weights, error_after_impact(model.point(u, xi, e)))

    none = jnp.zeros(model.size // 2)
    exact = kick(jnp.zeros_like(xi), none)
    along, pushed = jax.jacfwd(kick)(xi, none), jax.jacfwd(kick, 1)(xi, none)
    return {
        "disturbed/kick": bounds[0] * bounds[0] - exact @ exact,
        "disturbed/kick-slope": bounds[1] * bounds[1] - jnp.sum(along * along),
        "disturbed/kick-push": bounds[2] * bounds[2] - jnp.sum(pushed * pushed),
    }


def _growth(
    model: FullOrderModel, u: Float[Array, "2"], xi: Outputs, bounds: Float[Array, "3"]
) -> Quantities:
    """Return margins of S de/dt under held torques: its size at xi = 0, e = 0 and its slopes."""
    none = jnp.zeros(model.size // 2)

    def jerk(xi: Outputs, e: Float[Array, " m"]) -> Float[Array, " m"]:
        return weighted(model.weights, held_jerk(model.point(u, xi, e)))

    still = jerk(jnp.zeros_like(xi), none)
    along, pushed = jax.jacfwd(jerk)(xi, none), jax.jacfwd(jerk, 1)(xi, none)
    along = growth_slope(along, model.bandwidth) / bounds[1]
    # |A| < l if and only if 1 - A A' / l^2 is positive definite.
    left = jnp.eye(len(still)) - along @ along.T
    # Squares, which are smooth: |.| <= j and kappa of docs/level5.md.
    return {
        "disturbed/jerk": bounds[0] * bounds[0] - still @ still,
        "disturbed/growth-slope": pivots(left),
        "disturbed/jerk-push": bounds[2] * bounds[2] - jnp.sum(pushed * pushed),
    }
