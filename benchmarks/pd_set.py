"""How far `pd` is from a level 5 of its own: the best quadratic V that was found, at points.

In continuous time `pd` gives the outputs ddy = -M^-1 (K_p y + K_d dy), M the inertia that the
joints feel. A set like D needs one V = |L eta|^2 that falls for every M along the step, an impact
that does not enlarge it by more than a step lets it shrink, and room for what held torques make of
it. Looked for is the L for which torques could be held the longest. Nothing here is a proof: a
larger number than what is printed would need a better L, a proof would need bounds in place of
points.

BANDWIDTHS=45,60,80 are w of the gains (45 is what `pd` has for AMBER-3M), TRIES the evaluations.
"""

import math
import os
from collections.abc import Callable

import numpy as np
from common import show, trained
from scipy.optimize import minimize

from neuralgaits.barriers import Gait
from neuralgaits.certificate.levels.full_order.model import BANDWIDTH, FullOrderModel
from neuralgaits.certificate.levels.full_order.norm_plans import FULL, HELD_SPARE, IMPACT, STRIP
from neuralgaits.certificate.levels.full_order.sample_evaluators import evaluators_of, sample_gait
from neuralgaits.certificate.levels.full_order.samples import GaitSamples
from neuralgaits.control.pd import Pd
from neuralgaits.gait.joint_inertia import JointResponse
from neuralgaits.robots import load_robot

BANDWIDTHS = tuple(map(float, os.environ.get("BANDWIDTHS", "45,60,80,110").split(",")))
TRIES = int(os.environ.get("TRIES", "6000"))
ASKED_S = 2e-3
"""The policy is asked at 500 Hz."""


class Closed:
    """The outputs under PD at points of the step, in plain (y, dy)."""

    def __init__(self, robot, seen: GaitSamples, push_torque: np.ndarray, w: float):
        law, m = Pd(bandwidth=w).with_gains_for(JointResponse(robot)), len(seen.inertia)
        limits = np.asarray(robot.torque_limit)
        self.m, self.seen = m, seen
        inertia = push_torque * limits[:, None]
        gains = np.concatenate([np.diag(law.stiffness), np.diag(law.damping)], axis=1)
        low = -np.linalg.solve(inertia, np.broadcast_to(gains, (len(inertia), m, 2 * m)))
        self.flow = np.zeros((len(low), 2 * m, 2 * m))
        self.flow[:, :m, m:], self.flow[:, m:] = np.eye(m), low
        eye, zero = np.eye(m), np.zeros((m, m))
        # xi of w = BANDWIDTH from eta, and what exact linearisation has in place of `low`.
        scaled = np.block([[zero, eye / BANDWIDTH], [2.0 * eye, 2.0 * eye / BANDWIDTH]])
        exact = np.concatenate([-(BANDWIDTH**2) * eye, -2.0 * BANDWIDTH * eye], axis=1)
        value, slope, pushed = seen.slack
        self.value, self.pushed = value, pushed
        self.slope = slope @ scaled + pushed @ (low - exact)
        still, along, moved = seen.jerk
        self.still = still
        self.along = along @ scaled + moved @ (low - exact) - low @ self.flow
        self.moved = moved - low[:, :, m:]
        self.impact = np.linalg.inv(scaled) @ seen.after @ scaled

    def decay(self, factor: np.ndarray) -> float:
        """Gamma of V = |factor eta|^2 [1/s]."""
        inside = factor @ self.flow @ np.linalg.inv(factor)
        return -float(np.linalg.eigvalsh(inside + inside.transpose(0, 2, 1)).max())

    def gain(self, factor: np.ndarray) -> float:
        """L_D in this norm."""
        inside = factor @ self.impact @ np.linalg.inv(factor)
        return IMPACT * float(np.sqrt((inside**2).sum(axis=(1, 2)).max()))

    def hold(self, factor: np.ndarray) -> float:
        """For how long torques could be held [s]; a negative number if there is no set."""
        gamma, gain = self.decay(factor), self.gain(factor)
        if gamma <= 0.0:
            return -10.0 + 0.01 * gamma
        left = math.exp(-self.shrink(gamma) * STRIP**2)
        if 1.1 * gain * left / FULL >= 0.9:
            return -gain * left
        low, high = 0.0, 4e-3
        for _ in range(12):
            middle = 0.5 * (low + high)
            low, high = (middle, high) if self.fits(factor, gamma, gain, middle) else (low, middle)
        return low

    def shrink(self, gamma: float) -> float:
        """How fast the bound on sqrt(V) may fall."""
        return gamma / (4.25 * 1.1 * self.seen.pace)

    def fits(self, factor: np.ndarray, gamma: float, gain: float, hold: float) -> bool:
        """Whether floor, impact, contact and torques leave room for a hold."""
        back, rates = np.linalg.inv(factor), factor[:, self.m :]
        mean = 0.5 * hold * (1.0 + gamma * hold / 8.0)
        still = np.linalg.norm(self.still @ rates.T, axis=-1).max()
        along = np.linalg.norm(rates @ self.along @ back, 2, axis=(1, 2)).max()
        gram = np.linalg.cholesky(rates.T @ rates).T
        inverse = np.linalg.inv(gram)
        moved = np.linalg.norm(gram @ self.moved @ inverse, 2, axis=(1, 2)).max()
        slower = gamma - 2.0 * mean * along
        if slower <= 0.0 or hold * moved >= 0.5:
            return False
        shape = np.exp(-self.shrink(slower) * self.seen.phase**2)
        left = math.exp(-self.shrink(slower) * STRIP**2)
        growth = 1.1 * max(gain, 1.1) / FULL
        if growth * left >= 0.9:
            return False
        floor = radius = 0.0
        peak = hold * still
        for _ in range(3):
            floor = 1.04 * 2.0 * mean * (still + moved * peak) / slower
            radius = growth * floor * (1.0 - left) / (1.0 - growth * left)
            peak = hold * (still + moved * peak + along * radius)
        bound = floor + (radius - floor) * shape
        error = hold * (still + moved * peak + along * bound)
        takes = bound[:, None] * np.linalg.norm(self.slope @ back, axis=-1)
        takes += error[:, None] * np.linalg.norm(self.pushed @ inverse, axis=-1)
        return bool((HELD_SPARE * takes <= self.value).all())


def triangle(x: np.ndarray, size: int) -> np.ndarray:
    """An upper triangular matrix of its elements, exponentials on the diagonal."""
    found = np.zeros((size, size))
    found[np.triu_indices(size)] = x
    found[np.diag_indices(size)] = np.exp(np.diagonal(found))
    return found


def usual(m: int, w: float) -> np.ndarray:
    """The factor of level 4."""
    eye = np.eye(m)
    square = np.block([[4.0 * eye, 4.0 * eye / w], [4.0 * eye / w, 5.0 * eye / w**2]])
    return np.linalg.cholesky(square).T


def best(
    closed: Closed, w: float, first: np.ndarray, worth: Callable[[np.ndarray], float]
) -> np.ndarray:
    """The factor that is worth most, looked for from another one."""
    m, x = closed.m, first.copy()
    x[np.diag_indices(2 * m)] = np.log(np.diagonal(first))
    x = x[np.triu_indices(2 * m)]
    # Rates are worth 1/w of angles.
    scale = np.outer(np.ones(2 * m), np.r_[np.ones(m), np.full(m, 1.0 / w)])
    scale[np.diag_indices(2 * m)] = 1.0
    unit = scale[np.triu_indices(2 * m)]
    at = x / unit
    for _ in range(3):
        found = minimize(
            lambda v: -worth(triangle(v * unit, 2 * m)),
            at,
            method="Nelder-Mead",
            options={"maxfev": TRIES // 3, "adaptive": True},
        )
        at = found.x
    return triangle(at * unit, 2 * m)


def main() -> None:
    """Print the best decay, the gain at impacts and the longest hold for each bandwidth."""
    robot = load_robot("amber3m")
    run = trained("amber3m", seed=0)
    assert isinstance(run.gait, Gait)
    looks = evaluators_of(FullOrderModel(run.robot, run.gait, run.spec, BANDWIDTH))
    seen = sample_gait(looks)
    assert seen is not None
    m = len(seen.inertia)
    names = seen.slack[2].shape[1] - 2 - 2 * m
    push_torque = seen.slack[2][:, names + m : names + 2 * m]
    for w in BANDWIDTHS:
        closed = Closed(robot, seen, push_torque, w)
        slowest = -float(np.linalg.eigvals(closed.flow).real.max())
        falls = best(closed, w, usual(m, w), closed.decay)
        holds = best(closed, w, falls, lambda factor, its=closed: 1e3 * its.hold(factor))
        gamma, gain = closed.decay(holds), closed.gain(holds)
        hold = closed.hold(holds)
        left = gain * math.exp(-closed.shrink(max(gamma, 0.0)) * STRIP**2)
        show(f"pd, w = {w:g}: slowest mode at any point [1/s]", slowest)
        show("  largest decay gamma of one V over the step [1/s]", closed.decay(falls))
        show("  its gain at an impact, L_D", closed.gain(falls))
        show("  V for the longest hold: gamma [1/s], L_D", f"{gamma:.1f}, {gain:.1f}")
        show("  L_D times what a step leaves (below 0.8 is needed)", left)
        show(f"  longest hold [ms] (asked {1e3 * ASKED_S:g})", 1e3 * hold)


if __name__ == "__main__":
    main()
