"""A robot on flat feet through the verbs: trained, proved, and walked by both loops."""

import shutil

import numpy as np
import pytest

import neuralgaits as ng
from neuralgaits.certificate.levels.full_order.model import FullOrderModel
from neuralgaits.errors import InputError, SpecError
from neuralgaits.simulation.native_walk import engine_of_run
from neuralgaits.simulation.setup.disturbance import parse
from neuralgaits.simulation.setup.plant import build
from neuralgaits.simulation.setup.starts import full_states, momentum_range
from neuralgaits.simulation.walk import walk

pytestmark = pytest.mark.slow
SETTLED = 0.02
"""Time after a touchdown in which a soft contact may still move a foot [s]."""


@pytest.fixture(scope="module")
def run(feet_run, tmp_path_factory):
    """A copy, which is certified later."""
    return ng.open_run(shutil.copytree(feet_run.path, tmp_path_factory.mktemp("feet") / "run"))


@pytest.fixture(scope="module")
def walked(run):
    """Function from loop, law, disturbance and steps to a recorded walk."""
    library = engine_of_run(run, "native").library
    start = full_states(run.zero_dynamics, run.gait, "centre", seed=0, episodes=1)

    def go(engine, law, disturb="", steps=4):
        found = walk(
            run.robot,
            run.gait.policy,
            start,
            controller=law,
            steps=steps,
            z2_range=momentum_range(run.gait),
            disturbance=parse(disturb),
            record=True,
            library=library if engine == "native" else None,
        )
        assert found.engine == engine
        return found.episodes

    return go


def test_all_conditions_hold_on_samples_and_the_spec_is_the_one_of_flat_feet(run):
    assert not run.summary.broken
    assert run.config.spec == "walking-flat-feet"
    assert "old-sole-leaves" in run.folder.copy("spec.py")


def test_proved_to_level_3_and_no_further(run):
    found = ng.certify(run)
    assert found.summary.verdict == "proved"
    assert [(entry.level, entry.proved) for entry in found.summary.levels] == [(2, True), (3, True)]
    for level in (4, 5):
        with pytest.raises(InputError, match=f"on flat feet, found {level}: .* about point feet"):
            ng.certify(run, level=level)
    assert run.config.on_flat_feet and run.config.last_level == 3
    with pytest.raises(SpecError, match="it is about point feet"):
        FullOrderModel(run.robot, run.gait, run.spec)


def test_floors_of_unknown_height_are_of_point_feet(run):
    with pytest.raises(InputError, match="floors of unknown height are about point feet"):
        ng.certify(run, parameters={"floor": 0.005})


@pytest.mark.parametrize(
    ("law", "disturb"),
    [("pd", ""), ("fblin", ""), ("clf-qp", ""), ("pd", "estimator=1,encoder_step=4e-4")],
)
def test_compiled_and_reference_loops_walk_alike(walked, law, disturb):
    native, reference = (walked(engine, law, disturb) for engine in ("native", "jax"))
    assert native.endings == reference.endings and not native.endings[0].fell
    scale = np.max(np.abs(reference.states), axis=0)
    np.testing.assert_allclose(native.states / scale, reference.states / scale, atol=1e-7)


def test_stance_feet_stay_flat_and_the_ankle_pushes(run, walked):
    found = walked("jax", "pd", steps=8)
    record, states = found.record, build(run.robot).state_map
    sensors = states.sensors(*np.split(found.states[:, 1:], 2, axis=1))
    leg = np.asarray(record.result.leg)
    foot = sensors.pitch - sensors.joints[np.arange(len(leg)), leg].sum(axis=1)
    settled = np.asarray(record.result.since_touchdown) > SETTLED
    assert np.max(np.abs(foot[settled])) < 2e-3
    assert np.ptp(np.asarray(record.result.ankle)) > 0.1
