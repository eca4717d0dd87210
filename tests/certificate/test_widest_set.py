"""The largest set of level 4 for a bandwidth: found in a norm of its own, and tried by force."""

import re
from dataclasses import replace

import numpy as np
import pytest

from neuralgaits.certificate.levels.full_order import norm
from neuralgaits.certificate.levels.full_order.inequalities import inequalities
from neuralgaits.certificate.levels.full_order.norm import find_widest
from neuralgaits.certificate.levels.full_order.norm_plans import NormPlans
from neuralgaits.certificate.levels.full_order.sample_evaluators import (
    evaluators_of,
    sample_gait,
    set_of,
)
from neuralgaits.certificate.levels.full_order.theorem import FullOrderConstants, weighting
from neuralgaits.errors import InputError
from neuralgaits.settings import CertifySettings
from neuralgaits.workflows.certify import certify
from support.full_order_check import check_by_force, model_of, walker

pytestmark = pytest.mark.slow
W = 20.0


@pytest.fixture(scope="module")
def model(trained):
    return model_of(trained, W)


@pytest.fixture(scope="module")
def looks(model):
    return evaluators_of(model)


@pytest.fixture(scope="module")
def seen(looks):
    return sample_gait(looks)


@pytest.fixture(scope="module")
def shape(model, looks):
    found = set_of(model, widest=True, evaluators=looks)
    assert isinstance(found, FullOrderConstants), found
    return found


def test_it_is_larger_than_the_usual_one_at_both_ends_of_a_step(trained, shape):
    usual = set_of(model_of(trained, 30.0))
    assert isinstance(usual, FullOrderConstants)
    assert all(inequality.holds for inequality in inequalities(shape))
    # In plain coordinates, too: the largest ball around zero that is inside.
    stretch = np.linalg.norm(weighting(shape.weights, 4), 2)
    assert shape.radius / stretch > 0.9 * usual.radius
    assert shape.guard_radius / stretch > 2.0 * usual.guard_radius
    assert shape.radius > 0.015 and shape.guard_radius > 0.0015


def test_no_walk_of_the_model_leaves_it(trained, shape):
    walking = walker(trained, shape.bandwidth, 2, shape.weights)
    found = check_by_force(trained, shape, walks=300, steps=2, walking=walking)
    assert found.left == 0, found.least
    # Walks that begin on the rim of a set a little larger than the theorem's are not all inside.
    larger = replace(shape, radius=1.5 * shape.radius, shrink=1.6 * shape.shrink)
    assert check_by_force(trained, larger, walks=300, steps=2, walking=walking).left > 0


def test_without_a_norm_of_its_own_impacts_would_not_fit_in(seen):
    plain = NormPlans(seen, W, np.eye(4))
    assert plain.slack_of_impacts < 0.0 and plain.widest().radius == 0.0
    plan = find_widest(seen, W)
    assert plan is not None and plan.planned.slack_of_impacts == 0.0
    assert plan.radius > 0.015
    # A little more, and something gives way; a smaller one is a set as well.
    assert plan.planned.still(1.01 * plan.radius).radius == 0.0
    assert plan.smaller(0.5).radius == pytest.approx(0.5 * plan.radius)


def test_norms_that_are_compared_have_one_size(seen, monkeypatch):
    """Limits on radii and errors are absolute: a smaller S would only seem to keep to them."""
    tried = []

    class Plans(NormPlans):
        def __init__(self, samples, bandwidth, matrix, *more):
            tried.append(np.linalg.det(matrix))
            super().__init__(samples, bandwidth, matrix, *more)

    monkeypatch.setattr(norm, "NormPlans", Plans)
    plan = find_widest(seen, W)
    assert plan is not None and len(tried) > 100
    np.testing.assert_allclose(tried[:-1], 1.0, rtol=1e-9)
    assert tried[-1] == pytest.approx(1.0, rel=1e-3)  # Rounded for people to read.


def test_outputs_too_slow_for_any_norm_are_told_by_the_inequality_that_breaks(trained):
    found = set_of(model_of(trained, 8.0), widest=True)
    assert isinstance(found, str) and "after an impact" in found


@pytest.mark.parametrize(
    ("bandwidth", "level", "words"),
    [(0.0, 4, "of 1 to 1000 rad/s"), (float("nan"), 4, "of 1 to 1000 rad/s"), (20.0, 3, "--level")],
)
def test_bandwidths_that_make_no_statement_are_refused(trained, bandwidth, level, words):
    with pytest.raises(InputError, match=words):
        certify(trained, level=level, bandwidth=bandwidth)


@pytest.mark.parametrize(
    ("error", "level", "words"),
    [(-0.1, 5, "of 0 rad/s^2 or more"), (float("nan"), 5, "found nan"), (0.1, 4, "--level")],
)
def test_errors_of_torques_that_make_no_statement_are_refused(error, level, words):
    with pytest.raises(InputError, match=re.escape(words)):
        CertifySettings("latest", level=level, error=error)
