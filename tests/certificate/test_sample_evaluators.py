"""What is evaluated at points for levels 4 and 5: traced when it is asked for, and once."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from neuralgaits.analysis.run import open_run
from neuralgaits.certificate.level_target import ControlAssumption, SearchTarget
from neuralgaits.certificate.levels.disturbed import search as disturbed
from neuralgaits.certificate.levels.full_order import norm_plans, sample_evaluators
from neuralgaits.certificate.levels.full_order import search as full_order
from neuralgaits.certificate.levels.full_order.norm_plans import LARGEST_OF_LAW, NormPlans
from neuralgaits.errors import SpecError
from neuralgaits.gait.output_laws import ScheduledLaw
from support.shipped_run import SHIPPED

AT = np.array([[0.5, 0.5]])


@pytest.fixture(scope="module")
def target():
    run = open_run(SHIPPED)
    return SearchTarget(run.spec, run.gait, run.zero_dynamics, lambda: lambda u: {}, disturbed=True)


def test_a_function_is_traced_when_it_is_called_first(monkeypatch, target):
    traced = []

    def trace(function, inputs):
        traced.append(inputs)
        raise SpecError("no trace")

    monkeypatch.setattr(sample_evaluators, "trace", trace)
    assert full_order.FullOrderSearch().find(target, {}) == "no trace" and len(traced) == 1
    looks = target.shared[4]
    assert looks.pushed is not None
    with pytest.raises(SpecError, match="no trace"):
        looks.pushed(AT)
    assert [shape["xi"] for shape in traced] == [(8,), (12,)]


def test_level_5_evaluates_what_level_4_left(monkeypatch, target):
    calls = []

    def leaving(model, *given, evaluators, control):
        assert control is target.control
        calls.append(evaluators)
        return "no set"

    control = ControlAssumption(free_clock=True, error=0.25)
    target = replace(target, control=control, shared={})
    monkeypatch.setattr(full_order, "set_of", leaving)
    assert full_order.FullOrderSearch().find(target, {}) == "no set"
    monkeypatch.setattr(disturbed, "find_disturbed", lambda looks, *given: looks)
    monkeypatch.setattr(disturbed, "evaluators_in_norm", lambda model, full, looks: (looks, {}))
    found, _ = disturbed.DisturbedSearch().find(target, {4: SimpleNamespace(bandwidth=30.0)})
    assert found[0] is calls[0] is target.shared[4]


def test_a_law_that_is_not_exact_is_evaluated_in_its_place(target):
    """Of scheduled PD errors at eta = 0 are small, and their slope is not zero."""
    run = open_run(SHIPPED)
    model = full_order.FullOrderModel(run.robot, run.gait, run.spec, 40.0)
    scheduled = replace(target, control=ControlAssumption(scheduled=True))
    assert scheduled.gains is not None and target.gains is None
    law = ScheduledLaw(scheduled.gains, run.gait)
    for looks, exact in (
        (sample_evaluators.evaluators_of(model), True),
        (sample_evaluators.evaluators_of(model, law), False),
    ):
        assert looks.pushed is not None
        seen = looks.pushed(AT)
        assert np.abs(seen["law"]).max() < 1.0
        assert (np.abs(seen["law/slope"]).max() == 0.0) == exact
        # Both grow as outputs do that nothing but themselves moves, to a fifth.
        own = 40.0**3 * np.concatenate([np.eye(4), np.eye(4)], axis=1)
        assert np.linalg.norm(seen["jerk/slope"][0] + own, 2) < 0.5 * 40.0**3


@pytest.mark.slow
def test_the_longest_hold_of_a_law_is_looked_for_where_its_decay_is_bounded(target, monkeypatch):
    """Bounds of the decay fail in larger sets, which estimates would otherwise choose."""
    run = open_run(SHIPPED)
    model = full_order.FullOrderModel(run.robot, run.gait, run.spec, 50.0)
    scheduled = replace(target, control=ControlAssumption(scheduled=True))
    assert scheduled.gains is not None
    law = ScheduledLaw(scheduled.gains, run.gait)
    looks = sample_evaluators.evaluators_of(model, law)
    samples = sample_evaluators.sample_gait(looks)
    assert samples is not None
    # About the norm that is found for this gait.
    matrix = np.array([[1.4, 2.3, 0.3, 0.1], [0, 1.7, 0.4, 0.1], [0, 0, 1.1, 0.3], [0, 0, 0, 0.4]])
    plans = NormPlans(samples, 50.0, matrix, held=True)
    best = plans.best()
    assert best.hold > 1e-3
    assert 0.95 * LARGEST_OF_LAW < best.radius <= LARGEST_OF_LAW
    assert plans.rest > 0.0
    exact = replace(samples, law=samples.law._replace(in_xi=0.0 * samples.law.in_xi))
    without = NormPlans(exact, 50.0, matrix, held=True)
    radius = without.best().radius
    assert without.rest == 0.0
    with monkeypatch.context() as patch:
        patch.setattr(norm_plans, "LARGEST_OF_LAW", 5e-3)
        smaller = NormPlans(samples, 50.0, matrix, held=True).best()
        assert smaller.radius <= 5e-3 and smaller.hold < best.hold
        assert NormPlans(exact, 50.0, matrix, held=True).best().radius == radius
    # Level 4 bounds torques of exact linearisation: a law's sets leave them more room.
    monkeypatch.setattr(norm_plans, "TORQUE_SPARE", 3.0)
    assert plans.best().hold < 0.9 * best.hold
    assert without.best().radius == radius
