"""The paper's Theorem 5 made computable (level 4): its constants, premises and conclusion.

Outputs obey eta' = A eta exactly; V = |xi|^2 decays at least at the rate gamma. The set is

    D = {z in the tube, h_i(z) - t_i >= sigma_i V for all i, sqrt(V) <= bound(phase), foot up},

its barriers h_i being the level above the lower fence, the level below the upper fence, and the
spec's own barrier functions, tightened by t_i because outputs off zero change their readings. Each
number of `FullOrderConstants` is a claim; the premises, outputs of the Program that must not be
negative, prove it. `inequalities` does the arithmetic from the constants to the theorem, in balls.
The argument is in docs/full_order_proof.md. Needs no JAX.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction

from neuralgaits.certificate.chart import Chart, Corner
from neuralgaits.certificate.premises import Premise

FENCES = LOWER, UPPER = "level-lower", "level-upper"
"""Names of the two fences as barriers, which read z alone."""

REGION = "full order"
"""Label of the statements that level 4 rests on."""

BARRIER_CONSTANTS = ("alpha", "epsilon", "coupling", "reading", "reset", "reset_slope")
"""Names of a barrier's numbers that margins read; they do not read sigma."""

STIFF = Fraction(2)
"""Weight in V = (dy/w)^2 + STIFF^2 (y + dy/w)^2 of each joint. Powers of two keep the change of
coordinates exact; among those tried this one allows the largest errors that the contact and torque
limits of the default gaits stand."""
DECAY = Fraction(3, 2)
"""Rate at which that V decays, in units of w."""


@dataclass(frozen=True)
class BarrierConstants:
    """Constants of one barrier h. Units: those of h (level: 1), seconds, sqrt(V) in rad.

    Attributes:
        name: name of the barrier.
        alpha: gain [1/s].
        epsilon: dh/dt + alpha h >= epsilon on the zero dynamics [h/s].
        coupling: bound on |d(dh/dt)/d xi| [h/(s rad)].
        reading: bound on |d h/d xi| of h as it is read on the robot [h/rad]; 0 for fences.
        reset: h after an impact from eta = 0 is at least this [h].
        reset_slope: bound on |d h+/d xi| along the guard [h/rad].
        sigma: the weight of V [h/rad^2].
    """

    name: str
    alpha: float
    epsilon: float
    coupling: float
    reading: float
    reset: float
    reset_slope: float
    sigma: float


@dataclass(frozen=True)
class FullOrderConstants:
    """The set D and every constant of the theorem.

    Attributes:
        bandwidth: w, the double pole of the outputs [rad/s].
        radius: bound on sqrt(V) at phase 0 [rad].
        shrink: at other phases the bound is floor + (radius - floor) exp(-shrink phase^2) [1].
        guard_radius: the same bound where the guard's strip begins, rounded up [rad].
        start_strip, guard_strip: phases by which the tube is longer at either end.
        crossing: phases around phase 1 within which the foot meets the ground at eta = 0.
        risen: until this phase the swing foot rises; from it to the guard it is up.
        pace: least and most rate of the phase [1/s].
        inertia: least -J.s, the denominator of the dynamics [kg m].
        mismatch: bound on sqrt(V) after an impact from eta = 0 at phase 1 [rad].
        drift: its largest change per phase, within `crossing` of phase 1 [rad].
        gain: L_D, growth of sqrt(V) across an impact.
        landing: largest |phase| after an impact from eta = 0.
        landing_slope: its change per sqrt(V) along the guard [1/rad].
        barriers: constants of each barrier.
        least_radius: the floor to which the bound on sqrt(V) shrinks [rad].
        weights: S of the norm, an upper triangular matrix over the joints, row by row from its
            diagonal on; the identity if empty. V = |S dy/w|^2 + STIFF^2 |S (y + dy/w)|^2.
    """

    bandwidth: float
    radius: float
    shrink: float
    guard_radius: float
    start_strip: float
    guard_strip: float
    crossing: float
    risen: float
    pace: tuple[float, float]
    inertia: float
    mismatch: float
    drift: float
    gain: float
    landing: float
    landing_slope: float
    barriers: tuple[BarrierConstants, ...]
    least_radius: float = 0.0
    weights: tuple[float, ...] = ()

    @property
    def ends(self) -> tuple[float, float]:
        """First and last phase, as doubles: the edges of boxes, which inequalities use, too."""
        return -self.start_strip, 1.0 + self.guard_strip

    @property
    def guard_from(self) -> float:
        """Phase at which the guard's strip begins, as a double."""
        return 1.0 - self.guard_strip

    @property
    def crossings(self) -> tuple[float, float]:
        """Phases between which the foot meets the ground at eta = 0, as doubles."""
        return 1.0 - self.crossing, 1.0 + self.crossing


def refusal(chart: Chart, floor: float) -> str | None:
    """Explain why levels 4 and 5 do not cover a chart with this floor uncertainty [m]; or None."""
    if chart.parameters:
        others = ", ".join(axis.name for axis in chart.parameters)
        return f"it is about one gait of one robot, without axes of {others}"
    if floor:
        return "it is about footholds that lie where they are meant to"
    return None


def constants_of_set(constants: FullOrderConstants) -> dict[str, float]:
    """Return the set's numbers that margins read, by name."""
    alone = "bandwidth radius shrink guard_radius inertia mismatch drift gain landing landing_slope"
    least, most = constants.pace
    constants_by_name = {n: getattr(constants, n) for n in alone.split()} | {
        "slowest": least,
        "fastest": most,
    }
    # A bound without a floor has none in its Program.
    return constants_by_name | (
        {"floor": constants.least_radius} if constants.least_radius != 0.0 else {}
    )


def series(constants: FullOrderConstants) -> dict[str, tuple[float, ...]]:
    """Return all numbers that margins read, as lists named like the Program's constants."""
    rows = tuple(
        getattr(barrier, name) for barrier in constants.barriers for name in BARRIER_CONSTANTS
    )
    constants_by_name = {"set": tuple(constants_of_set(constants).values()), "barriers": rows}
    return constants_by_name | ({"weights": constants.weights} if constants.weights else {})


def weighting(weights: Sequence[float], joints: int) -> list[list[float]]:
    """Return the matrix S, zeros included. Raises: ValueError if the weights are no triangle."""
    if not weights:
        return [[float(i == j) for j in range(joints)] for i in range(joints)]
    if len(weights) != joints * (joints + 1) // 2:
        raise ValueError(f"{len(weights)} weights of {joints} joints")
    rest = iter(weights)
    return [[next(rest) if j >= i else 0.0 for j in range(joints)] for i in range(joints)]


def joints_of(weights: Sequence[float]) -> int | None:
    """Return how many joints some weights are for; None if they are no triangle."""
    count = math.isqrt(2 * len(weights))
    return count if 2 * len(weights) == count * (count + 1) else None


def lyapunov(bandwidth: float) -> tuple[tuple[Fraction, Fraction], tuple[Fraction, Fraction]]:
    """Return P of one joint, V = (y, dy) P (y, dy). Exact."""
    w = Fraction(bandwidth)
    square = STIFF * STIFF
    return (square, square / w), (square / w, (1 + square) / (w * w))


def lyapunov_rate(bandwidth: float) -> Fraction:
    """Return the rate gamma at which V falls at least [1/s]."""
    return DECAY * Fraction(bandwidth)


def decays(bandwidth: float) -> bool:
    """Return whether A^T P + P A <= -gamma P with P > 0, in rationals.

    A is the matrix of ddy = -w^2 y - 2 w dy.
    """
    if not bandwidth > 0.0:
        return False
    w, gamma = Fraction(bandwidth), lyapunov_rate(bandwidth)
    (p11, p12), (_, p22) = lyapunov(bandwidth)
    # A = [[0, 1], [-w^2, -2 w]]; entries of -(A^T P + P A + gamma P).
    q11 = 2 * w * w * p12 - gamma * p11
    q12 = -(p11 - 2 * w * p12 - w * w * p22 + gamma * p12)
    q22 = -(2 * p12 - 4 * w * p22 + gamma * p22)
    positive = p11 > 0 and p11 * p22 > p12 * p12
    return positive and q11 >= 0 and q22 >= 0 and q11 * q22 >= q12 * q12


def premises(constants: FullOrderConstants) -> list[Premise]:
    """Return the premises of level 4."""
    first, last = constants.ends
    before, (near, far) = constants.guard_from, constants.crossings
    tube = (first, 0.0), (last, 1.0)
    strip = (before, 0.0), (last, 1.0)
    crossing = (near, 0.0), (far, 1.0)
    rows = [
        Premise("full/pace", *tube),
        Premise("full/inertia", *tube),
        Premise("full/contact", *tube),
        Premise("full/torque", *tube),
        Premise("full/foot-rises", (first, 0.0), (constants.risen, 1.0)),
        Premise("full/foot-above", (constants.risen, 0.0), (before, 1.0)),
        Premise("full/foot-below", (last, 0.0), (last, 1.0)),
        Premise("full/crossing-before", (near, 0.0), (near, 1.0)),
        Premise("full/crossing-behind", (far, 0.0), (far, 1.0)),
        Premise("full/guard-slope", *strip),
        Premise("full/foot-falls", *strip),
        Premise("full/impulse", *strip),
        Premise("full/gain", *strip, sign="not negative"),
        Premise("full/landing-slope", *strip, sign="not negative"),
        Premise("full/momentum-after", *strip),
        Premise("full/mismatch", (1.0, 0.0), (1.0, 1.0), sign="not negative"),
        Premise("full/drift", *crossing, sign="not negative"),
        Premise("full/landing", *crossing, sign="not negative"),
    ]
    for barrier in constants.barriers:
        name = barrier.name
        rows += [
            Premise(f"full/rate {name}", *tube, sign="not negative"),
            Premise(f"full/coupling {name}", *tube, sign="not negative"),
            Premise(f"full/reset {name}", *crossing, sign="not negative"),
            Premise(f"full/reset-slope {name}", *strip, sign="not negative"),
        ]
        if name not in FENCES:
            rows.append(Premise(f"full/reading {name}", *tube, sign="not negative"))
    return rows


def labelled_premises(constants: FullOrderConstants) -> Iterator[tuple[str, str, Corner, Corner]]:
    """Return (label, output, low, high) of every premise of level 4."""
    for output, low, high, _ in premises(constants):
        yield REGION, output, low, high
