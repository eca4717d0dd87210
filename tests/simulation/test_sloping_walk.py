"""Walks of gaits that are told a slope: both feet show it, and the next steps are told so."""

import math
from typing import Any

import numpy as np
import pytest

from neuralgaits.errors import InputError
from neuralgaits.gait.commands import Command
from neuralgaits.simulation.ticks.adapted_command import AdaptedCommand
from neuralgaits.workflows.simulate import simulate
from support.commanded_run import make

SLOPES = Command("slope", -0.05, 0.05, 0.012)


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    """A family around the shipped gait that is told slopes up to 0.05 rad either way."""
    return make(tmp_path_factory.mktemp("sloping") / "run", SLOPES)


def walked(run, degrees, *, adapt: Any = "slope", steps=12, engine: Any = "native") -> Any:
    settings: Any = {"command": {"slope": 0.0}, "disturb": {"slope_deg": degrees}}
    return simulate(run, adapt=adapt, steps=steps, engine=engine, **settings).summary


@pytest.mark.parametrize("degrees", [0.0, 1.0, -1.0])
def test_the_slope_is_learned_in_some_steps(run, degrees):
    found = walked(run, degrees)
    slopes = np.degrees(found.believed_slope.believed_rad)
    np.testing.assert_array_equal(slopes[:2], 0.0)
    assert slopes[-1] == pytest.approx(degrees, abs=0.15)
    assert np.max(np.abs(np.diff(slopes))) <= math.degrees(0.012) + 1e-9
    assert "after 12 steps; no proof" in found.believed_slope.in_words
    assert not found.believed_slope.at_end


def test_a_slope_beyond_the_range_is_believed_at_its_end(run):
    believed = walked(run, -4.0, steps=10).believed_slope
    slopes = believed.believed_rad
    assert min(slopes) == -0.05 and slopes[-1] == -0.05
    assert believed.at_end and "the end of the gait's range" in believed.in_words


@pytest.mark.slow
def test_both_engines_believe_one_slope(run):
    """The compiled walk is of the exported controller and adaptation."""
    ours, theirs = (
        np.array(walked(run, -1.0, steps=5, engine=engine).believed_slope.believed_rad)
        for engine in ("native", "jax")
    )
    np.testing.assert_allclose(ours, theirs, rtol=1e-8)
    assert ours[-1] < -0.008


def test_a_slope_that_is_not_adapted_stays_and_is_not_in_the_result(run, amber):
    adapted = AdaptedCommand(amber, (SLOPES,), np.array([0.01]), ())
    q = np.array([-0.1, 0.2, 0.1, -0.4, 0.1])
    adapted.touch_down(0.5, q, np.array([[0.01], [0.01]]), np.array([0.01]))
    assert adapted.request(np.array([0.02]))[0] == 0.02
    adapted.names = ("slope",)
    assert adapted.request(np.array([0.02]))[0] != 0.02
    with pytest.raises(InputError, match="expected a gait that takes lean as command"):
        walked(run, 0.0, adapt="lean,slope")
