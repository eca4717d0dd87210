"""Inequalities between the constants of the full-order theorem (level 4), in balls.

Every inequality is between numbers of `FullOrderConstants`, whose meaning the premises prove. An
inequality holds only if it is certain; one that does not is reported with both of its sides. The
argument is in docs/full_order_proof.md. Needs no JAX.
"""

import math
from typing import NamedTuple

from flint import arb, fmpq

from neuralgaits.certificate.levels.full_order.theorem import (
    BarrierConstants,
    FullOrderConstants,
    joints_of,
    lyapunov_rate,
    weighting,
)


class Inequality(NamedTuple):
    """A required inequality left < right, with a name for messages."""

    claim: str
    left: arb
    right: arb

    @property
    def holds(self) -> bool:
        """Return whether the inequality is certain."""
        return bool(self.left < self.right)


def inequalities(constants: FullOrderConstants) -> list[Inequality]:
    """Return every inequality that the constants must satisfy."""
    gamma, zero = _gamma(constants), arb(0)
    least, most = map(arb, constants.pace)
    # The edges that the boxes have: 1 + g, 1 - g and 1 -+ e, each rounded to a double.
    last, before = arb(constants.ends[1]), arb(constants.guard_from)
    shrink, radius = arb(constants.shrink), arb(constants.radius)
    kept, at_guard = bound_at(constants, arb(constants.start_strip)), bound_at(constants, before)
    landing = arb(constants.landing) + _size(constants.landing_slope) * arb(constants.guard_radius)
    # Numbers are those of docs/full_order.md, "The inequalities". First inequality 1.
    steps = [
        Inequality("the phase moves on: 0 < its least rate", zero, least),
        Inequality("the dynamics have a denominator: 0 < inertia", zero, arb(constants.inertia)),
        Inequality("0 < radius", zero, radius),
        Inequality("0 < start_strip", zero, arb(constants.start_strip)),
        Inequality("start_strip < 0.05", arb(constants.start_strip), arb("0.05")),
        Inequality("guard_strip < 0.05", arb(constants.guard_strip), arb("0.05")),
        Inequality("0 < crossing", zero, arb(constants.crossing)),
        Inequality("1 - guard_strip < 1 - crossing", before, arb(constants.crossings[0])),
        Inequality("1 + crossing < 1 + guard_strip", arb(constants.crossings[1]), last),
        Inequality("0 < risen", zero, arb(constants.risen)),
        Inequality("risen < 1 - guard_strip", arb(constants.risen), before),
        Inequality("the bound on sqrt(V) is largest at phase 0: 0 < shrink", zero, shrink),
        # Inequality 2.
        Inequality(
            "V decays faster than its bound shrinks: 4 shrink (1 + guard_strip) most pace < gamma",
            4 * shrink * last * most,
            gamma,
        ),
        # Inequality 3.
        Inequality("the bound at the guard < guard_radius", at_guard, arb(constants.guard_radius)),
        # Inequality 5.
        Inequality(
            "an impact lands in the tube: |phase+| < start_strip",
            landing,
            arb(constants.start_strip),
        ),
        # Inequality 4.
        Inequality(
            "outputs after an impact are in the set: sqrt(V+) < radius",
            after_impact(constants),
            kept,
        ),
    ]
    if constants.least_radius != 0.0:
        # 0 < f < R0, of level 5's set (docs/level5.md).
        floor = arb(constants.least_radius)
        steps += [
            Inequality("0 < least radius", zero, floor),
            Inequality("least radius < radius", floor, radius),
        ]
    for barrier in constants.barriers:
        steps += _barrier_inequalities(constants, barrier, gamma)
    return steps


def obstacle(step: Inequality) -> str:
    """Describe an inequality that does not hold, with both of its sides."""
    left, right = (value.str(4, radius=False) for value in (step.left, step.right))
    return f"{step.claim}: {left} against {right}"


def is_norm(constants: FullOrderConstants) -> bool:
    """Return whether S of V = |S dy/w|^2 + ... is an upper triangular matrix with an inverse."""
    joints = joints_of(constants.weights)
    if joints is None:
        return False
    matrix = weighting(constants.weights, joints)
    return all(math.isfinite(w) for w in constants.weights) and all(
        matrix[i][i] != 0.0 for i in range(joints)
    )


def bound_at(constants: FullOrderConstants, phase: arb) -> arb:
    """Bound sqrt(V) in D at a phase."""
    floor = arb(constants.least_radius)
    return floor + (arb(constants.radius) - floor) * (-arb(constants.shrink) * phase**2).exp()


def _barrier_inequalities(
    constants: FullOrderConstants, barrier: BarrierConstants, gamma: arb
) -> list[Inequality]:
    name, zero = barrier.name, arb(0)
    alpha, sigma = arb(barrier.alpha), arb(barrier.sigma)
    if not sigma > 0:
        return [
            Inequality(f"{name}: 0 < epsilon", zero, arb(barrier.epsilon)),
            Inequality(f"{name}: 0 < sigma", zero, sigma),
        ]
    tightened = tightening(barrier)
    lost = arb(barrier.coupling) ** 2 / (4 * sigma * (gamma - alpha))
    return [
        # Inequality 6.
        Inequality(f"{name}: 0 < alpha", zero, alpha),
        Inequality(f"{name}: alpha < gamma", alpha, gamma),
        Inequality(
            f"{name}: between impacts, c_P^2/(4 sigma (gamma - alpha)) + alpha t < epsilon",
            lost + alpha * tightened,
            arb(barrier.epsilon),
        ),
        # Inequality 7.
        Inequality(
            f"{name}: across impacts, sigma V+ < h(z+) - t",
            sigma * after_impact(constants) ** 2,
            inlet(constants, barrier),
        ),
    ]


def tightening(barrier: BarrierConstants) -> arb:
    """Return t = l_P^2 / (4 sigma), with which h >= t + sigma V keeps the reading positive."""
    return arb(barrier.reading) ** 2 / (4 * arb(barrier.sigma))


def inlet(constants: FullOrderConstants, barrier: BarrierConstants) -> arb:
    """Bound h - t from below after any impact of the set."""
    landing_shift = _size(barrier.reset_slope) * arb(constants.guard_radius)
    return arb(barrier.reset) - landing_shift - tightening(barrier)


def _gamma(constants: FullOrderConstants) -> arb:
    rate = lyapunov_rate(constants.bandwidth)
    return arb(fmpq(rate.numerator, rate.denominator))


def after_impact(constants: FullOrderConstants) -> arb:
    """Bound sqrt(V) after any impact of the set."""
    return mismatch(constants) + _size(constants.gain) * arb(constants.guard_radius)


def mismatch(constants: FullOrderConstants) -> arb:
    """Return sqrt(v_sym), the bound on sqrt(V) after an impact from eta = 0."""
    near, far = map(arb, constants.crossings)
    return _size(constants.mismatch) + _size(constants.drift) * (1 - near).max(far - 1)


def _size(bound: float) -> arb:
    """Return the absolute value of a constant that premises use only by its square."""
    return abs(arb(bound))


def least_time(constants: FullOrderConstants) -> arb:
    """Bound the time of a step from below, from the start's strip to the guard's [s]."""
    return (arb(constants.guard_from) - arb(constants.start_strip)) / arb(constants.pace[1])


def step_factor(constants: FullOrderConstants, gamma: arb | None = None) -> arb:
    """Return the factor of r+ = sqrt(v_sym) + factor r, from one impact to the next.

    Args:
        constants: parameters of the set.
        gamma: rate at which V falls [1/s]; that of exact linearisation if None.
    """
    gamma = _gamma(constants) if gamma is None else gamma
    return _size(constants.gain) * (-gamma * least_time(constants) / 2).exp()


def r_end(constants: FullOrderConstants) -> arb:
    """Return the limit of r+ = sqrt(v_sym) + factor r, or the bound after one impact if less."""
    factor = step_factor(constants)
    limit = mismatch(constants) / (1 - factor)
    return limit if factor < 1 and limit < after_impact(constants) else after_impact(constants)
