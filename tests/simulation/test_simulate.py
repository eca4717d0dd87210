"""The verb's workflow, on a run whose gait is a published one."""

import json

import numpy as np
import pytest

from neuralgaits import logs
from neuralgaits.analysis.run import Run
from neuralgaits.barriers import Gait, Tube, specs
from neuralgaits.errors import InputError, NeuralGaitsError
from neuralgaits.runs import RunFolder, to_json
from neuralgaits.simulation import video as films
from neuralgaits.simulation.trained_walks import TrainedWalks
from neuralgaits.workflows.simulate import simulate

FIELDS = {
    "steps_walked",
    "fell",
    "speed_m_s",
    "step_time_s",
    "cost_of_transport",
    "max_output_error_rad",
    "peak_torque_nm",
    "min_normal_force_n",
    "saturated_fraction",
    "poincare",
    "sim_steps_per_s",
}


@pytest.fixture(scope="module")
def run(amber, slow, tmp_path_factory):
    policy, _ = slow
    start, guard = (float(end) for end in policy.z1_range)
    tube = Tube.between_energies(amber, (0.25, 0.4), height=0.85, span=(start, guard))
    folder = RunFolder.create({}, {}, name="amber3m", seed=0, root=tmp_path_factory.mktemp("runs"))
    return Run(folder, amber, specs.walking(amber), Gait(policy, tube))


@pytest.fixture(scope="module")
def walked(run, tmp_path_factory):
    log = tmp_path_factory.mktemp("logs") / "walk.csv"
    begun = []
    walks = {"controller": "fblin", "steps": 4, "episodes": 2, "start": "region"}
    done = simulate(run, **walks, log=log, begun=lambda: begun.append(1))
    assert begun == [1]
    return done, log


def test_the_summary_has_the_agreed_fields(walked):
    summary = walked[0].summary
    assert set(summary) >= FIELDS
    assert summary["steps_walked"] == [4, 4]
    assert summary["fell"] == [False, False]
    assert set(summary["poincare"]) == {"multiplier", "period_s", "step_length_m"}


def test_ticks_of_a_logged_walk_are_at_hand(run, walked):
    simulation, file = walked
    assert len(simulation.logs) == 2
    log, written = simulation.logs[0], logs.read(file, run.robot).log
    assert log.q.shape == (len(log.t), run.robot.n)
    assert repr(log).startswith(f"<Log of episode 0: {len(log)} rows, ")
    np.testing.assert_array_equal(log.stance, written.stance)
    np.testing.assert_allclose(log.q, written.q, rtol=1e-9, atol=1e-12)
    np.testing.assert_allclose(log.tau, written.tau, rtol=1e-9, atol=1e-9)


def test_the_periodic_orbit_is_the_one_that_is_walked(walked):
    summary = walked[0].summary
    assert 0.0 < summary["poincare"]["multiplier"] < 1.0
    assert summary["step_time_s"] == pytest.approx(summary["poincare"]["period_s"], rel=0.1)


def test_the_summary_is_json_and_in_the_run_folder(run, walked):
    assert json.loads(to_json(walked[0].summary)) == walked[0].summary
    assert run.folder.read_json("simulation/summary.json") == walked[0].summary


def test_the_summary_says_what_was_asked_so_that_it_can_be_repeated(walked):
    summary = walked[0].summary
    assert (summary["steps"], summary["episodes"], summary["seed"]) == (4, 2, 0)
    assert summary["law"] == {"bandwidth": 30.0, "hold_ticks": 1}


def _no_screen(model):
    raise InputError("video needs OpenGL")


def _no_walk(*arguments, **settings):
    raise AssertionError("walked before the outputs were checked")


def test_outputs_that_cannot_be_written_are_refused_before_the_walk(run, tmp_path, monkeypatch):
    pytest.importorskip("imageio_ffmpeg")
    monkeypatch.setattr(TrainedWalks, "walk", _no_walk)
    monkeypatch.setattr(films, "_renderer", _no_screen)
    with pytest.raises(InputError, match="video needs OpenGL"):
        simulate(run, steps=1, video=tmp_path / "walk.mp4")
    (tmp_path / "file").touch()
    with pytest.raises(InputError, match="expected a file that can be written"):
        simulate(run, steps=1, log=tmp_path / "file" / "deeper" / "walk.csv")
    assert [path.name for path in tmp_path.iterdir()] == ["file"]


def test_a_log_that_fails_late_does_not_cost_the_summary(run, walked, tmp_path, monkeypatch):
    def disk_full(path, log):
        raise OSError("no space left")

    monkeypatch.setattr(logs, "write", disk_full)
    with pytest.raises(OSError, match="no space left"):
        simulate(run, controller="paper", steps=1, log=tmp_path / "walk.csv")
    kept = run.folder.read_json("simulation/summary.json")
    run.folder.write_json("simulation/summary.json", walked[0].summary)
    assert kept["controller"] == "paper"
    assert kept["law"]["stiffness"] == [578.0] * 4


def test_every_walk_has_a_log_of_its_own(amber, walked):
    simulation, first = walked
    files = [first, first.with_name("walk-1.csv")]
    assert simulation.summary["logs"] == [str(file) for file in files]
    read = [logs.read(file, amber).log for file in files]
    for log, ticks in zip(read, simulation.walk.episodes.gauge.ticks, strict=True):
        assert len(log) == ticks
        assert np.count_nonzero(np.diff(log.stance)) == 4
    assert np.abs(read[0].q[0] - read[1].q[0]).max() > 1e-3


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"start": "middle"}, "expected one of centre, region, fixed-point, found 'middle'"),
        ({"episodes": 0}, "at least 1 episode, found 0"),
        ({"seed": -1}, "a seed from 0 to 2147483647, found -1"),
        ({"disturb": "wind=3"}, "unknown disturbance 'wind'"),
        ({"plant": "amber4m"}, "unknown robot amber4m"),
        ({"video": "walk.gif"}, "ends in .mp4"),
        ({"log": "."}, "found a folder at ."),
    ],
)
def test_bad_input_is_refused_before_anything_is_written(run, walked, change, says):
    before = run.folder.read_json("simulation/summary.json")
    with pytest.raises(InputError) as refusal:
        simulate(run, steps=1, **change, begun=pytest.fail)
    assert says in str(refusal.value)
    assert run.folder.read_json("simulation/summary.json") == before


def test_a_run_that_is_not_there_is_refused(tmp_path):
    with pytest.raises(NeuralGaitsError, match="expected a run folder"):
        simulate(tmp_path / "none")
