"""Constants and premises of level 5: the set D of level 4 under torques that are not exact.

Outputs obey ddy = -w^2 y - 2 w dy + e, S being that of level 4's norm. Then V' <= -gamma V + 2 b
sqrt(V) |S e| with b = sqrt(1 + STIFF^2) / w, nothing else of the flow changes, and forces and
torques are affine in e. While torques are held, the outputs' jerk decides how e grows; it is affine
in e, too. The argument is in docs/level5_proof.md. Needs no JAX.
"""

from collections.abc import Iterator
from dataclasses import dataclass

from neuralgaits.certificate.chart import Corner
from neuralgaits.certificate.levels.disturbed.model_theorem import (
    MODEL_LENGTHS,
    MODEL_SERIES,
    model_premises,
)
from neuralgaits.certificate.levels.full_order.theorem import FullOrderConstants
from neuralgaits.certificate.premises import Premise

REGION = "disturbed"
"""Label of the statements that level 5 rests on beside those of level 4."""

BARRIER_CONSTANTS = ("alpha", "weight", "lost")


@dataclass(frozen=True)
class DisturbedBarrier:
    """Constants of one barrier h of level 4. Units: those of h, seconds, sqrt(V) in rad.

    Attributes:
        name: name of the barrier.
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
    """Constants that level 5 adds to those of level 4.

    Errors may be as large as first + second times the bound on sqrt(V), which falls along the step.

    Attributes:
        push: bound on |S e| in the mean over a hold [rad/s^2, rad/s^2 per rad].
        peak: bound on |S e| at any time, in the same units.
        hold: longest time for which torques are held [s]; 0 if holds are left out.
        error: bound on |S e| when torques are set [rad/s^2].
        jerk: bound on the outputs' jerk |S d^3y/dt^3| under held torques, at eta = 0 and e = 0
            [rad/s^3].
        growth_slope: bound on a slope in xi under held torques, at e = 0: of the jerk under exact
            linearisation, of S de/dt under scheduled PD [rad/s^3 per rad].
        jerk_push: bound on the length of the jerk's slope in S e [1/s].
        barriers: constants of each barrier, in the order of level 4.
        kick: bound on |S e| right after an impact from xi = 0, under the torque from before it,
            where that was exact [rad/s^2]. This and the rest are 0 if there is a tick at each
            touchdown.
        kick_slope: bound on the length of its slope in xi [rad/s^2 per rad].
        kick_push: bound on the length of its slope in the S e from before [1].
        kick_peak: bound on |S e| from an impact to the next tick [rad/s^2].
        kick_end: phase that is not reached before that tick.
        torque_gains: coefficients of the feed-forward torque of `gait.scheduled_gains`, flattened,
            if the law is scheduled PD [N m]; empty for exact linearisation.
        inertia_gains: gains of its inertia [kg m^2].
        decay: V' <= -decay V under that law, but for `rest` [1/s].
        rest: bound on |S e| of that law at eta = 0 [rad/s^2].
        state_error: bounds on the error of each angle and of each rate of the state that torques
            are computed from (rad, rad/s); empty, like the rest, if that state is the true one.
        state_axes: half axes of an ellipsoid that holds such errors of (q, dq) (rad, rad/s).
        state_moves: such an error moves phase, level and xi by less [1, 1, rad].
        state_radius: states between a true and a measured one have sqrt(V) up to this above the
            bound at their phase [rad].
        state_slopes: bounds on |S e| of torques of such states, to first order [rad/s^2], and on
            its growth with itself [1].
        model_box: errors of the file's masses [1], centres of mass along and across [m] and
            inertias [1], of each type of link; empty, like the rest, if the robot is the file's.
        model_axes: half axes of an ellipsoid that holds the shares of `LinkShares` (1, m, m^2).
        model_metric: Q of rates and accelerations that other robots have more of, an upper
            triangular matrix over the coordinates, row by row from its diagonal on.
        model_moves: bounds on what such shares add to each of `Moves`, under exact torques, where
            outputs are zero.
        model_moves_slope: bounds on the slopes of these in xi [per rad].
        model_pushes: bounds on their slopes in S e [per rad/s^2].
        model_feeds: bounds on what a unit of Q ddq adds to acceleration, output, momentum, pace and
            contact of `Feeds`.
        model_errors: bounds on the slope of S e in Q dq at a constant torque, on its growth with
            S e, and on the slope of the slacks of contact in Q ddq.
        model_slopes: bounds on the slope of each barrier in z2 [h s/(kg m^2)], where a step starts.
        model_curvature: bounds on second derivatives of xi in the rate of z1 and z2, and in z2
            twice, as in `output_curvature`.
        model_impacts: bounds on what shares add to each of `Landed`, where outputs are zero.
        model_impacts_slope: bounds on the slopes of these in xi [per rad].
        model_impulses: bounds on the slopes of the impulse's slacks in Q dq after an impact, and of
            their slopes in shares.
        model_peaks: bounds on what shares add to Q ddq under any error, and to Q dq in an impact.
    """

    push: tuple[float, float]
    peak: tuple[float, float]
    hold: float
    error: float
    jerk: float
    growth_slope: float
    jerk_push: float
    barriers: tuple[DisturbedBarrier, ...]
    kick: float = 0.0
    kick_slope: float = 0.0
    kick_push: float = 0.0
    kick_peak: float = 0.0
    kick_end: float = 0.0
    torque_gains: tuple[float, ...] = ()
    inertia_gains: tuple[float, ...] = ()
    decay: float = 0.0
    rest: float = 0.0
    state_error: tuple[float, ...] = ()
    state_axes: tuple[float, ...] = ()
    state_moves: tuple[float, ...] = ()
    state_radius: float = 0.0
    state_slopes: tuple[float, ...] = ()
    model_box: tuple[float, ...] = ()
    model_axes: tuple[float, ...] = ()
    model_metric: tuple[float, ...] = ()
    model_moves: tuple[float, ...] = ()
    model_moves_slope: tuple[float, ...] = ()
    model_pushes: tuple[float, ...] = ()
    model_feeds: tuple[float, ...] = ()
    model_errors: tuple[float, ...] = ()
    model_slopes: tuple[float, ...] = ()
    model_curvature: tuple[float, ...] = ()
    model_impacts: tuple[float, ...] = ()
    model_impacts_slope: tuple[float, ...] = ()
    model_impulses: tuple[float, ...] = ()
    model_peaks: tuple[float, ...] = ()

    def __post_init__(self):
        """Refuse lists of other lengths. Raises: ValueError."""
        lists = self.state_error, self.state_moves, self.state_slopes
        lengths = tuple(map(len, lists))
        if lengths != ((2, 3, 2) if self.state_axes else (0, 0, 0)):
            raise ValueError(
                "errors of a measured state without two bounds, three moves, two slopes"
            )
        lengths = {name: len(getattr(self, name)) for name in MODEL_LENGTHS}
        if lengths != (MODEL_LENGTHS if self.model_axes else dict.fromkeys(lengths, 0)):
            raise ValueError("errors of the model without their bounds")
        if len(self.model_slopes) != (len(self.barriers) if self.model_axes else 0):
            raise ValueError("errors of the model without a slope of each barrier")

    @property
    def scheduled(self) -> bool:
        """Return whether the law is scheduled PD, and not exact linearisation."""
        return bool(self.torque_gains)

    @property
    def free_clock(self) -> bool:
        """Return whether ticks may miss touchdowns."""
        return self.kick_end != 0.0

    @property
    def measured(self) -> bool:
        """Return whether torques are of a measured state, and not of the true one."""
        return bool(self.state_error)

    @property
    def of_other_robots(self) -> bool:
        """Return whether the robot may have other links than the file's."""
        return bool(self.model_box)


def slope_output(exact: bool) -> str:
    """Return the name of the premise about `growth_slope`, under exact linearisation or not."""
    return "disturbed/jerk-slope" if exact else "disturbed/growth-slope"


def series(disturbed: DisturbedConstants) -> dict[str, tuple[float, ...]]:
    """Return the lists of numbers that margins read, named like the Program's constants."""
    rows = tuple(
        getattr(barrier, name) for barrier in disturbed.barriers for name in BARRIER_CONSTANTS
    )
    lists = {"peak": disturbed.peak, "barriers": rows}
    if disturbed.hold != 0.0:
        lists["jerk"] = disturbed.jerk, disturbed.growth_slope, disturbed.jerk_push
    if disturbed.scheduled:
        lists["law"] = disturbed.decay, disturbed.rest
        lists["torque_gains"], lists["inertia_gains"] = (
            disturbed.torque_gains,
            disturbed.inertia_gains,
        )
    if disturbed.free_clock:
        lists["kick"] = (
            disturbed.kick,
            disturbed.kick_slope,
            disturbed.kick_push,
            disturbed.kick_peak,
        )
    if disturbed.measured:
        lists["state_axes"] = disturbed.state_axes
        lists["state_moves"] = *disturbed.state_moves, disturbed.state_radius
        lists["state_slopes"] = disturbed.state_slopes
    if disturbed.of_other_robots:
        lists |= {name: getattr(disturbed, name) for name in MODEL_SERIES}
    return lists


def wider_tube(full: FullOrderConstants, disturbed: DisturbedConstants) -> tuple[Corner, Corner]:
    """Return the corners of the tube that measured states are in, but for rounding."""
    first, last = full.ends
    phase, level, _ = disturbed.state_moves or (0.0, 0.0, 0.0)
    return (first - phase, -level), (last + phase, 1.0 + level)


def premises(full: FullOrderConstants, disturbed: DisturbedConstants) -> list[Premise]:
    """Return the premises of level 5 beside level 4."""
    first, last = full.ends
    tube, strip = ((first, 0.0), (last, 1.0)), ((full.guard_from, 0.0), (last, 1.0))
    required = [Premise("disturbed/contact", *tube), Premise("disturbed/torque", *tube)]
    required += [
        Premise(f"disturbed/decrease {barrier.name}", *tube, sign="not negative")
        for barrier in disturbed.barriers
    ]
    if disturbed.scheduled:
        required += [
            Premise("disturbed/decay", *tube),
            Premise("disturbed/rest", *tube, sign="not negative"),
        ]
    if disturbed.hold != 0.0:
        required += [
            Premise("disturbed/jerk", *tube, sign="not negative"),
            Premise(slope_output(not disturbed.scheduled), *tube),
            Premise("disturbed/jerk-push", *tube, sign="not negative"),
        ]
    if disturbed.free_clock:
        required += [
            Premise("disturbed/kick", *strip, sign="not negative"),
            Premise("disturbed/kick-slope", *strip, sign="not negative"),
            Premise("disturbed/kick-push", *strip, sign="not negative"),
            Premise("disturbed/kick-contact", (first, 0.0), (disturbed.kick_end, 1.0)),
        ]
    if disturbed.measured:
        required += [
            Premise("disturbed/state-moves", *tube),
            Premise("disturbed/state-error", *tube, sign="not negative"),
            Premise("disturbed/state-growth", *tube, sign="not negative"),
        ]
    if disturbed.of_other_robots:
        names = (barrier.name for barrier in disturbed.barriers)
        required += model_premises(full, names, disturbed.kick_end)
    return required


def labelled_premises(
    full: FullOrderConstants, disturbed: DisturbedConstants
) -> Iterator[tuple[str, str, Corner, Corner]]:
    """Return (label, output, low, high) of all premises."""
    for output, low, high, _ in premises(full, disturbed):
        yield REGION, output, low, high
