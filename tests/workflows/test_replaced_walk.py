"""A run folder has room for one simulation: who loses an undisturbed one is told."""

import shutil

import pytest

from neuralgaits.cli.main import main
from support.shipped_run import SHIPPED

SAID = "this replaces the run's undisturbed walk, which reports show"


@pytest.fixture
def run(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    shutil.copytree(SHIPPED, "run", ignore=shutil.ignore_patterns("simulation"))
    return "run"


def test_a_disturbed_walk_says_that_it_replaces_an_undisturbed_one(run, capfd):
    words = ["simulate", run, "--steps", "1"]
    disturbed = [*words, "--disturb", "friction=0.5"]
    # There is none to lose, then one, then only a disturbed one.
    for line, told in ((disturbed, False), (words, False), (disturbed, True), (disturbed, False)):
        assert main(line) == 0
        err = capfd.readouterr().err
        assert (SAID in err) == told
        assert ("simulate run` brings that back" in err) == told
