"""`simulate --monitor`: the same sets as in C, on the states that the controller had."""

import json
import shutil
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import jax.numpy as jnp
import numpy as np
import pytest

from neuralgaits import logs
from neuralgaits.analysis.run import open_run
from neuralgaits.analysis.step_parameters import step_parameters
from neuralgaits.cli.brief import brief_walks
from neuralgaits.cli.screen import show_walks
from neuralgaits.errors import InputError
from neuralgaits.gait.commands import Pair
from neuralgaits.gait.policies.commanded_gait import CommandedGait
from neuralgaits.records.simulated import SimulationSummary
from neuralgaits.report.page.repeat_commands import simulating
from neuralgaits.runs import to_json
from neuralgaits.workflows import monitor_walk
from neuralgaits.workflows.monitor_walk import required_monitor
from neuralgaits.workflows.simulate import simulate
from support import commanded_run
from support.shipped_run import SHIPPED

WALKED = {"steps": 3, "start": "region", "episodes": 2, "seed": 4}


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    return open_run(shutil.copytree(SHIPPED, tmp_path_factory.mktemp("monitored") / "run"))


@pytest.fixture(scope="module")
def walked(run, tmp_path_factory):
    log = tmp_path_factory.mktemp("logs") / "walk.csv"
    return simulate(run, **WALKED, monitor=True, log=log).summary, log


def test_shares_are_those_of_the_logged_states(run, walked):
    done, log = walked
    (one,) = required_monitor(run).sets
    inside, margins, last = [], [], None
    for number, file in enumerate((log, log.with_stem("walk-1"))):
        found = logs.read(file, run.robot).log
        states = one.membership(one.margins(q=found.q, dq=found.dq))
        inside.append(states.inside)
        margins.append(states.margin)
        for tick in np.flatnonzero(~states.inside):
            last = number, found.t[tick], one.names[states.nearest[tick]]
    seen = done.monitor
    (level,) = seen.levels
    assert level == "2" and seen.ticks == sum(map(len, inside)) > 1000
    assert seen.levels[level].inside == pytest.approx(np.mean(np.concatenate(inside)), abs=1e-3)
    assert seen.levels[level].margin == pytest.approx(np.concatenate(margins).min(), abs=1e-3)
    assert 0.5 < seen.levels[level].inside < 1.0 and last is not None
    outside = seen.levels[level].last_outside
    assert (outside.walk, outside.name) == (last[0], last[2])
    assert outside.time_s == pytest.approx(last[1], abs=2e-3)
    # Nothing is proved of a clock below level 5.
    assert seen.in_time is None and seen.admissible == 1.0


def test_the_result_is_recorded_and_shown(run, walked, capsys):
    done, _ = walked
    assert SimulationSummary.of(json.loads(to_json(done))).monitor == done.monitor
    show_walks(done)
    said = " ".join(capsys.readouterr().out.split())
    assert (
        "set of level inside smallest margin last outside 2 " in said
        and "100.00 % had commands" in said
    )
    brief_walks(done)
    said = capsys.readouterr().out
    assert "in the set of level 2" in " ".join(said.split())
    assert "--monitor" in (simulating(run.folder, done, run.path) or "")


def test_without_it_nothing_changes(run, walked, tmp_path):
    _, log = walked
    done = simulate(run, **WALKED, log=tmp_path / "walk.csv").summary
    assert "monitor" not in done and done.monitor is None
    for name in ("walk.csv", "walk-1.csv"):
        assert (tmp_path / name).read_bytes() == log.with_name(name).read_bytes()
    assert "--monitor" not in (simulating(run.folder, done, run.path) or "--monitor")


def test_a_run_without_a_proof_is_refused_before_it_walks(run, tmp_path):
    other = open_run(shutil.copytree(run.path, tmp_path / "run"))
    begun = []
    (other.path / "certificate" / "proof.json").unlink()
    with pytest.raises(InputError, match=r"--monitor: expected .*proof.json is missing; prove it"):
        simulate(other, monitor=True, steps=1, begun=lambda: begun.append(1))
    shutil.rmtree(other.path / "certificate")
    with pytest.raises(
        InputError, match=r"found none: it has no certificate; prove it \(.*certify"
    ):
        simulate(other, monitor=True, steps=1, begun=lambda: begun.append(1))
    assert not begun


def test_workers_are_refused(run):
    with pytest.raises(InputError, match="expected --monitor without --workers"):
        simulate(run, monitor=True, workers=2)


def test_ticks_in_time_are_counted_in_whole_microseconds(run):
    """The first of a walk is in time; what comes a microsecond after the hold is late."""
    monitor = replace(required_monitor(run), hold_s=1.2349e-3)
    records: Any = [SimpleNamespace(time=np.array([0.1, 0.101, 0.102234, 0.103469]))] * 2
    assert monitor_walk._in_time(monitor, records) == 0.75


def test_steps_of_a_family_are_those_of_its_controller(tmp_path):
    run = commanded_run.make(tmp_path / "run")
    gait = run.trained
    assert isinstance(gait, CommandedGait)
    pairs = [(0.60, 0.61), (0.61, 0.62), (0.60, 0.61), (0.615, 0.612)]
    told = np.array(pairs)[:, :, None]
    found = step_parameters(run, told)
    for row, (before, after) in zip(found, pairs, strict=True):
        pair = Pair(jnp.array([before]), jnp.array([after]))
        expected = gait.policy.parameters_of_step(run.robot, pair, None)
        np.testing.assert_allclose(row, expected, rtol=0.0, atol=1e-12)
