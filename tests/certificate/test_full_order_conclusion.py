"""The arithmetic of the full-order theorem: exact where it can be, tight where it must be."""

from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest

from neuralgaits.certificate.levels.full_order import theorem as full_order_theorem
from neuralgaits.certificate.levels.full_order.conclude import conclude_full_order
from neuralgaits.certificate.levels.full_order.inequalities import inequalities
from neuralgaits.certificate.levels.full_order.theorem import (
    BarrierConstants,
    FullOrderConstants,
    decays,
    lyapunov,
    lyapunov_rate,
    premises,
)
from neuralgaits.certificate.levels.full_order.words import constant_rows
from support.full_order_shape import FENCE, SHAPE, TORSO, UPPER

PROVED = {(p.output, p.low, p.high): 0.1 for p in premises(SHAPE)}


def _with(barrier: BarrierConstants, **changes: float) -> FullOrderConstants:
    moved = replace(barrier, **changes)
    return replace(SHAPE, barriers=tuple(moved if b is barrier else b for b in SHAPE.barriers))


def _verdict(shape: FullOrderConstants):
    bounds = {(p.output, p.low, p.high): 0.1 for p in premises(shape)}
    return conclude_full_order(shape, bounds)


@pytest.mark.parametrize(
    "barriers", [(FENCE, TORSO), (FENCE, UPPER, replace(TORSO, name=UPPER.name))]
)
def test_both_fences_and_names_of_their_own_are_needed(barriers):
    found = _verdict(replace(SHAPE, barriers=barriers))
    assert found.verdict == "undecided"
    assert "two fences" in str(found.reason)


def test_constants_that_fit_and_proved_premises_are_a_proof():
    found = conclude_full_order(SHAPE, PROVED)
    assert (found.verdict, found.reason) == ("proved", None)
    assert len(found.words) == 3
    assert found.figures["gamma"] == 45.0


@pytest.mark.parametrize("premise", premises(SHAPE), ids=lambda p: f"{p.output} {p.low}")
def test_no_premise_can_be_left_out(premise):
    key = premise.output, premise.low, premise.high
    without = {name: bound for name, bound in PROVED.items() if name != key}
    too_low = 0.0 if premise.sign == "positive" else -1e-12
    for bounds in (without, PROVED | {key: too_low}, PROVED | {key: float("nan")}):
        found = conclude_full_order(SHAPE, bounds)
        assert found.verdict == "undecided"
        assert premise.output in found.reason


@pytest.mark.parametrize(
    ("shape", "reason"),
    [
        (replace(SHAPE, shrink=3.5), "decays faster"),
        (replace(SHAPE, shrink=1.0), "guard_radius"),
        (replace(SHAPE, guard_radius=3e-4), "guard_radius"),
        (replace(SHAPE, shrink=-0.5), "largest at phase 0"),
        (replace(SHAPE, gain=25.0), "sqrt(V+) < radius"),
        (replace(SHAPE, gain=-25.0), "sqrt(V+) < radius"),
        (replace(SHAPE, mismatch=-0.01), "sqrt(V+) < radius"),
        (replace(SHAPE, drift=-1e7), "sqrt(V+) < radius"),
        (replace(SHAPE, landing_slope=-9.0), "lands in the tube"),
        (_with(FENCE, reset_slope=-200.0), "across impacts"),
        (replace(SHAPE, mismatch=0.01), "sqrt(V+) < radius"),
        (replace(SHAPE, drift=1e7), "sqrt(V+) < radius"),
        (replace(SHAPE, landing=0.01), "lands in the tube"),
        (replace(SHAPE, landing_slope=9.0), "lands in the tube"),
        (replace(SHAPE, crossing=0.01), "1 - guard_strip < 1 - crossing"),
        (replace(SHAPE, pace=(0.0, 3.26)), "0 < its least rate"),
        (replace(SHAPE, pace=(0.9, 4.0)), "decays faster"),
        (replace(SHAPE, inertia=0.0), "denominator"),
        (replace(SHAPE, radius=float("nan")), "0 < radius"),
        (replace(SHAPE, bandwidth=20.0), "decays faster"),
        (_with(FENCE, alpha=50.0), "alpha < gamma"),
        (_with(FENCE, sigma=70.0), "between impacts"),
        (_with(FENCE, epsilon=0.01), "between impacts"),
        (_with(FENCE, sigma=1e5), "across impacts"),
        (_with(FENCE, reset=0.003), "across impacts"),
        (_with(FENCE, sigma=0.0), "0 < sigma"),
        (_with(TORSO, reading=4.0), "between impacts"),
        (_with(TORSO, reset=0.005), "across impacts"),
    ],
)
def test_a_constant_that_does_not_fit_is_the_obstacle(shape, reason):
    found = _verdict(shape)
    assert found.verdict == "undecided"
    assert found.reason is not None
    assert reason in found.reason
    assert " against " in found.reason


def test_outputs_shrink_from_impact_to_impact_as_the_figures_say():
    """The worst that the constants allow, r+ = sqrt(v_sym) + L_D exp(-gamma T / 2) r."""
    figures = conclude_full_order(SHAPE, PROVED).figures
    least_time = (1.0 - SHAPE.guard_strip - SHAPE.start_strip) / SHAPE.pace[1]
    assert figures["T_min"] == pytest.approx(least_time, rel=1e-12)
    assert figures["T_min"] < least_time
    root = SHAPE.radius
    for _ in range(20):
        root = figures["sqrt v_sym"] + SHAPE.gain * np.exp(-22.5 * least_time) * root
    assert root == pytest.approx(figures["r_end"], rel=1e-9)
    assert root <= figures["r_end"]


@pytest.mark.parametrize("bandwidth", [30.0, 7.3, 1e3])
def test_the_lyapunov_function_is_right_in_rationals(bandwidth):
    """Eigenvalues of P and of -(A^T P + P A + gamma P), from NumPy, agree with the verdict."""
    assert decays(bandwidth)
    w, p = bandwidth, np.array(lyapunov(bandwidth), dtype=float)
    scale = np.diag([1.0, w])  # (y, dy/w): both of one size.
    a = np.array([[0.0, 1.0], [-w * w, -2.0 * w]])
    left = -(a.T @ p + p @ a + float(lyapunov_rate(bandwidth)) * p)
    assert np.linalg.eigvalsh(scale @ p @ scale).min() > 0.4
    assert np.linalg.eigvalsh(scale @ left @ scale).min() > -1e-9 * w


def test_a_faster_decay_is_refused(monkeypatch):
    """The default pair is on the edge: STIFF >= 1 / (2 (1 - DECAY / 2)) is needed."""
    assert decays(30.0)
    monkeypatch.setattr(full_order_theorem, "DECAY", Fraction(3, 2) + Fraction(1, 10**9))
    assert not decays(30.0)


@pytest.mark.parametrize("barrier", [FENCE, TORSO])
def test_sigma_may_be_as_small_as_the_formula_says_and_no_smaller(barrier):
    """Least sigma: (c^2 / (gamma - alpha) + alpha l^2) / (4 epsilon), in fractions."""
    alpha, eps, c, reading = (
        Fraction(x) for x in (barrier.alpha, barrier.epsilon, barrier.coupling, barrier.reading)
    )
    least = (c * c / (45 - alpha) + alpha * reading * reading) / (4 * eps)
    for factor, fits in ((1.0 + 1e-12, True), (1.0 - 1e-12, False)):
        shape = _with(barrier, sigma=float(least) * factor)
        between = [step for step in inequalities(shape) if f"{barrier.name}: between" in step.claim]
        assert [step.holds for step in between] == [fits]


@pytest.mark.parametrize(("factor", "leaves"), [(1.0, False), (0.9, True)])
def test_the_worst_system_with_these_constants_leaves_only_below_the_least_sigma(factor, leaves):
    """The system h' = -alpha h + epsilon - c sqrt(V), V' = -gamma V, from faces h = sigma V."""
    alpha, eps, c, gamma = FENCE.alpha, FENCE.epsilon, FENCE.coupling, 45.0
    sigma = factor * c * c / (4.0 * eps * (gamma - alpha))
    start = np.linspace(1e-4, 0.05, 2000)
    h, root, step = sigma * start**2, start.copy(), 1e-6
    worst = np.inf
    for _ in range(200):
        h = h + step * (-alpha * h + eps - c * root)
        root = root * np.exp(-0.5 * gamma * step)
        worst = min(worst, float(np.min(h - sigma * root**2)))
    assert (worst < -1e-9) == leaves


@pytest.mark.parametrize("crossing", [1e-5, 3e-17, 1.7e-16, 1e-9 / 3.0])
def test_inequalities_use_the_edges_that_the_boxes_have(crossing):
    """1 -+ e of the boxes are doubles: what e is in the inequalities reaches as far as they do."""
    shape = replace(SHAPE, crossing=crossing, mismatch=0.0, drift=2.0**40)
    boxes = [p for p in premises(shape) if p.output == "full/drift"]
    (low, high) = (boxes[0].low[0], boxes[0].high[0])
    reach = max(Fraction(1) - Fraction(low), Fraction(high) - Fraction(1))
    found = {c.name: c.value for c in constant_rows(shape)}
    assert Fraction(found["sqrt v_sym"]) >= reach * 2**40
    assert found["sqrt v_sym"] <= float(reach * 2**40) * (1.0 + 1e-14) + 1e-300


def test_bounds_know_their_side_and_most_sigma_is_what_an_impact_leaves():
    known = {c.name: c for c in constant_rows(SHAPE, PROVED)}
    sides = {name: known[name].side for name in ("inertia", "L_z", "r_bar", "gamma", "w")}
    assert sides == {
        "inertia": "least",
        "L_z": "most",
        "r_bar": "most",
        "gamma": "least",
        "w": "exact",
    }
    most = Fraction(known["torso-lower: most sigma"].value)
    after = Fraction(known["r_bar"].value)
    tightened = Fraction(TORSO.reading) ** 2 / (4 * Fraction(TORSO.sigma))
    left = Fraction(TORSO.reset) - Fraction(TORSO.reset_slope) * Fraction(SHAPE.guard_radius)
    assert most * after**2 <= left - tightened
    assert float(most * after**2) == pytest.approx(float(left - tightened), rel=1e-9)


def test_what_outputs_do_not_move_is_tightened_by_nothing():
    shape = replace(SHAPE, barriers=(replace(SHAPE.barriers[0], reading=0.0),))
    found = {c.name.partition(": ")[2]: c.value for c in constant_rows(shape)}
    assert found["t"] == 0.0 and constant_rows(SHAPE)


def test_a_bandwidth_of_nothing_is_an_obstacle():
    for bandwidth in (0.0, -30.0):
        found = _verdict(replace(SHAPE, bandwidth=bandwidth))
        assert found.verdict == "undecided"
