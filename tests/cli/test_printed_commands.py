"""Every command that the program prints can be typed: for a robot of its own and for the user's."""

import json
import math
import shlex
import shutil
from dataclasses import replace
from pathlib import Path

import pytest

from neuralgaits.analysis.run import open_run
from neuralgaits.cli.arguments import CertifyOptions, TrainOptions
from neuralgaits.cli.argv_parser import read, verb_name
from neuralgaits.cli.main import main
from neuralgaits.records.simulated import WALK_SUMMARY, SimulationSummary
from neuralgaits.report.page.repeat_commands import certifying, simulating
from neuralgaits.robots import registry
from neuralgaits.runs import RunFolder
from neuralgaits.viewer.sureness import how_sure
from support import small_spec
from support.printed import check, on_page, on_screen
from support.shipped_run import SHIPPED

pytestmark = pytest.mark.slow


class Place:
    """A folder to work in, with what was printed there."""

    def __init__(self, path, run):
        self.path, self.run = path, run
        self.screens = ""

    def call(self, capfd, *words):
        code = main(list(words))
        told = capfd.readouterr()
        self.screens += told.out + told.err
        return code


@pytest.fixture(scope="module")
def own(tmp_path_factory):
    """A robot and a spec of a user's, in files and folders with blanks, trained for two steps."""
    path = tmp_path_factory.mktemp("own")
    robots = path / "my robots"
    robots.mkdir()
    text = registry.model_file("amber3m").read_text(encoding="utf-8")
    changed = text.replace('model="amber3m"', 'model="stilts"')
    assert changed != text
    (robots / "stilts.xml").write_text(changed, encoding="utf-8")
    shutil.copy(small_spec.__file__, robots / "my spec.py")
    return Place(path, Path("my runs/first run"))


@pytest.fixture(scope="module")
def built_in(tmp_path_factory):
    """The run that ships with the package, in a folder whose name begins like a flag."""
    path = tmp_path_factory.mktemp("built-in")
    shutil.copytree(SHIPPED, path / "-a run")
    return Place(path, Path("-a run"))


@pytest.fixture
def at(monkeypatch):
    def go(place):
        monkeypatch.chdir(place.path)
        return place

    return go


def test_commands_about_a_run_of_an_own_robot(own, at, capfd):
    place, robot = at(own), "my robots/stilts.xml"
    spec = "my robots/my spec.py:small"
    line = ("train", robot, "--spec", spec, "--steps", "2", "--out", str(place.run))
    assert place.call(capfd, *line) == 0
    # The files it was made of may go: the run has copies.
    assert place.call(capfd, "simulate", "latest", "--plant", robot, "--steps", "1") in (0, 1)
    assert place.call(capfd, "certify", "latest", "--level", "1", "--budget", "0.5") in (1, 3)
    shutil.rmtree("my robots")
    assert place.call(capfd, "report", str(place.run)) == 0
    page = (place.run / "report.html").read_text()
    asked = check(on_page(page))
    kinds = {verb_name(type(verb)) for verb in asked}
    assert kinds >= {"train", "simulate", "certify", "report", "fit", "episodes"}
    check(on_screen(place.screens))
    # Of a certificate it depends on what the budget allowed whether there is a proof to check.
    bare = shutil.copytree(
        place.run, "my runs/bare run", ignore=shutil.ignore_patterns("certificate")
    )
    check(on_page(f"<code>{how_sure(open_run(bare)).words}</code>"))


def test_the_commands_of_making_it_again_run(own, at, capfd):
    """The same weights, from the run's own copies, without touching the run."""
    place = at(own)
    page = (place.run / "report.html").read_text().partition('id="reproduce"')[2]
    lines = on_page(page)
    before = (place.run / "config.json").read_bytes()
    for line in lines:
        if shlex.split(line)[1] in ("train", "simulate"):
            assert place.call(capfd, *shlex.split(line)[1:]) in (0, 1), line
    again = place.run.with_name("first run-again")
    weights = "policy.safetensors"
    assert (again / weights).read_bytes() == (place.run / weights).read_bytes()
    assert (place.run / "config.json").read_bytes() == before
    figures = [
        json.loads((run / "simulation/summary.json").read_text()) for run in (again, place.run)
    ]
    assert figures[0]["steps_walked"] == figures[1]["steps_walked"]


def test_commands_of_a_training_that_stopped(own, at, capfd):
    """Resumed without naming the robot; the same for one that was refused as a finished run."""
    place = at(own)
    stopped = place.path / "my runs" / "stopped run"
    shutil.copytree(place.run, stopped, ignore=shutil.ignore_patterns("summary.json", "report*"))
    assert place.call(capfd, "simulate", str(stopped)) == 2
    assert place.call(capfd, "report", str(stopped)) == 0
    lines = on_screen(place.screens) + on_page((stopped / "report.html").read_text())
    resuming = [line for line in lines if "--resume" in line and "stopped run" in line]
    assert resuming
    check(resuming)
    assert place.call(capfd, *shlex.split(resuming[0])[1:]) == 0
    assert (stopped / "summary.json").is_file()


def test_commands_about_a_run_of_a_built_in_robot(built_in, at, capfd, monkeypatch):
    place = at(built_in)
    run = f"./{place.run}"
    plant = ("--plant", "amber3m-tail", "--steps", "1", "--disturb", "friction=0.9", "--push", "-1")
    assert place.call(capfd, "simulate", run, *plant) in (0, 1)
    # No command stands in a figure; those of the first run are drawn all the same.
    monkeypatch.setattr("neuralgaits.workflows.report.draw", lambda *_: [])
    assert place.call(capfd, "report", run) == 0
    lines = on_page((place.run / "report.html").read_text())
    asked = check(lines)
    assert {verb_name(type(verb)) for verb in asked} >= {
        "train",
        "simulate",
        "certify",
        "check-proof",
    }
    (trained,) = (verb for verb in asked if isinstance(verb, TrainOptions))
    assert (trained.robot, trained.spec) == ("amber3m", "walking")
    check(on_screen(place.screens))
    check(on_page(f"<code>{how_sure(open_run(run)).words}</code>"))
    repeated = next(line for line in lines if "--disturb friction=0.9" in line)
    assert "--plant amber3m-tail" in repeated and "--push=-1.0" in repeated


def test_an_own_robot_with_a_built_in_name_is_its_own_file(own, at):
    """Its name alone would be another robot."""
    place = at(own)
    copy = place.path / "named"
    shutil.copytree(place.run, copy)
    config = json.loads((copy / "config.json").read_text()) | {"robot": "amber3m"}
    (copy / "config.json").write_text(json.dumps(config))
    from neuralgaits.report.page.repeat_commands import robot_word

    assert robot_word(RunFolder.open(copy)) == str(copy / "robot.xml")


def test_a_plant_that_is_in_no_file_is_not_named(own, at):
    """A summary of an earlier version has only the name that the plant gave itself."""
    place = at(own)
    folder = RunFolder.open(place.run)
    done = folder.read_json(WALK_SUMMARY)
    old = SimulationSummary.of(
        {name: value for name, value in done.items() if name != "plant_given"}
    )
    assert simulating(folder, replace(old, plant="crutches"), place.run) is None
    assert "--plant" not in (simulating(folder, old, place.run) or "--plant")
    assert "--plant rabbit" in (simulating(folder, replace(old, plant="rabbit"), place.run) or "")


def test_a_frictionless_simulation_is_repeated_without_friction(own, at):
    place = at(own)
    folder = RunFolder.open(place.run)
    done = SimulationSummary.read(place.run / WALK_SUMMARY)
    changed = replace(done, disturb=dict(done.disturb or {}) | {"friction": 0.0})
    assert "--disturb friction=0.0" in (simulating(folder, changed, place.run) or "")
    laid = replace(done, terrain="stairs,rise=-0.05", command={"speed": 0.7})
    line = simulating(folder, laid, place.run) or ""
    assert "--terrain stairs,rise=-0.05" in line and "--command speed=0.7" in line
    other = simulating(folder, replace(done, simulator="drake"), place.run) or ""
    assert "--simulator drake" in other and "--simulator" not in line
    check([line, other])


def test_a_proof_of_narrower_ranges_is_asked_for_again():
    within = {"slope": (math.radians(-1.0), math.radians(2.0)), "speed": (0.7, 0.72)}
    line = certifying(Path("a run"), 2, (), within)
    verb = read(shlex.split(line)[1:])
    assert isinstance(verb, CertifyOptions)
    asked = verb.within
    assert asked is not None
    assert set(asked) == set(within)
    for name, ends in within.items():
        assert asked[name] == pytest.approx(ends)
