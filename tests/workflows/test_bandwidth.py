"""A bandwidth of the control law: from the command to the walk, its record and its repetition."""

import json
import shutil

import pytest

from neuralgaits.analysis.run import open_run
from neuralgaits.certificate.run_certificate.proved_law import ProvedLaw
from neuralgaits.control.law_by_name import at_bandwidth, exported_laws, fields_of_law, law_named
from neuralgaits.errors import InputError
from neuralgaits.records.simulated import SimulationSummary
from neuralgaits.report.page.repeat_commands import simulating
from neuralgaits.report.shown_walk import request_of
from neuralgaits.runs import to_json
from neuralgaits.workflows import proved_controller
from neuralgaits.workflows.simulate import simulate
from support.shipped_run import SHIPPED

WALKED = {"steps": 4, "controller": "scheduled-pd"}


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    return open_run(shutil.copytree(SHIPPED, tmp_path_factory.mktemp("walked") / "run"))


@pytest.fixture(scope="module")
def walked(run):
    return {w: simulate(run, **WALKED, bandwidth=w) for w in (None, 40.0, 50.0)}


def walk_of(simulation):
    return simulation.summary.max_output_error_rad


def test_it_is_that_of_the_law_that_walks(walked):
    found = {w: walk_of(one) for w, one in walked.items()}
    assert found[None] == found[40.0] != found[50.0]
    assert walked[None].walk.law.bandwidth == 40.0
    assert walked[50.0].walk.law.bandwidth == walked[50.0].summary.law["bandwidth"] == 50.0


def test_it_is_recorded_shown_and_repeated(run, walked):
    asked = {w: one.summary for w, one in walked.items()}
    assert "bandwidth" not in asked[None]
    again = SimulationSummary.of(json.loads(to_json(asked[50.0])))
    assert again.bandwidth == 50.0
    assert again.walked_by == "under scheduled-pd at 50 rad/s in MuJoCo"
    line = simulating(run.folder, again, run.path)
    assert line is not None and "--controller scheduled-pd --bandwidth 50" in line
    line = simulating(run.folder, asked[None], run.path)
    assert line is not None and "--bandwidth" not in line
    run.folder.write_json("simulation/summary.json", again)
    assert request_of(run).bandwidth == 50.0


def test_that_of_a_proof_is_taken_if_none_is_given(run, walked, monkeypatch):
    """As a proof of level 5 about this law; a law that it is not about keeps its own."""
    proved = ProvedLaw("scheduled-pd", 50.0, 1.1e-3, "touchdown")
    monkeypatch.setattr(proved_controller, "proved_law", lambda certificate: proved)
    taken, other = simulate(run, **WALKED), simulate(run, **WALKED, bandwidth=40.0)
    assert taken.summary.bandwidth == taken.summary.law["bandwidth"] == 50.0
    assert walk_of(taken) == walk_of(walked[50.0])
    assert other.summary.law["bandwidth"] == 40.0
    assert simulate(run, steps=2, controller="fblin").summary.law["bandwidth"] == 30.0


@pytest.mark.slow
def test_workers_walk_with_it(run, walked):
    shared = simulate(run, **WALKED, bandwidth=50.0, workers=1)
    assert walk_of(shared) == walk_of(walked[50.0])


def test_laws_with_and_without_one():
    for name in ("fblin", "scheduled-pd", "clf-qp"):
        assert fields_of_law(at_bandwidth(name, 55.0))["bandwidth"] == 55.0
        assert at_bandwidth(name, None) is law_named(name)
    usual, wide = exported_laws(), exported_laws(55.0)
    assert list(wide) == list(usual) and wide["pd"] is usual["pd"]
    for laws, expected in ((wide, 55.0), (usual, 30.0)):
        assert fields_of_law(laws["fblin"])["bandwidth"] == expected
    for name in ("pd", "paper"):
        with pytest.raises(InputError, match=r"--bandwidth: expected a law.*or scheduled-pd, fou"):
            at_bandwidth(name, 55.0)


def test_what_has_none_or_cannot_change_it_is_refused(run):
    with pytest.raises(InputError, match=r"fblin, clf-qp or scheduled-pd, found pd: leave --band"):
        simulate(run, bandwidth=50.0)
    with pytest.raises(InputError, match="found paper"):
        simulate(run, controller="c", link="law=paper", bandwidth=50.0)
    with pytest.raises(InputError, match=r"found --link address: that process was compiled with"):
        simulate(run, controller="c", link="law=fblin,address=127.0.0.1:9", bandwidth=50.0)
    with pytest.raises(InputError, match="expected a bandwidth of 1 to 1000 rad/s, found nan"):
        simulate(run, **WALKED, bandwidth=float("nan"))
