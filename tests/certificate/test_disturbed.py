"""Level 5: the arithmetic of the disturbed theorem, its norm, and its margins against the robot."""

from dataclasses import replace

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from flint import arb

from neuralgaits.analysis.run import open_run
from neuralgaits.certificate.levels.disturbed.conclude import conclude_disturbed, constant_rows
from neuralgaits.certificate.levels.disturbed.margins import LawErrors, decay_matrix, margins
from neuralgaits.certificate.levels.disturbed.push_inequalities import (
    error_rate,
    first_kick,
    growth,
    growth_slope,
    mean_kick,
    most_push,
    sqrt_v_after_kick,
)
from neuralgaits.certificate.levels.disturbed.push_inequalities import (
    inequalities as push_inequalities,
)
from neuralgaits.certificate.levels.disturbed.radius_inequalities import face_inequalities
from neuralgaits.certificate.levels.disturbed.theorem import (
    DisturbedBarrier,
    DisturbedConstants,
    premises,
)
from neuralgaits.certificate.levels.full_order.conclude import conclude_full_order
from neuralgaits.certificate.levels.full_order.inequalities import (
    after_impact,
    bound_at,
    inequalities,
    least_time,
    mismatch,
)
from neuralgaits.certificate.levels.full_order.model import (
    FullOrderModel,
    output_coordinates,
    scaled_coordinates,
)
from neuralgaits.certificate.levels.full_order.theorem import premises as of_level_four
from neuralgaits.gait.full_order import held_jerk
from neuralgaits.gait.output_laws import ScheduledLaw
from neuralgaits.gait.scheduled_gains import ScheduledGains
from neuralgaits.robots import dynamics
from neuralgaits.robots.linear import pivots
from support.full_order_shape import SHAPE
from support.shipped_run import SHIPPED

WEIGHTS = (1.1, 1.3, -0.2, -0.05, 1.5, -0.1, -0.08, 1.3, 0.35, 0.4)
GAMMA, B = 45.0, np.sqrt(5.0) / 30.0
FLOOR = 2e-4
PUSH = 0.999 * GAMMA * FLOOR / (2.0 * B)


def _full(**changes):
    """The set of the other tests with a least radius: its impacts still fit."""
    guard = SHAPE.guard_radius + FLOOR
    return replace(SHAPE, least_radius=FLOOR, guard_radius=guard, start_strip=0.004, **changes)


def _shape(full, push=PUSH, split=1.0):
    rows = []
    for of in full.barriers:
        rest = 4.0 * of.sigma * (GAMMA - of.alpha)
        lost = of.alpha * of.reading**2 / (4.0 * of.sigma)
        lost += (1.0 + 1.0 / split) * (2.0 * of.sigma * B * push) ** 2 / rest
        rows.append(
            DisturbedBarrier(of.name, of.alpha, (1.0 + split) / rest, lost * (1.0 + 1e-9) + 1e-12)
        )
    return DisturbedConstants((push, 0.0), (push, 0.0), 0.0, 0.0, 1.0, 1.0, 1.0, tuple(rows))


def _held(full, hold=5e-5, error=0.01, **law):
    """Constants that fit a hold, with a part in a thousand to spare."""
    jerk = {"jerk": 300.0, "growth_slope": 3e4, "jerk_push": 9.0}
    shape = replace(_shape(full), hold=hold, error=error, **jerk, **law)
    rate, above = float(error_rate(full, shape)), 1.001
    end = np.expm1(rate * hold) / rate
    mean = (end - hold) / (rate * hold) + GAMMA * hold**2 * np.exp(rate * hold) / 16.0
    still, slope = (float(part) for part in growth(full, shape))
    peak = above * (error + end * still), above * end * slope
    push = above * (error + mean * still), above * mean * slope
    most = push[0] + push[1] * full.radius
    barriers = _shape(full, push=most * 1.0001).barriers
    return replace(shape, push=push, peak=peak, barriers=barriers)


def _verdict(full, shape, without=None):
    bounds = {(p.output, p.low, p.high): 0.1 for p in premises(full, shape)}
    return conclude_disturbed(full, shape, {k: v for k, v in bounds.items() if k[0] != without})


def _first(shape, **changes):
    barrier, *rest = shape.barriers
    return replace(shape, barriers=(replace(barrier, **changes), *rest))


def test_constants_that_fit_are_a_proof_and_planted_falsity_is_none():
    full = _full()
    shape = _shape(full)
    assert _verdict(full, shape).verdict == "proved"
    lost, weight = shape.barriers[0].lost, shape.barriers[0].weight
    forged = {
        "push <= peak": replace(shape, peak=(0.99 * PUSH, 0.0)),
        "slope of push <= slope of peak": replace(shape, push=(0.9 * PUSH, 1.0)),
        "0 <= its slope": replace(shape, push=(PUSH, -1.0)),
        "0 < push": _shape(full, push=-PUSH),
        "what the push takes < lost": _first(shape, lost=0.99 * lost),
        "1 < 4 sigma": _first(shape, weight=0.4 * weight),
        "alpha < gamma": _first(shape, alpha=46.0),
        "not those of level 4": replace(shape, barriers=shape.barriers[::-1]),
    }
    for reason, wrong in forged.items():
        found = _verdict(full, wrong)
        assert found.verdict == "undecided"
        assert reason in str(found.reason)
    for premise in premises(full, shape):
        assert premise.output in str(_verdict(full, shape, premise.output).reason)


def test_a_hold_that_fits_is_a_proof_and_planted_falsity_is_none():
    full = _full()
    shape = _held(full)
    found = _verdict(full, shape)
    assert found.verdict == "proved", found.reason
    assert f"ticks there are at most {shape.hold!r} s apart" in " ".join(found.words)
    less = [0.99, 1.0]
    first, second = np.array([less, less[::-1]])
    forged = {
        "0 < hold": replace(shape, hold=-shape.hold),
        "0 <= error": replace(shape, error=-0.01),
        "error + growth in a hold < peak at the least radius": replace(
            shape, peak=tuple(first * shape.peak)
        ),
        "error + growth in a hold < peak at the radius": replace(
            shape, peak=tuple(second * shape.peak)
        ),
        "error + mean growth in a hold < push at the least radius": replace(
            shape, push=tuple(first * shape.push)
        ),
        "error + mean growth in a hold < push at the radius": replace(
            shape, push=tuple(second * shape.push)
        ),
        "N at the least radius": replace(shape, jerk=20.0 * shape.jerk),
        "the slope of N": replace(shape, growth_slope=200.0 * shape.growth_slope),
        "what the push takes < lost": replace(shape, push=tuple(1.01 * np.array(shape.push))),
    }
    for reason, wrong in forged.items():
        found = _verdict(full, wrong)
        assert found.verdict == "undecided"
        assert reason in str(found.reason)
    for name in ("jerk", "growth_slope", "jerk_push"):
        more = 40.0 if name == "jerk_push" else 4.0  # Little feeds itself in so short a hold.
        larger = replace(shape, **{name: more * getattr(shape, name)})
        assert "growth in a hold <" in str(_verdict(full, larger).reason)
    for premise in premises(full, shape):
        assert premise.output in str(_verdict(full, shape, premise.output).reason)


def _free(full, hold=5e-5):
    """Constants that fit a hold and a clock that knows of no touchdown."""
    kick = {"kick": 20.0, "kick_slope": 5e3, "kick_push": 2.0}
    end = 1.01 * (full.start_strip + full.pace[1] * hold)
    shape = replace(_held(full, hold, error=0.0), **kick, kick_end=end)
    rate, first = float(error_rate(full, shape)), float(first_kick(full, shape))
    grown = np.exp(rate * hold)
    still = shape.jerk + float(growth_slope(full, shape)) * full.radius
    peak = 1.001 * (first * grown + still * (grown - 1.0) / rate)
    shape = replace(shape, kick_peak=float(peak))
    return replace(shape, barriers=_shape(full, push=float(most_push(full, shape))).barriers)


def test_a_free_clock_that_fits_is_a_proof_and_planted_falsity_is_none():
    full = _full()
    shape = _free(full)
    found = _verdict(full, shape)
    assert found.verdict == "proved", found.reason
    assert "wherever touchdowns lie" in " ".join(found.words)
    assert "each touchdown" not in " ".join(found.words)
    most = float(most_push(full, shape))
    # The time after an impact counts: the mean of what is left of its kick is more than a hold's.
    assert most > shape.push[0] + shape.push[1] * full.radius
    for reason, wrong in _forged_kicks(full, shape).items():
        found = _verdict(full, wrong)
        assert found.verdict == "undecided", reason
        assert reason in str(found.reason)
    names = {premise.output for premise in premises(full, shape)}
    added = {f"disturbed/kick{end}" for end in ("", "-slope", "-push", "-contact")}
    assert names - {p.output for p in premises(full, _held(full))} == added
    for premise in premises(full, shape):
        assert premise.output in str(_verdict(full, shape, premise.output).reason)


def _forged_kicks(full, shape):
    """Wrong constants of a free clock, by what is said of them."""
    peak, end = "errors from an impact to the next tick", "start_strip + most pace hold < kick_end"
    return {
        peak: replace(shape, kick_peak=0.99 * shape.kick_peak),
        "next tick < kick_peak": replace(shape, kick_slope=4.0 * shape.kick_slope),
        end: replace(shape, kick_end=0.98 * shape.kick_end),
        "kick_end < 1 - guard_strip": replace(shape, kick_end=0.999),
        "bound on sqrt(V) at the next tick": replace(shape, kick_peak=2e3),
        "what the push takes < lost": replace(shape, barriers=_held(full, error=0.0).barriers),
    }


@pytest.mark.parametrize(("beyond", "holds"), [(-1e-7, True), (1e-7, False)])
def test_outputs_shrink_from_an_impact_to_the_next_tick(beyond, holds):
    """The face of the radius: less than sqrt(V+) is left when the kick has added all of its part.

    Without that decay, as in b T J + sqrt(V+) < R, neither of these constants would fit.
    """
    full = _full()
    shape = _free(full, hold=2e-4)
    bound = float(bound_at(full, arb(shape.kick_end)))
    after, hold = float(after_impact(full)), shape.hold
    added = bound * (1.0 + beyond) - after * np.exp(-0.5 * GAMMA * hold)
    assert after + added > bound * (1.0 + 1e-4)
    peak = 2.0 * added / (B * hold) - float(first_kick(full, shape))
    assert peak > shape.kick_peak
    shape = replace(shape, kick_peak=peak)
    face = [s for s in push_inequalities(full, shape) if "at the next tick" in s.claim]
    assert [step.holds for step in face] == [holds]
    # The faces of the barriers take no decay: they are asked with all that is added.
    barriers = [s for s in push_inequalities(full, shape) if "h(z+) - t" in s.claim]
    for step, of in zip(barriers, full.barriers, strict=True):
        assert float(step.left) == pytest.approx(of.sigma * (after + added) ** 2, rel=1e-9)


@pytest.mark.parametrize("kicks", [0.5, 2000.0])
def test_no_output_after_an_impact_is_larger_than_at_an_end_of_the_hold(kicks):
    """Of r' = -gamma r / 2 + b e, e' = G + rho e, from the impact to ticks at any time."""
    full = _full()
    shape = replace(_free(full, hold=1e-3), kick=kicks, kick_slope=0.0, kick_push=0.0)
    rate, first = float(error_rate(full, shape)), float(first_kick(full, shape))
    still = shape.jerk + float(growth_slope(full, shape)) * full.radius
    last = first * np.exp(rate * shape.hold) + still * np.expm1(rate * shape.hold) / rate
    shape = replace(shape, kick_peak=last)
    said, after = float(sqrt_v_after_kick(full, shape)), float(after_impact(full))
    r, most, parts = after, after, 4000
    step = shape.hold / parts
    for number in range(parts):
        since = (number + 0.5) * step
        e = first * np.exp(rate * since) + still * np.expm1(rate * since) / rate
        r += step * (-0.5 * GAMMA * r + B * e)
        most = max(most, r)
    assert 0.97 < most / said <= 1.0
    # Small errors add less than decays: the bound is the one right after the impact.
    assert (said == after) == (kicks < 100.0)


def test_outputs_shrink_from_step_to_step_as_the_decay_of_the_law_says():
    """The recursion r+ = mismatch + gain (exp(-decay T / 2) r + kept), unlike that of `fblin`."""
    full = _full()
    law = {"torque_gains": (1.0,), "inertia_gains": (1.0,), "rest": 0.0, "decay": 0.6 * GAMMA}
    shape = replace(_held(full, error=0.0), **law)
    known = {one.name: one.value for one in constant_rows(full, shape)}
    time, jump = (float(f(full).mid()) for f in (least_time, mismatch))
    after = 0.0
    for _ in range(200):
        kept = np.exp(-0.3 * GAMMA * time) * after + known["kept"]
        after = jump + abs(full.gain) * kept
    assert known["r_end"] == pytest.approx(after, rel=1e-9)
    exact = {one.name: one.value for one in constant_rows(full, _held(full, error=0.0))}
    assert known["r_end"] > exact["r_end"]


def test_a_law_that_is_not_exact_has_less_decay_and_an_error_of_its_own():
    full = _full()
    law = {"torque_gains": (1.0,), "inertia_gains": (1.0,), "rest": 0.0}
    shape = _held(full, error=0.0, **law, decay=GAMMA)
    found = _verdict(full, shape)
    assert found.verdict == "proved", found.reason
    assert "scheduled PD" in " ".join(found.words) and "beyond that law" in " ".join(found.words)
    names = {premise.output for premise in premises(full, shape)}
    assert {"disturbed/decay", "disturbed/rest"} < names
    for premise in premises(full, shape):
        assert premise.output in str(_verdict(full, shape, premise.output).reason)
    room = shape.push[0] / 1.001
    forged = {
        "0 < decay": replace(shape, decay=-1.0),
        "V decays faster than its bound": replace(shape, decay=0.2 * GAMMA),
        "2 b push < (gamma - 2 b slope) least radius": replace(
            shape, push=(PUSH * 1.01, 0.0), peak=(2.0 * PUSH, shape.peak[1])
        ),
        "gamma - 2 b slope of push": replace(shape, push=(shape.push[0], 60.0), peak=(1.0, 60.0)),
        "growth in a hold < push": replace(shape, rest=0.01 * room),
        "alpha < gamma": replace(shape, decay=full.barriers[2].alpha),
    }
    for reason, wrong in forged.items():
        assert reason in str(_verdict(full, wrong).reason), reason
    free = replace(_free(full), **law, decay=GAMMA)
    assert _verdict(full, free).verdict == "proved"
    assert float(mean_kick(full, replace(free, rest=0.5)) - mean_kick(full, free)) == 0.5


def test_the_decay_of_a_law_is_that_of_its_flow():
    """Pivots are positive if and only if V falls at that rate along dxi/dt = (A + B E) xi."""
    draw, m, w = np.random.default_rng(7), 4, 30.0
    one = np.eye(m)
    flow = w * np.block([[-one, -0.5 * one], [0.0 * one, -one]])
    for size in (0.0, 40.0, 200.0):
        slope = size * draw.normal(size=(m, 2 * m)) / np.sqrt(8 * m)
        moved = flow + np.concatenate([slope, 2.0 * slope]) / w
        least = -np.linalg.eigvalsh(moved + moved.T).max()
        for rate, holds in ((least - 1e-6, True), (least + 1e-6, False)):
            found = np.asarray(pivots(decay_matrix(jnp.asarray(slope), w, rate)))
            assert bool((found > 0.0).all()) == holds
        assert size > 0.0 or least == pytest.approx(GAMMA)


@pytest.mark.parametrize("hold", [5e-5, 2e-3])
def test_errors_of_a_hold_reach_no_further_than_their_mean(hold):
    """Of r' = -gamma r / 2 + b e, e' = G + rho (e - a) from tick to tick: docs/level5_proof.md."""
    full = _full()
    shape = _held(full, hold)
    still, slope = (float(part) for part in growth(full, shape))
    rise, rate, error = still + slope * full.radius, float(error_rate(full, shape)), shape.error
    push = (shape.push[0] + shape.push[1] * full.radius) / 1.001
    r, peak, parts = 0.0, 0.0, 64
    step = hold / parts
    for number in range(parts * max(400, int(0.4 / hold))):
        since = (number % parts + 0.5) * step
        e = error + rise * np.expm1(rate * since) / rate
        r += step * (-0.5 * GAMMA * r + B * e)
        peak = max(peak, r)
    assert 0.97 < peak / (2.0 * B * push / GAMMA) <= 1.0


def test_a_hold_proved_by_a_bound_on_all_of_its_errors_is_proved_by_their_growth():
    """Constants of |S e|' <= j + l R + rho P at any time, as proofs had them once, still stand."""
    full = _full()
    shape = _held(full, 4e-4)
    rate, hold = float(error_rate(full, shape)), shape.hold
    slope = float(growth(full, shape)[1])
    mean, above = 0.5 * hold * (1.0 + GAMMA * hold / 8.0), 1.0 + 1e-9
    peak = shape.peak
    for _ in range(60):  # Peak and growth depend on each other.
        still = shape.jerk + rate * (peak[0] + peak[1] * full.radius)
        peak = above * (shape.error + hold * still), above * hold * slope
    push = above * (shape.error + mean * still), above * mean * slope
    assert peak[1] < shape.peak[1] and push[1] < shape.push[1]
    before = replace(shape, push=push, peak=peak)
    broken = [step.claim for step in push_inequalities(full, before) if not step.holds]
    assert not [claim for claim in broken if "growth in a hold" in claim]
    assert push[0] > 1.02 * shape.push[0]


LARGEST = 0.5 * 30.0**2 * FLOOR
"""The |S e| at which a least radius is what outputs are kept at: 2 |S e| / w^2."""


@pytest.mark.parametrize(("share", "holds"), [(0.995, True), (1.005, False)])
def test_the_least_radius_bears_errors_up_to_what_the_worst_output_bears(share, holds):
    full = _full()
    shape = replace(_held(full, hold=1e-7), jerk=1.0, jerk_push=0.0, error=share * LARGEST)
    (row, _) = face_inequalities(full, shape)
    assert row.holds == holds


@pytest.mark.parametrize(("share", "holds"), [(0.99, True), (1.001, False)])
def test_a_bound_that_shrinks_as_fast_as_outputs_fall_is_none(share, holds):
    full = _full()
    most = share * 0.5 * GAMMA / (2.0 * full.ends[1] * full.pace[1])
    shape = replace(_held(full, hold=1e-7), error=0.0)
    (_, row) = face_inequalities(replace(full, shrink=most), shape)
    assert row.holds == holds


@pytest.mark.parametrize("error", [0.0, 0.04])
@pytest.mark.parametrize("beyond", [False, True])
def test_outputs_stay_in_their_bound_for_the_hold_that_is_allowed_and_not_for_longer(error, beyond):
    """Outputs whose third derivative is the largest, either way: exact polynomials.

    The longest hold that the matrices allow is close to the longest that there is.
    """
    full, w = _full(), 30.0
    shape = replace(_held(full, error=error), jerk_push=0.0, growth_slope=20.0)

    def allowed(hold):
        (row, _) = face_inequalities(full, replace(shape, hold=hold))
        return row.holds

    low, high = 1e-6, 2e-3
    for _ in range(30):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if allowed(middle) else (low, middle)
    hold = 1.12 * low if beyond else low
    radius, angle, worst = full.least_radius, np.linspace(0.0, 2.0 * np.pi, 721), -1.0
    for since in np.linspace(0.05, 1.0, 20) * hold:
        xi = radius * np.stack([np.cos(angle), np.sin(angle)])
        for sign in (-1.0, 1.0):
            dy, y = w * xi[0], 0.5 * xi[1] - xi[0]
            ddy, jerk = -(w**2) * y - 2.0 * w * dy + sign * error, sign * shape.jerk
            y = y + since * dy + since**2 * ddy / 2.0 + since**3 * jerk / 6.0
            dy = dy + since * ddy + since**2 * jerk / 2.0
            worst = max(worst, np.hypot(dy / w, 2.0 * (y + dy / w)).max() / radius - 1.0)
    assert (worst > 0.0) == beyond


def test_no_error_is_borne_beyond_what_radius_forces_and_barriers_bear():
    full = _full()
    shape = _held(full)
    known = {one.name: one.value for one in constant_rows(full, shape)}
    mean = shape.push[0] + shape.push[1] * full.radius
    peak = shape.peak[0] + shape.peak[1] * full.least_radius
    assert known["push"] == pytest.approx(min(LARGEST, mean, peak), rel=2e-6)
    assert known["push"] < LARGEST
    wide = replace(shape, push=(1.0, 0.0), peak=(2.0, 0.0))
    known = {one.name: one.value for one in constant_rows(full, wide)}
    assert known["push"] == pytest.approx(LARGEST, rel=2e-6) and known["push"] < LARGEST
    assert known["kept"] == pytest.approx(full.least_radius, rel=2e-6)


def test_what_is_kept_is_what_the_largest_errors_keep():
    """Errors up to the push do not become smaller where V is small."""
    full = _full()
    shape = replace(_held(full), hold=0.0)
    shape = replace(shape, push=(1e-3 * shape.push[0], shape.push[1]))
    found = _verdict(full, shape)
    assert found.verdict == "proved", found.reason
    figures = found.figures
    assert figures["kept"] >= 2.0 * figures["push"] / 30.0**2
    assert figures["r_end"] >= full.gain * figures["kept"]


def test_a_set_without_a_least_radius_stands_no_push():
    assert "least radius" in str(_verdict(SHAPE, _shape(SHAPE, push=1e-9)).reason)


def test_a_least_radius_counts_in_every_inequality_of_level_four():
    full = _full()
    assert all(step.holds for step in inequalities(full))
    bounds = {(p.output, p.low, p.high): 0.1 for p in of_level_four(full)}
    assert conclude_full_order(full, bounds).verdict == "proved"
    low = replace(full, guard_radius=SHAPE.guard_radius)
    reasons = [step.claim for step in inequalities(low) if not step.holds]
    assert reasons == ["the bound at the guard < guard_radius"]
    for floor, claim in ((-1e-5, "0 < least radius"), (0.1, "least radius < radius")):
        broken = [s.claim for s in inequalities(replace(full, least_radius=floor)) if not s.holds]
        assert claim in broken
    for weights in ((1.0, 2.0), (1.0, 0.5, 0.0)):
        reason = conclude_full_order(replace(full, weights=weights), bounds).reason
        assert "triangle" in str(reason)


@pytest.mark.parametrize(("share", "leaves"), [(1.0, False), (0.8, True)])
def test_the_worst_system_leaves_only_below_what_the_push_takes(share, leaves):
    """The system h' = value - alpha h - c r, r' = -gamma r / 2 + b push on faces h = sigma r^2."""
    full = _full()
    of, push = full.barriers[0], PUSH
    c, alpha = of.coupling, of.alpha
    value = share * (c + 2.0 * of.sigma * B * push) ** 2 / (4.0 * of.sigma * (GAMMA - alpha))
    r = np.linspace(1e-5, 0.05, 4000)
    h, step, worst = of.sigma * r**2, 1e-6, np.inf
    for _ in range(100):
        h = h + step * (value * (1.0 + 1e-6) - alpha * h - c * r)
        r = r + step * (-0.5 * GAMMA * r + B * push)
        worst = min(worst, float(np.min(h - of.sigma * r**2)))
    assert (worst < -1e-10) == leaves


def test_the_norm_has_an_inverse_and_pushes_as_fast_as_said():
    """V of xi, and d sqrt(V) / dt <= -gamma sqrt(V) / 2 + b |S e| at random states."""
    draw = np.random.default_rng(3)
    matrix = np.zeros((4, 4))
    matrix[np.triu_indices(4)] = WEIGHTS
    for _ in range(50):
        eta, e = draw.normal(size=8), draw.normal(size=4)
        xi = scaled_coordinates(jnp.asarray(eta), 30.0, WEIGHTS)
        np.testing.assert_allclose(output_coordinates(xi, 30.0, WEIGHTS), eta, rtol=1e-12)
        y, dy = eta[:4], eta[4:]
        assert float(xi @ xi) == pytest.approx(
            np.sum((matrix @ dy / 30.0) ** 2) + 4.0 * np.sum((matrix @ (y + dy / 30.0)) ** 2)
        )
        rate = np.concatenate([dy, -900.0 * y - 60.0 * dy + e])
        moved = np.asarray(scaled_coordinates(jnp.asarray(rate), 30.0, WEIGHTS))
        size = float(jnp.linalg.norm(xi))
        grows = float(np.asarray(xi) @ moved) / size
        assert grows <= -0.5 * GAMMA * size + B * np.linalg.norm(matrix @ e) + 1e-9


@pytest.mark.slow
def test_forces_of_the_worst_push_and_the_jerk_of_held_torques(trained):
    """Contact and torque against pushed states; the jerk against the floating robot's own rates."""
    model = FullOrderModel(trained.robot, trained.gait, trained.spec, 30.0)
    full = _full(weights=WEIGHTS)
    names = model.names
    full = replace(full, barriers=tuple(replace(full.barriers[0], name=n) for n in names))
    shape = _shape(full, push=2.0)
    model = replace(model, weights=WEIGHTS)
    u, xi = jnp.array([0.4, 0.3]), jnp.asarray(np.random.default_rng(1).normal(size=8) * 0.2)
    found = jax.jit(lambda u, xi: margins(model, full, shape, u, xi))(u, xi)
    bound = full.least_radius + (full.radius - full.least_radius) * np.exp(-full.shrink * 0.16)
    push = np.random.default_rng(2).normal(size=(4000, 4))
    push *= 2.0 / np.linalg.norm(push, axis=1, keepdims=True)

    def slacks(e):
        seen = model.in_step(model.point(u, bound * xi, e))
        return seen["contact"], seen["torque"]

    seen = jax.jit(jax.vmap(slacks))(jnp.asarray([np.zeros(4), *push]))
    for name, slack in zip(("contact", "torque"), map(np.asarray, seen), strict=True):
        at, worst = slack[0], slack[1:]
        taken = np.asarray(at - found[f"disturbed/{name}"])
        lowest = np.min(worst, axis=0)
        assert np.all(lowest >= at - taken - 1e-12)
        assert np.all(lowest <= at - 0.9 * taken)

    n, robot, zd = trained.robot.n, trained.robot, trained.zero_dynamics

    @jax.jit
    def pushed(e):
        """A state of the floating robot, its torques, and what is said of its outputs."""
        point = model.point(u, bound * xi, e)
        x = zd.phi_inv(point.z, jnp.concatenate([point.output, point.output_rate]))
        return x, point.torque, point.output_acceleration, held_jerk(point)

    x, torque, acceleration, said = pushed(jnp.asarray(push[0]))

    def rate(x):
        return jnp.concatenate([x[n:], dynamics.acceleration(robot, x[:n], x[n:], torque)])

    def outputs(x):
        return zd.phi(x)[0]

    def accelerations(x):
        return jax.jvp(outputs, (x,), (rate(x),))[1][4:]

    np.testing.assert_allclose(jax.jit(accelerations)(x), acceleration, atol=1e-6)
    jerk = jax.jit(lambda x: jax.jvp(accelerations, (x,), (rate(x),))[1])(x)
    np.testing.assert_allclose(said, jerk, rtol=1e-6, atol=1e-5)


def test_torques_of_scheduled_pd_are_those_that_its_accelerations_need():
    """Bounds read its polynomial; inverse dynamics of the accelerations agree with it."""
    run = open_run(SHIPPED)
    model = FullOrderModel(run.robot, run.gait, run.spec, 40.0)
    law = ScheduledLaw(ScheduledGains.of(run.robot, run.gait), run.gait)

    @jax.jit
    def both(u, xi):
        errors = LawErrors(model, law, u)
        return errors.forces(xi), model.in_step(model.point(u, xi, errors.of_law(xi)))

    random = np.random.default_rng(6)
    for _ in range(4):
        said, needed = both(random.uniform(size=2), 5e-3 * random.normal(size=model.size))
        for name in ("contact", "torque"):
            np.testing.assert_allclose(said[name], needed[name], rtol=1e-9, atol=1e-9)
