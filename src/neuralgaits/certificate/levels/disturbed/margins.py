"""Margins of level 5 beside those of level 4; none may be negative.

Forces and torques are affine in e, so the worst e of a ball |S e| <= peak takes peak times the
length of their slope in S e. The jerk of the outputs under held torques is bounded by its size at
eta = 0 and by its slopes: enclosures of the jerk itself, over all outputs, are far wider.
"""

from collections.abc import Mapping
from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from neuralgaits._types import Array, Float, Scalar
from neuralgaits.certificate.levels.disturbed.model_margins import (
    contact_taken,
    impulse_margin,
    model_margins,
    taken_margins,
)
from neuralgaits.certificate.levels.disturbed.state_margins import state_margins
from neuralgaits.certificate.levels.disturbed.theorem import (
    BARRIER_CONSTANTS,
    DisturbedConstants,
    series,
    slope_output,
)
from neuralgaits.certificate.levels.full_order.margins import TheoremArrays
from neuralgaits.certificate.levels.full_order.model import (
    FullOrderModel,
    Outputs,
    Quantities,
    Vector,
    unweighted,
    weighted,
)
from neuralgaits.certificate.levels.full_order.theorem import STIFF, FullOrderConstants
from neuralgaits.gait.output_laws import ExactLinearisation, OutputLaw, ScheduledLaw
from neuralgaits.gait.scheduled_gains import ScheduledGains
from neuralgaits.robots.linear import pivots

FORCES = ("contact", "torque")


def margins(
    model: FullOrderModel,
    full: FullOrderConstants,
    disturbed: DisturbedConstants,
    u: Float[Array, "2"],
    xi: Outputs,
) -> Quantities:
    """Return all margins of the theorem at one chart point and one xi of the unit ball."""
    its = TheoremArrays.of(full, model.names)
    model = its.model(model)
    parts = {name: jnp.asarray(np.array(values)) for name, values in series(disturbed).items()}
    rows = parts["barriers"].reshape(-1, len(BARRIER_CONSTANTS))
    bound, guard = its.bound(u[0]), its.set["guard_radius"] * xi
    unit, xi = xi, bound * xi
    errors = LawErrors(model, _law(model, disturbed, parts), u)
    peak = parts["peak"][0] + parts["peak"][1] * bound
    margins = _forces(errors, xi, peak)
    if disturbed.scheduled:
        margins |= _decay(errors, xi, parts["law"])
    if disturbed.hold != 0.0:
        margins |= _growth(errors, xi, parts["jerk"], exact=not disturbed.scheduled)
    if disturbed.free_clock:
        kicked = _forces(errors, xi, parts["kick"][3])
        margins["disturbed/kick-contact"] = kicked["disturbed/contact"]
        margins |= _kicks(errors, guard, parts["kick"])
    if disturbed.measured:
        moves, beyond = parts["state_moves"][:3], parts["state_moves"][3]
        # Over the tube, this goes over one that is longer and wider by the movements.
        wider = u + moves[:2] * (2.0 * u - 1.0)
        out = (its.bound(wider[0]) + beyond) * unit
        lists = parts["state_axes"], moves, parts["state_slopes"]
        margins |= state_margins(model, wider, out, *lists)
    centre = model.point(u, jnp.zeros_like(xi))
    rate, h = model.rates(centre), model.barriers(centre.z)
    coupling = jax.jacfwd(lambda moved: model.rates(model.point(u, moved)))(xi)
    left = {}
    for k, name in enumerate(model.names):
        alpha, weight, lost = rows[k]
        # dh/dt + alpha h - p |d(dh/dt)/d xi|^2 - q >= 0.
        spent = weight * (coupling[k] @ coupling[k]) + lost
        left[name] = rate[k] + alpha * h[k] - spent
        margins[f"disturbed/decrease {name}"] = left[name]
    if disturbed.of_other_robots:
        contact = {"contact": margins["disturbed/contact"]}
        margins |= model_margins(model, u, xi, guard, parts)
        margins |= taken_margins(model, u, parts, bound, peak, contact | left)
        impulse = model.at_impact(model.point(u, guard))["impulse"]
        margins |= impulse_margin(parts, impulse, its.set["guard_radius"])
        if disturbed.free_clock:
            taken = contact_taken(parts, bound, parts["kick"][3])
            margins["disturbed/model-kick-contact"] = margins["disturbed/kick-contact"] - taken
    return margins


class LawErrors(NamedTuple):
    """Errors of the outputs' acceleration under a law, at one point, in the norm of S.

    Attributes:
        model: model with the set's norm.
        law: the control law.
        u: phase and level.
    """

    model: FullOrderModel
    law: OutputLaw
    u: Float[Array, "2"]

    def of_law(self, xi: Outputs) -> Vector:
        """Return S e_L: that of the law's own torque [rad/s^2]. [m]."""
        return weighted(self.model.weights, self.law.error(self.model.point(self.u, xi), self.u))

    def forces(self, xi: Outputs) -> Quantities:
        """Return the slacks of contact and torques under the law's own torque."""
        point = self.model.point(self.u, xi, self.of_law(xi))
        slacks = self.model.in_step(point)
        if isinstance(self.law, ScheduledLaw):
            # The torque is a polynomial: from the accelerations it would have wide bounds.
            share = self.law.torque(point, self.u) / self.model.robot.torque_limit
            slacks["torque"] = jnp.concatenate([1.0 - share, 1.0 + share])
        return {name: slacks[name] for name in FORCES}

    def growth(self, xi: Outputs, e: Vector) -> Vector:
        """Return S de/dt while torques are held, S e given [rad/s^3]. [m]."""
        point, off = self.model.point(self.u, xi), unweighted(self.model.weights, e)
        return weighted(self.model.weights, self.law.growth(point, self.u, off))

    def after_impact(self, xi: Outputs, e: Vector) -> Vector:
        """Return S e right after an impact, S e before it given [rad/s^2]. [m]."""
        point, off = self.model.point(self.u, xi), unweighted(self.model.weights, e)
        return weighted(self.model.weights, self.law.after_impact(point, self.u, off))

    @property
    def none(self) -> Vector:
        """Error of exact torques: zero for each output. [m]."""
        return jnp.zeros(self.model.size // 2)


def _law(
    model: FullOrderModel, disturbed: DisturbedConstants, parts: Mapping[str, Vector]
) -> OutputLaw:
    """Return the control law that the theorem is about."""
    if not disturbed.scheduled:
        return ExactLinearisation()
    lists = parts["torque_gains"], parts["inertia_gains"]
    return ScheduledLaw(ScheduledGains.from_lists(*lists, m=model.size // 2), model.gait)


def _forces(its: LawErrors, xi: Outputs, peak: Scalar) -> Quantities:
    """Return the slacks of forces under the law less the most that e may take of them."""

    def slacks(e: Vector) -> Quantities:
        values = its.model.in_step(its.model.point(its.u, xi, e))
        return {name: values[name] for name in FORCES}

    # Forces are affine in what is added to ddy, so the slopes are those at any.
    values, slopes = its.forces(xi), jax.jacfwd(slacks)(its.none)
    # v - P |dv/d(S e)| > 0 for each slack v.
    return {
        f"disturbed/{name}": values[name]
        - peak * jnp.sqrt(jnp.sum(slopes[name] * slopes[name], axis=1))
        for name in FORCES
    }


def _decay(its: LawErrors, xi: Outputs, bounds: Float[Array, "2"]) -> Quantities:
    """Return margins of the decay of V under a law, and of its error where nothing is off."""
    rest, along = its.of_law(jnp.zeros_like(xi)), jax.jacfwd(its.of_law)(xi)
    return {
        "disturbed/decay": pivots(decay_matrix(along, its.model.bandwidth, bounds[0])),
        "disturbed/rest": bounds[1] * bounds[1] - rest @ rest,
    }


def decay_matrix(
    slope: Float[Array, "m two_m"], bandwidth: float | Scalar, decay: float | Scalar
) -> Float[Array, "two_m two_m"]:
    """Return -(A + B E) - (A + B E)' - decay, of dxi/dt = A xi + B E xi, E being `slope` [1/s].

    In the coordinates xi = (s + d, s - d): what nearly is not definite is d, which B hardly moves.
    """
    m, stiff = len(slope), float(STIFF)
    one = np.eye(m)
    flow = bandwidth * np.block([[-one, -one / stiff], [0.0 * one, -one]])
    turn = np.block([[one, one], [one, -one]])
    moved = turn.T @ flow @ turn
    moved = moved + (turn.T @ np.concatenate([one, stiff * one])) @ (slope @ turn) / bandwidth
    return -(moved + moved.T) - decay * (turn.T @ turn)


def _kicks(its: LawErrors, xi: Outputs, bounds: Float[Array, "4"]) -> Quantities:
    """Return margins of the error right after an impact under the torque from before it."""
    exact = its.after_impact(jnp.zeros_like(xi), its.none)
    along, pushed = (jax.jacfwd(its.after_impact, k)(xi, its.none) for k in (0, 1))
    return {
        "disturbed/kick": bounds[0] * bounds[0] - exact @ exact,
        "disturbed/kick-slope": bounds[1] * bounds[1] - jnp.sum(along * along),
        "disturbed/kick-push": bounds[2] * bounds[2] - jnp.sum(pushed * pushed),
    }


def _growth(its: LawErrors, xi: Outputs, bounds: Float[Array, "3"], *, exact: bool) -> Quantities:
    """Return margins of S de/dt under held torques: its size at xi = 0, e = 0 and its slopes.

    Under exact linearisation the slope in xi is that of the jerk S d^3y/dt^3.
    """
    still = its.growth(jnp.zeros_like(xi), its.none)
    along, pushed = (jax.jacfwd(its.growth, k)(xi, its.none) for k in (0, 1))
    none = jnp.eye(len(still))
    if exact:
        # S de/dt has -w^3 (xi_1 + xi_2) beside the jerk, e being zero.
        along = along + its.model.bandwidth**3 * jnp.concatenate([none, none], axis=1)
    along = along / bounds[1]
    # Of what e feeds itself by, 2 w is there whatever the robot.
    pushed = pushed - (2.0 * its.model.bandwidth) * none
    # |A| < l if and only if 1 - A A' / l^2 is positive definite; squares, which are smooth:
    # |.| <= j and kappa of docs/level5.md.
    return {
        "disturbed/jerk": bounds[0] * bounds[0] - still @ still,
        slope_output(exact): pivots(none - along @ along.T),
        "disturbed/jerk-push": bounds[2] * bounds[2] - jnp.sum(pushed * pushed),
    }
