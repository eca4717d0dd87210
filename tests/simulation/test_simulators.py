"""Choosing what steps the plant: refusals, with Drake there or not."""

import sys

import pytest

from neuralgaits.analysis.run import open_run
from neuralgaits.cli.main import main
from neuralgaits.errors import InputError
from neuralgaits.simulation.simulators import check_simulator
from neuralgaits.simulation.trained_walks import walk_engine_for
from support.shipped_run import SHIPPED


def test_without_drake_one_line_says_how_to_get_it(capfd, monkeypatch):
    monkeypatch.setitem(sys.modules, "pydrake", None)
    monkeypatch.delitem(sys.modules, "neuralgaits.simulation.drake", raising=False)
    assert main(["simulate", str(SHIPPED), "--simulator", "drake", "--json"]) == 2
    said = capfd.readouterr()
    assert said.out == "" and said.err.count("\n") == 1
    assert "expected Drake" in said.err and "pip install 'neuralgaits[drake]'" in said.err


def test_a_simulator_that_is_not_known_is_refused():
    check_simulator("mujoco")
    with pytest.raises(InputError, match="expected mujoco or drake, found 'bullet'"):
        check_simulator("bullet")


def test_the_compiled_loop_is_refused_where_it_cannot_walk():
    run = open_run(SHIPPED)
    with pytest.raises(InputError, match="--engine native: expected --simulator mujoco"):
        walk_engine_for(run, "pd", "native", "drake")
    assert walk_engine_for(run, "pd", None, "drake").library is None
