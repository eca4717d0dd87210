"""Level 5 on robots whose links are not the file's: bounds by force, and the arithmetic."""

import math
from dataclasses import replace
from functools import cache

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from flint import arb

from neuralgaits.analysis.run import open_run
from neuralgaits.certificate.levels.disturbed.conclude import conclude_disturbed
from neuralgaits.certificate.levels.disturbed.find_model import model_bounds, with_peaks
from neuralgaits.certificate.levels.disturbed.model_inequalities import (
    barrier_landed,
    error_drift,
    kicked_by_model,
    landed,
    model_inequalities,
    momentum_drift,
    more_acceleration,
    most_error,
    output_drift,
    outputs_landed,
)
from neuralgaits.certificate.levels.disturbed.model_margins import model_margins
from neuralgaits.certificate.levels.disturbed.model_theorem import MODEL_LENGTHS, MODEL_SERIES
from neuralgaits.certificate.levels.disturbed.push_inequalities import inequalities
from neuralgaits.certificate.levels.disturbed.radius_inequalities import face_inequalities
from neuralgaits.certificate.levels.disturbed.theorem import (
    DisturbedBarrier,
    DisturbedConstants,
    premises,
)
from neuralgaits.certificate.levels.full_order.model import (
    FullOrderModel,
    scaled_coordinates,
    weighted,
)
from neuralgaits.certificate.levels.full_order.sample_evaluators import (
    evaluators_in_norm,
    evaluators_of,
)
from neuralgaits.certificate.levels.full_order.share_bounds import largest_shares
from neuralgaits.certificate.levels.full_order.theorem import BarrierConstants
from neuralgaits.records.law_proof import LawProof
from neuralgaits.robots import dynamics
from neuralgaits.robots.impact import impact
from neuralgaits.robots.mjcf.link_shares import KINDS
from neuralgaits.robots.mjcf.parameters import RobotFamily
from support.full_order_shape import SHAPE
from support.shipped_run import SHIPPED

WEIGHTS = (1.26, 1.59, -0.12, -0.05, 1.65, 0.1, -0.01, 1.19, 0.29, 0.41)
BOX = 2e-3, 4e-4, 1e-2
"""Masses, centres of mass [m], inertias."""
PEAK = 1.0, 200.0


def _gait():
    run = open_run(SHIPPED)
    plain = FullOrderModel(run.robot, run.gait, run.spec, 50.0)
    names = plain.names
    barriers = tuple(BarrierConstants(n, 1.0, 0.1, 30.0, 0.0, 0.08, 13.0, 60.0) for n in names)
    full = replace(
        SHAPE,
        bandwidth=50.0,
        radius=7e-3,
        least_radius=1.3e-3,
        guard_radius=1.4e-3,
        start_strip=7e-3,
        guard_strip=4e-3,
        gain=3.0,
        shrink=4.0,
        weights=WEIGHTS,
        barriers=barriers,
    )
    return run, plain, full


@cache
def _bounded() -> DisturbedConstants:
    """Constants about other robots that are found for the shipped gait in some set."""
    _, plain, full = _gait()
    evaluators = evaluators_in_norm(plain, full, evaluators_of(plain))
    phases, levels = np.linspace(*full.ends, 41), np.linspace(0.0, 1.0, 5)
    u = np.stack(np.meshgrid(phases, levels, indexing="ij"), axis=-1).reshape(-1, 2)
    bounds = model_bounds(evaluators, full, u, BOX)
    rows = tuple(DisturbedBarrier(barrier.name, 1.0, 1e-3, 0.05) for barrier in full.barriers)
    one = DisturbedConstants(
        (0.5, 100.0), PEAK, 1e-3, 0.0, 800.0, 5e4, 12.0, rows, **bounds, model_peaks=(1.0, 1.0)
    )
    most = most_error(full, one)
    more = more_acceleration(one).at(most, arb(full.radius)), landed(full, one)
    return replace(one, **with_peaks(*(float(bound.upper()) for bound in more)))


@pytest.mark.slow
def test_other_robots_move_by_no_more_than_is_bounded():
    """Between impacts and in them, by the dynamics of robots at corners of the box.

    Under the same torque, which is off by as much as the theorem allows; three times the box does
    break bounds.
    """
    run, plain, full = _gait()
    own, n = _bounded(), run.robot.n
    model = replace(plain, weights=jnp.asarray(WEIGHTS))
    family, phi = RobotFamily.of(run.robot, KINDS), run.zero_dynamics.phi
    w = model.bandwidth

    def coordinates(x):
        eta, z = phi(x)
        return scaled_coordinates(eta, w, model.weights), z[1], model.barriers(z)

    def error(x, torque):
        rate = jnp.concatenate([x[n:], dynamics.acceleration(run.robot, x[:n], x[n:], torque)])
        (eta, _), (moved, _) = jax.jvp(phi, (x,), (rate,))
        m = n - 1
        return weighted(model.weights, moved[m:] + w * w * eta[:m] + 2.0 * w * eta[m:])

    @jax.jit
    def between(u, xi, e, p):
        point = model.point(u, xi, e)
        q, dq, torque = point.q, point.dq, point.torque
        accelerations = [
            dynamics.acceleration(robot, q, dq, torque) for robot in (run.robot, family.at(p))
        ]
        x = jnp.concatenate([q, dq])
        more = jnp.concatenate([jnp.zeros(n), accelerations[1] - accelerations[0]])
        moved = jax.jvp(coordinates, (x,), (more,))[1]
        growth = jax.jvp(lambda x: error(x, torque), (x,), (more,))[1]
        return jnp.linalg.norm(moved[0]), abs(moved[1]), jnp.linalg.norm(growth), error(x, torque)

    @jax.jit
    def at_impact(u, xi, p):
        point = model.point(u, xi)
        after = [impact(robot, point.q, point.dq) for robot in (run.robot, family.at(p))]
        mine, other = (coordinates(jnp.concatenate([i.q, i.dq])) for i in after)
        barriers = jnp.max(mine[2] - other[2])
        return jnp.linalg.norm(mine[0] - other[0]), barriers

    random = np.random.default_rng(2)
    half = np.repeat([BOX[0], BOX[1], BOX[1], BOX[2]], len(family.masses))
    largest = np.zeros(5)
    for trial in range(90):
        signs = half * random.choice([-1.0, 1.0], len(half))
        at = random.uniform(*full.ends)
        bound = full.least_radius + (full.radius - full.least_radius) * math.exp(
            -full.shrink * at * at
        )
        way, off = random.normal(size=8), random.normal(size=4)
        xi = bound * (trial % 3 > 0) * way / np.linalg.norm(way)
        e = (PEAK[0] + PEAK[1] * bound) * (trial % 2) * off / np.linalg.norm(off)
        u = np.array([at, random.uniform()])
        for share in (1.0, 3.0):
            seen = between(u, xi, e, share * signs)
            np.testing.assert_allclose(seen[3], e, atol=1e-8)
            push, radius = arb(float(np.linalg.norm(e))), arb(float(np.linalg.norm(xi)))
            rates = output_drift(own), momentum_drift(own), error_drift(own, push)
            limits = [float(rate.at(push, radius).upper()) for rate in rates]
            strip = np.array([random.uniform(full.guard_from, full.ends[1]), u[1]])
            landings = at_impact(
                strip, full.guard_radius * way / np.linalg.norm(way), share * signs
            )
            limits += [
                float(outputs_landed(full, own).upper()),
                max(float(barrier_landed(full, own, k).upper()) for k in range(len(full.barriers))),
            ]
            ratios = np.array([*seen[:3], *landings]) / limits
            if share == 1.0:
                assert (ratios <= 1.0).all(), (trial, ratios)
            else:
                largest = np.maximum(largest, ratios)
    assert (largest > 1.0).all(), largest


@pytest.mark.slow
def test_each_margin_is_negative_where_its_bound_is_too_small():
    """What is bounded has the length that its bound is compared with; found bounds hold."""
    _, plain, full = _gait()
    own, model = _bounded(), replace(plain, weights=jnp.asarray(WEIGHTS))
    seen = jax.jit(lambda u, xi, lists: model_margins(model, u, xi, xi, lists))
    lists = {name: jnp.asarray(getattr(own, name)) for name in MODEL_SERIES}
    outputs = {
        "moves": [0.3, 0.4],
        "moves_slope": [0.3, 0.4],
        "pushes": [0.3, 0.4],
        "feeds": [0.3, 0.4],
        "errors": [0.3, 0.4],
        "curvature": [0.001, 0.4],
        "impacts": [0.999, 0.7],
        "impacts_slope": [0.999, 0.7],
        "impulses": [0.999, 0.7],
    }
    for name, at in outputs.items():
        where = jnp.array(at), jnp.full(8, 2e-4)
        output = "disturbed/model-" + name.replace("impacts", "impact").replace("_", "-")
        bound = lists[f"model_{name}"]
        margin = seen(*where, lists)[output]
        assert (margin >= 0.0).all(), (name, margin)
        length = jnp.sqrt(bound * bound - margin)
        assert (length > 0.0).all()
        again = seen(*where, lists | {f"model_{name}": 0.999 * length})
        assert (again[output] < 0.0).all(), name
    none = jnp.zeros(8)
    with pytest.raises(ValueError, match="axes of shares of 3 types"):
        model_margins(model, jnp.zeros(2), none, none, lists | {"model_axes": jnp.ones(10)})
    slopes = seen(jnp.array([0.001, 0.4]), jnp.zeros(8), lists)["disturbed/model-slopes"]
    assert (slopes >= 0.0).all() and slopes.shape == (2 * len(full.barriers),)


def test_shares_of_a_box_are_bounded():
    box = 0.02, 0.003, 0.05
    most = largest_shares(*box)
    random = np.random.default_rng(1)
    for mass, along, across, inertia in random.uniform(-1.0, 1.0, (200, 4)) * (
        0.02,
        3e-3,
        3e-3,
        0.05,
    ):
        heavier = 1.0 + mass
        shares = mass, heavier * along, heavier * across, heavier * (along**2 + across**2), inertia
        assert (np.abs(shares) <= np.array(most) + 1e-15).all()
    corner = 1.02 * 2 * 3e-3**2
    np.testing.assert_allclose(most, [0.02, 1.02 * 3e-3, 1.02 * 3e-3, corner, 0.05])


def _fitting(**changes):
    """Constants about other robots that fit together, in numbers of the size that gaits have."""
    barriers = tuple(
        replace(barrier, sigma=60.0, reset=0.08, reset_slope=3.0) for barrier in SHAPE.barriers
    )
    full = replace(SHAPE, least_radius=1e-3, gain=3.0, barriers=barriers, weights=WEIGHTS)
    axes = tuple(
        1.001 * math.sqrt(5.0) * share
        for share in (2e-3, 1.002 * 4e-4, 1.002 * 4e-4, 2.004 * 1.6e-7, 1e-2)
    )
    own = {
        "model_box": BOX,
        "model_axes": axes,
        "model_metric": tuple(float(i == j) for i in range(5) for j in range(i, 5)),
        "model_moves": (0.2, 0.01, 0.2, 30.0, 0.006),
        "model_moves_slope": (1.0, 0.1, 1.0, 100.0, 0.1),
        "model_pushes": (0.01, 1e-3, 0.01, 1.0, 1e-4),
        "model_feeds": (0.02, 2e-3, 0.03, 2e-3, 2e-4),
        "model_errors": (600.0, 0.2, 0.04),
        "model_slopes": (0.2,) * len(barriers),
        "model_curvature": (0.02, 0.02),
        "model_impacts": (0.01, 6e-4, 0.01, 7e-4, 0.07),
        "model_impacts_slope": (0.5, 0.1, 0.4, 0.1, 1.0),
        "model_impulses": (9.0, 0.05),
        "model_peaks": (0.3, 0.011),
    }
    rows = tuple(DisturbedBarrier(barrier.name, 1.0, 1e-3, 0.05) for barrier in barriers)
    peak = changes.pop("peak", (0.5, 0.0))
    return full, DisturbedConstants(
        (0.4, 0.0), peak, 1e-3, 0.0, 100.0, 1e3, 1.0, rows, **{**own, **changes}
    )


def test_numbers_about_other_robots_that_fit_and_planted_falsity():
    full, own = _fitting()
    assert [s.claim for s in model_inequalities(full, own) if not s.holds] == []
    axes = own.model_axes
    forged = {
        "in their ellipsoid": {"model_axes": (0.4 * axes[0], *axes[1:])},
        "0 < axes": {"model_axes": (-axes[0], *axes[1:])},
        "to accelerations <": {"model_peaks": (0.2, 0.011)},
        "to rates in an impact <": {"model_peaks": (0.3, 0.01)},
        "sqrt(V+) < radius": {"model_impacts": (0.01, 9e-3, 0.01, 7e-4, 0.07)},
        "five shares": {"torque_gains": (1.0,), "inertia_gains": (1.0,), "decay": 10.0},
        "triangular metric": {"model_metric": (1.0, 1.0)},
        "over the coordinates": {"model_metric": (1.0, 0.0, 1.0)},
        "bounds that are not negative": {"model_box": (2e-3, math.nan, 1e-2)},
    }
    for reason, changes in forged.items():
        broken = [s.claim for s in model_inequalities(*_fitting(**changes)) if not s.holds]
        assert any(reason in claim for claim in broken), (reason, broken)
    broken = [
        s.claim for s in model_inequalities(*_fitting(model_slopes=(9.0, 0.2, 0.2))) if not s.holds
    ]
    assert broken == ["level-lower: other robots: across impacts, sigma V+ < h(z+) - t"]
    # Premises see most bounds by their squares, and others read them as they are.
    for name in (*MODEL_LENGTHS, "model_slopes"):
        for k, number in enumerate(getattr(own, name)):
            for wrong in (-number, math.nan):
                values = list(getattr(own, name))
                values[k] = wrong
                broken = [
                    s.claim
                    for s in model_inequalities(*_fitting(**{name: tuple(values)}))
                    if not s.holds
                ]
                assert any("not negative" in claim for claim in broken), (name, k)
    fed = {"model_feeds": (1.1, 2e-3, 0.03, 2e-3, 2e-4)}
    assert any("feed < 1" in s.claim for s in model_inequalities(*_fitting(**fed)) if not s.holds)
    for name in (*MODEL_LENGTHS, "model_slopes"):
        with pytest.raises(ValueError, match="errors of the model without"):
            _fitting(**{name: (1.0,)})


def test_other_robots_take_of_every_inequality_that_they_are_in():
    """Each effect, made ten times larger, leaves less room between the sides."""
    full, own = _fitting()
    free = {"kick": 30.0, "kick_slope": 1.0, "kick_push": 1.0, "kick_peak": 60.0, "kick_end": 0.02}

    def room(**changes):
        rows = inequalities(full, replace(own, **free, **changes))
        return {row.claim: float((row.right - row.left).mid()) for row in rows}

    def ten_times(name, k):
        values = list(getattr(own, name))
        values[k] *= 10.0
        return {name: tuple(values)}

    plain = room()
    touched = {
        ("model_moves", 1): ("least radius is above", "alpha t and what", "at the next tick"),
        ("model_moves_slope", 1): ("fall faster than",),
        ("model_moves", 3): ("error + growth in a hold < peak", "next tick < kick_peak"),
        ("model_pushes", 1): ("least radius is above", "alpha t and what"),
        ("model_impacts", 1): ("sqrt(V+) exp(-gamma", "mean kick)^2 < h", "sqrt(V+) < radius"),
        ("model_impacts", 0): ("next tick < kick_peak", "to rates in an impact"),
        ("model_curvature", 0): ("sqrt(V+) < radius",),
        ("model_errors", 0): ("error + growth in a hold", "next tick < kick_peak"),
        ("model_feeds", 1): ("least radius is above",),
        ("model_slopes", 0): ("level-lower: alpha t", "level-lower: other robots"),
    }
    for (name, k), claims in touched.items():
        changed = room(**ten_times(name, k))
        for claim in claims:
            rows = [key for key in plain if claim in key and key in changed]
            assert rows, (name, claim)
            for row in rows:
                assert changed[row] < plain[row], (name, row)


def test_a_robot_that_is_the_files_takes_nothing():
    full, own = _fitting()
    none = replace(own, **{name: () for name in own.__dict__ if name.startswith("model_")})
    assert model_inequalities(full, none) == []
    assert all(part == 0 for part in (*output_drift(none), outputs_landed(full, none)))
    assert kicked_by_model(full, none, arb(3)) == 3
    assert not any("/model-" in premise.output for premise in premises(full, none))
    assert [r.claim for r in face_inequalities(full, none)] == [
        r.claim for r in face_inequalities(full, own)
    ]


def test_a_law_that_is_proved_names_its_robots():
    alone = LawProof("fblin", 50.0, "fblin", 1.5e-3, "touchdown")
    words = (
        "fblin at 50 rad/s: proved for ticks at most 1.5 ms apart, one of them at each touchdown"
    )
    assert alone.words == words
    of_box = replace(alone, model_box=(2e-3, 4e-4, 0.0))
    robots = ", on robots with both legs alike that are off by at most: masses by 0.2 %, "
    assert of_box.words == f"{words}{robots}centres of mass by 0.4 mm; by nothing else"


def test_every_premise_is_needed_and_its_robots_are_named():
    full, own = _fitting(peak=(0.6, 0.0))
    names = [p for p in premises(full, own) if "/model-" in p.output]
    bounds = {(p.output, p.low, p.high): 0.1 for p in premises(full, own)}
    done = conclude_disturbed(full, own, bounds)
    assert done.verdict == "proved", done.reason
    robots = "masses off by a share of at most 0.002, centres of mass by at most 0.0004 m along"
    assert robots in " ".join(done.words)
    for premise in names:
        missing = {k: v for k, v in bounds.items() if k[0] != premise.output}
        done = conclude_disturbed(full, own, missing)
        assert done.verdict == "undecided" and premise.output in (done.reason or "")
    # Until the next tick after an impact phases are beyond the start's strip.
    free = replace(own, kick_end=2.0 * full.start_strip)
    (slopes,) = (p for p in premises(full, free) if p.output == "disturbed/model-slopes")
    assert slopes.high == (free.kick_end, 1.0)
