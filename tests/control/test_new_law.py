"""A new control law is a file and an entry: it walks, and pages and refusals know its name."""

import shutil
from pathlib import Path

import pytest

from neuralgaits._control_laws import CONTROL_LAWS, ControlLaw
from neuralgaits.control.law_by_name import law_named
from neuralgaits.errors import InputError
from neuralgaits.simulation.native.native_scene import knows
from neuralgaits.workflows.report import write_report
from neuralgaits.workflows.simulate import simulate
from support.shipped_run import SHIPPED


@pytest.fixture
def soft(monkeypatch):
    entry = ControlLaw("a PD of half the strength", "support.soft_law:Soft")
    monkeypatch.setitem(CONTROL_LAWS, "soft", entry)


def test_a_law_of_one_file_and_one_entry_walks_and_is_named(soft, tmp_path):
    run = shutil.copytree(SHIPPED, tmp_path / "run")
    done = simulate(run, controller="soft", steps=1)
    assert (done.summary.controller, done.summary.engine) == ("soft", "jax")
    write_report(run, out=tmp_path / "report.html")
    assert "under a PD of half the strength" in (tmp_path / "report.html").read_text()
    every = "pd, fblin, paper, clf-qp, scheduled-pd"
    with pytest.raises(InputError, match=f"expected one of {every}, soft"):
        simulate(run, controller="hard", steps=1)
    compiled = every.replace(", sch", " or sch")
    for name, found in (("c", "c,"), ("soft", "a law of type Soft")):
        with pytest.raises(InputError, match=f"expected {compiled}, found {found}"):
            simulate(run, controller=name, engine="native", steps=1)


def test_compiled_laws_are_those_that_the_compiled_walk_knows(soft):
    for name, entry in CONTROL_LAWS.items():
        assert knows(law_named(name)) is entry.compiled


def test_exported_laws_are_those_that_say_so_in_c(soft):
    for name, entry in CONTROL_LAWS.items():
        form = law_named(name).in_c()
        assert entry.exported is (form is not None and form.exported), name


def test_the_page_of_laws_has_a_row_for_each():
    page = (Path(__file__).parents[2] / "docs" / "control.md").read_text(encoding="utf-8")
    for name in CONTROL_LAWS:
        assert f"| `{name}` |" in page or f"| [`{name}`]" in page, name
