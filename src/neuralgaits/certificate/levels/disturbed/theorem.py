"""The set D of level 4 under torques that are not exact (level 5): constants and premises.

Outputs obey ddy = -w^2 y - 2 w dy + e, S being that of level 4's norm. Then V' <= -gamma V + 2 b
sqrt(V) |S e| with b = sqrt(1 + STIFF^2) / w, nothing else of the flow changes, and forces and
torques are affine in e. While torques are held, e grows as the outputs' jerk says, which is affine
in e, too. The argument is in docs/level5.md. Needs no JAX.
"""

from collections.abc import Iterator
from dataclasses import dataclass

from neuralgaits.certificate.chart import Corner
from neuralgaits.certificate.levels.full_order.theorem import FullOrderConstants
from neuralgaits.certificate.levels.premises import Premise

REGION = "disturbed"
"""Label of the statements that level 5 rests on beside those of level 4."""

OF_BARRIER = ("alpha", "weight", "lost")


@dataclass(frozen=True)
class DisturbedBarrier:
    """Constants of one barrier h of level 4. Units: those of h, seconds, sqrt(V) in rad.

    Attributes:
        name: of the barrier.
        alpha: gain [1/s].
        weight, lost: dh/dt + alpha h - weight |d(dh/dt)/d xi|^2 - lost >= 0 in the set, the rate
            at eta = 0 and its slope at any eta [s/h, h/s].
    """

    name: str
    alpha: float
    weight: float
    lost: float


@dataclass(frozen=True)
class DisturbedConstants:
    """The constants that level 5 adds to those of level 4.

    Errors may be as large as first + second times the bound on sqrt(V), which falls along the step.

    Attributes:
        push: |S e| at most, in the mean over a hold [rad/s^2, rad/s^2 per rad].
        peak: |S e| at most, at any time, likewise.
        hold: for how long torques are held at most [s]; 0 if nothing is said of that.
        error: |S e| at most when torques are set [rad/s^2].
        jerk: of the outputs while torques are held, |S d^3y/dt^3| at eta = 0 and e = 0 at most
            [rad/s^3].
        jerk_slope: length of its slope in xi at most [rad/s^3 per rad].
        jerk_push: length of its slope in S e at most [1/s].
        barriers: constants of each, in the order of level 4.
    """

    push: tuple[float, float]
    peak: tuple[float, float]
    hold: float
    error: float
    jerk: float
    jerk_slope: float
    jerk_push: float
    barriers: tuple[DisturbedBarrier, ...]


def series(shape: DisturbedConstants) -> dict[str, tuple[float, ...]]:
    """All that margins have in them in lists: the Program has them as constants of these names."""
    rows = tuple(getattr(barrier, name) for barrier in shape.barriers for name in OF_BARRIER)
    found = {"peak": shape.peak, "barriers": rows}
    jerk = shape.jerk, shape.jerk_slope, shape.jerk_push
    return found | ({"jerk": jerk} if shape.hold != 0.0 else {})


def premises(full: FullOrderConstants, shape: DisturbedConstants) -> list[Premise]:
    """What the conclusion rests on beside level 4, all of it on level 4's tube."""
    first, last = full.ends
    tube = (first, 0.0), (last, 1.0)
    found = [Premise("disturbed/contact", *tube), Premise("disturbed/torque", *tube)]
    found += [
        Premise(f"disturbed/decrease {barrier.name}", *tube, sign="not negative")
        for barrier in shape.barriers
    ]
    if shape.hold != 0.0:
        held = ("disturbed/jerk", "disturbed/jerk-slope", "disturbed/jerk-push")
        found += [Premise(name, *tube, sign="not negative") for name in held]
    return found


def labelled_premises(
    full: FullOrderConstants, shape: DisturbedConstants
) -> Iterator[tuple[str, str, Corner, Corner]]:
    """(label, output, low, high) of all of them."""
    for output, low, high, _ in premises(full, shape):
        yield REGION, output, low, high
