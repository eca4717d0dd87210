"""What a prompt and a notebook show of robots, runs, certificates and simulations."""

import json
import re
import shutil
from typing import cast

import equinox as eqx
import jax.numpy as jnp
import pytest

import neuralgaits as ng
from neuralgaits import _notebook
from neuralgaits.records.certified import CertificateRecord
from neuralgaits.records.simulated import SimulationSummary
from neuralgaits.runs.plain import plain
from neuralgaits.simulation.walk import Walk
from neuralgaits.workflows.certify import CertifyResult
from neuralgaits.workflows.simulation import Simulation
from support.shipped_run import SHIPPED


@pytest.fixture(scope="module")
def shipped():
    return ng.open_run(SHIPPED)


@pytest.fixture(scope="module")
def proved():
    return CertificateRecord.read(SHIPPED / "certificate" / "summary.json")


def test_a_robot_is_a_line():
    robot = ng.load_robot("amber3m")
    assert repr(robot) == "<PlanarBiped amber3m: 21.6 kg, legs of 0.873 m, 4 motors>"
    page = robot._repr_html_()
    assert page.count("<tr>") == 5 and "-1.6 to 1.6" in page


def test_a_robot_that_is_traced_has_a_line_too():
    told = []

    @eqx.filter_jit
    def look(robot):
        told.append(repr(robot))
        return jnp.zeros(())

    # Its arrays and its mass as arguments.
    arrays = eqx.tree_at(lambda r: r.mass, ng.load_robot("amber3m"), jnp.asarray(21.0))
    look(arrays)
    assert told == ["<PlanarBiped amber3m: 4 motors>"]


def test_a_run_is_a_line_and_its_tightest_conditions(tmp_path):
    folder = shutil.copytree(SHIPPED, tmp_path / "run")
    summary = json.loads((folder / "summary.json").read_text())
    summary["conditions"]["flow-above-lower-fence"]["min_margin"] = 0.0012345
    (folder / "summary.json").write_text(json.dumps(summary))
    run = ng.open_run(folder)
    assert repr(run) == (
        f"<Run {folder}: amber3m, spec walking, seed 0, recorded in training: all 27 conditions "
        "hold on fresh samples>"
    )
    page = run._repr_html_()
    assert "least margin recorded on samples" in page
    first, *others = re.findall("<td[^>]*>(.*?)</td>", page)[::2]
    assert page.count("<tr>") == 6 and len(others) == 4
    assert first == "flow-above-lower-fence" and "0.00123<" in page


def test_a_damaged_run_is_shown_all_the_same(shipped, tmp_path):
    folder = shutil.copytree(SHIPPED, tmp_path / "run")
    run = ng.open_run(folder)
    (folder / "summary.json").write_text("{}")
    assert repr(run) == f"<Run {folder}: amber3m, files damaged>"
    assert "damaged" in run._repr_html_()


def test_a_certificate_is_a_line_with_a_bound_that_is_true(proved):
    said = repr(CertifyResult(proved))
    assert said.startswith("<Certificate of amber3m, spec walking: proved to level 3, ")
    shown = float(said.split("at least ")[1].split()[0])
    assert proved.least_margin - 1e-3 < shown <= proved.least_margin
    page = CertifyResult(proved)._repr_html_()
    assert page.count("<tr>") == 1 + 3 + 5 and "level 3" in page


def test_a_certificate_that_is_undecided_names_what_is(proved):
    content = plain(dict(proved))
    content["verdict"] = "undecided"
    content["conditions"]["knee"] |= {"verdict": "undecided", "margin": None}
    shown = CertifyResult(CertificateRecord.of(content))
    assert repr(shown) == "<Certificate of amber3m, spec walking: undecided at level 3>"
    page = shown._repr_html_()
    assert page.index("knee") < page.index("flow-above-lower-fence")


def test_a_simulation_is_a_line():
    found = SimulationSummary.of(
        {
            "plant": "amber3m",
            "controller": "pd",
            "start": "centre",
            "seed": 0,
            "episodes": 2,
            "steps_walked": [50, 7],
            "fell": [False, True],
            "fall_reasons": [None, "hip too low"],
        }
    )
    assert repr(Simulation(walk=cast(Walk, None), summary=found)) == (
        "<Simulation of amber3m under pd: 1 of 2 walks stayed up, 7 to 50 steps>"
    )


def test_what_a_user_wrote_is_text():
    page = _notebook.table("<script>", [("<b>", 1)], ("&", ""))
    assert "<script>" not in page and "&lt;b&gt;" in page and "&amp;" in page
