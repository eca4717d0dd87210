"""Samples: strata, overshoot, and which regions lie in which."""

import jax
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from neuralgaits.barriers import Box
from neuralgaits.gait.commands import Command
from neuralgaits.training import Sampler
from neuralgaits.training.sampling import beyond_range, contains
from support.small_spec import REGIONS, SAMPLES


def test_every_stratum_of_the_phase_has_its_sample():
    """A box's samples, sorted by phase, lie one in each equal part; levels vary freely."""
    plan = Sampler.plan({"tube": (Box((0.2, 0.1), (0.8, 0.9)),)}, {"tube": 30})
    u = np.asarray(plan.draw(jax.random.key(0)))
    edges = np.linspace(0.2, 0.8, 31)
    assert np.all((edges[:-1] <= u[:, 0]) & (u[:, 0] <= edges[1:]))
    assert np.all((0.1 <= u[:, 1]) & (u[:, 1] <= 0.9))
    assert np.std(u[:, 1]) > 0.15
    assert not np.array_equal(u, np.asarray(plan.draw(jax.random.key(1))))


def test_boxes_share_samples_by_their_length():
    boxes = (Box((0.0, 0.0), (0.1, 1.0)), Box((0.5, 0.0), (0.8, 1.0)))
    plan = Sampler.plan(
        {"two": boxes, "all": (Box((0.0, 0.0), (1.0, 1.0)),)}, {"two": 40, "all": 7}
    )
    assert plan.rows == {"two": slice(0, 40), "all": slice(40, 47)}
    u = np.asarray(plan.draw(jax.random.key(0)))[plan.rows["two"]]
    assert np.sum(u[:, 0] <= 0.1) == 10
    assert np.sum((0.5 <= u[:, 0]) & (u[:, 0] <= 0.8)) == 30


def test_curves_stay_curves_and_only_outer_edges_are_overshot():
    regions = {
        "tube": (Box((0.0, 0.0), (1.0, 1.0)),),
        "fence": (Box((0.0, 1.0), (1.0, 1.0)),),
        "guard": (Box((1.0, 0.0), (1.0, 1.0)),),
        "inside": (Box((0.3, 0.2), (0.6, 0.7)),),
        "late": (Box((0.9, 0.0), (1.0, 1.0)),),
    }
    plan = Sampler.plan(regions, dict.fromkeys(regions, 400), (0.02, 0.03))
    u = np.asarray(plan.draw(jax.random.key(0)))
    expected = {
        "tube": ((-0.02, 1.02), (-0.03, 1.03)),
        "fence": ((-0.02, 1.02), (1.0, 1.0)),
        "guard": ((1.0, 1.0), (-0.03, 1.03)),
        "inside": ((0.3, 0.6), (0.2, 0.7)),
        "late": ((0.9, 1.02), (-0.03, 1.03)),
    }
    for name, bounds in expected.items():
        for axis, (low, high) in enumerate(bounds):
            values = u[plan.rows[name], axis]
            assert np.all((low <= values) & (values <= high))
            np.testing.assert_allclose([values.min(), values.max()], [low, high], atol=0.015)


@given(count=st.integers(1, 200), cut=st.floats(0.05, 0.95))
def test_no_sample_is_lost(count, cut):
    boxes = (Box((0.0, 0.0), (cut, 1.0)), Box((cut, 0.0), (1.0, 1.0)))
    plan = Sampler.plan({"tube": boxes}, {"tube": count})
    assert plan.low.shape == plan.high.shape == (count, 2)
    assert np.all(plan.low <= plan.high)


@pytest.mark.parametrize(
    ("outer", "inner", "expected"),
    [
        ("tube", "ends", True),
        ("tube", "guard", True),
        ("ends", "guard", True),
        ("guard", "ends", False),
    ],
)
def test_containment(outer, inner, expected):
    assert contains(REGIONS[outer], REGIONS[inner]) is expected
    assert contains(REGIONS[outer], REGIONS[outer])
    assert set(SAMPLES) == set(REGIONS)


def test_a_box_across_two_is_in_neither():
    halves = (Box((0.0, 0.0), (0.5, 1.0)), Box((0.5, 0.0), (1.0, 1.0)))
    assert not contains(halves, (Box((0.4, 0.0), (0.6, 1.0)),))
    assert contains(halves, halves)


@pytest.mark.parametrize(
    ("command", "beyond"),
    [
        (Command("speed", 0.5, 1.0, 0.06), 0.05),
        # A narrow range is widened by more: orbits are slower than trained for by some per cent.
        (Command("speed", 0.70, 0.72, 0.0024), 0.04 * 0.72),
        (Command("slope", -0.05, 0.05, 0.01), 0.01),
    ],
)
def test_training_goes_beyond_a_range(command, beyond):
    assert beyond_range(command, 0.1) == pytest.approx(beyond)
    assert beyond_range(command, 0.0) == 0.0
    plan = Sampler.plan(REGIONS, SAMPLES, commands=(command,), widened=0.1)
    np.testing.assert_allclose(plan.ends[:, 0], [command.low - beyond, command.high + beyond])
    narrow = Sampler.plan(REGIONS, SAMPLES, commands=(command,))
    np.testing.assert_allclose(narrow.ends[:, 0], [command.low, command.high])
