"""Optimised gaits, looked at by what had no part in finding them."""

import numpy as np
import pytest

from neuralgaits.errors import ConvergenceError, InputError
from neuralgaits.gait import ZeroDynamics
from neuralgaits.hzd import solver
from neuralgaits.hzd.collocation import nodes
from neuralgaits.hzd.given_orbit import steady
from neuralgaits.records.training_config import GaitOrigin
from neuralgaits.workflows.given_run import given_run
from support import published_gaits


def test_integrals_at_nodes_are_exact_for_polynomials():
    mesh = nodes(8)
    assert mesh.phases[0] == 0.0 and mesh.phases[-1] == 1.0
    for power in range(9):
        integral = mesh.integrals @ mesh.phases**power
        np.testing.assert_allclose(integral, mesh.phases ** (power + 1) / (power + 1), atol=1e-14)


def test_integrals_at_nodes_of_a_smooth_function():
    mesh = nodes(20)
    found = mesh.integrals @ np.exp(mesh.phases)
    np.testing.assert_allclose(found, np.exp(mesh.phases) - 1.0, atol=1e-14)


@pytest.fixture(scope="module")
def optimiser(amber):
    pytest.importorskip("casadi")
    return solver.Optimiser(amber)


@pytest.fixture(scope="module")
def optimised(amber, optimiser, tmp_path_factory):
    """A run at the speed of a published gait."""
    root = tmp_path_factory.mktemp("runs")
    speed = published_gaits.GAITS["0.67"]["recomputed"]["steady"]["v"]
    given = GaitOrigin("optimise", solver.DEGREE, speed)
    gait = optimiser.at(speed).gait
    return given_run(
        ZeroDynamics(amber, gait.policy), gait, given, start_time=0.0, out=root / "run", root=root
    )


@pytest.mark.slow
def test_the_flow_walks_as_the_optimisation_says(optimised):
    """Speed, impact and conditions by the package's own flow, which knows nothing of nodes."""
    found, asked = optimised.summary, optimised.config.given.speed
    assert found.speed_m_s == pytest.approx(asked, rel=1e-6)
    assert found.after_impact["output_rad"] < 1e-6 and found.after_impact["rate_rad_s"] < 1e-5
    assert found.broken == {}
    least = published_gaits.GAITS["0.67"]["recomputed"]["steady"]["mech_cot"]
    assert found.cost_of_transport < 0.5 * least


@pytest.mark.slow
def test_a_speed_without_a_gait_is_refused(optimiser):
    with pytest.raises(ConvergenceError, match="at 4 m/s, found that IPOPT ended with") as refusal:
        optimiser.at(4.0)
    assert "\n" not in str(refusal.value)


def test_a_slow_gait_has_the_orbit_that_was_asked_for(optimiser, amber):
    """At mid-step it is barely faster than what falls back."""
    walk = steady(ZeroDynamics(amber, optimiser.at(0.35).gait.policy))
    assert not isinstance(walk, str)
    assert walk.speed_m_s == pytest.approx(0.35, rel=1e-6) and 0.0 < walk.multiplier < 0.95


def test_a_missing_extra_is_one_line(amber, monkeypatch):
    monkeypatch.setattr(solver, "find_spec", lambda name: None)
    with pytest.raises(InputError, match=r"pip install 'neuralgaits\[hzd\]'"):
        solver.Optimiser(amber)
