"""The monitor of a live page: the answers of `simulate --monitor`, tick by tick, while it walks."""

import math
import shutil
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from neuralgaits.analysis.run import open_run
from neuralgaits.certificate.run_certificate.proved_monitor import monitor_of
from neuralgaits.gait.commands import Command
from neuralgaits.records.certified import CertificateRecord, Conclusion, ConditionVerdict
from neuralgaits.simulation.setup.disturbance import PlantChanges
from neuralgaits.viewer import sureness
from neuralgaits.viewer.live_gait import LiveGait
from neuralgaits.viewer.live_monitor import LiveMonitor, SetMembership, membership_lines
from neuralgaits.viewer.page_style import GOOD, QUIET, TIGHT
from neuralgaits.viewer.panel import Panel
from neuralgaits.viewer.plant_changes import changed_settings
from neuralgaits.viewer.player import Picture
from neuralgaits.viewer.slider import Slider
from neuralgaits.viewer.sureness import how_sure
from neuralgaits.workflows.demo import TOLD
from neuralgaits.workflows.monitor_walk import watched

TICKS = 700


@pytest.fixture(scope="module")
def monitor(shipped):
    found = monitor_of(shipped)
    assert found is not None
    return found


@pytest.fixture
def gait(shipped, monitor):
    walker = LiveGait(shipped)
    walker.watch_with(LiveMonitor(shipped, monitor))
    return walker


def test_shares_and_margins_are_those_of_the_monitor_of_walks(shipped, monitor, gait):
    records, found = [], ()
    for number in range(TICKS):
        gait.tick()
        # Looked at every 20 ms, as a page does.
        if number % 20 == 0:
            found = gait.shown().memberships
        if number >= TICKS - 5:
            records.append(gait.live.record)
    (found,) = gait.shown().memberships
    np.testing.assert_array_equal(gait.shown().z, records[-1].result.z[0])
    (figures,) = watched(shipped, monitor, records[-1:]).levels.values()
    assert (found.levels, found.inside, found.admissible) == ("2", True, True)
    assert found.margin == pytest.approx(figures.margin, rel=1e-12)
    assert found.name == figures.name
    # One touchdown by now, with some ticks outside around it.
    assert 0.98 < found.share < 1.0
    assert found.away_s == 0.0
    assert found.share * TICKS == pytest.approx(round(found.share * TICKS), abs=1e-6)


def test_another_start_counts_from_zero(gait):
    for _ in range(TICKS):
        gait.tick()
    assert gait.shown().memberships[0].share < 1.0
    gait.reset()
    assert gait.shown().memberships == ()
    gait.tick()
    assert gait.shown().memberships[0].share == 1.0


def test_a_state_outside_is_said_to_be(gait):
    gait.push(np.array([-20.0, 0.0]))
    for _ in range(150):
        gait.tick()
    (found,) = gait.shown().memberships
    assert not found.inside and found.margin < 0.0 and found.name == "level-lower"
    assert 0.0 < found.share < 1.0
    assert found.away_s > 0.02
    # A robot that has fallen is no longer counted.
    gait.push(np.array([-40.0, 0.0]))
    while gait.tick():
        pass
    last = gait.shown().memberships
    gait.tick()
    assert gait.shown().memberships == last


def test_a_gait_with_commands_is_watched_at_those_that_are_proved():
    run = open_run(TOLD)
    monitor = monitor_of(run)
    assert monitor is not None
    (span,) = monitor.commands
    walker = LiveGait(run)
    for commands, admissible in (
        (monitor.commands, True),
        ((span._replace(low=span.high),), False),
    ):
        walker.watch_with(LiveMonitor(run, replace(monitor, commands=commands)))
        for _ in range(50):
            walker.tick()
        (found,) = walker.shown().memberships
        assert (found.admissible, found.inside, found.share) == (admissible,) * 2 + (
            float(admissible),
        )
        assert found.margin > 0.0


SEEN = SetMembership("2", True, 0.314, "level-upper", True, 0.99999)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        # Not all ticks were inside: no 100 %.
        ({}, "walking set of level 2: yes, margin 0.31 widths of the region (fast edge) · 99.9 %"),
        ({}, "so far; outside only within 5 ms of touchdowns"),
        ({"away_s": 0.214}, "so far; outside for 0.21 s away from touchdowns"),
        ({"share": 1.0, "away_s": 0.0}, "100.0 % of ticks so far</div>"),
        (
            {"levels": "4, 5", "name": "knee-clears"},
            "proved set of levels 4 and 5: yes, margin 0.31 (",
        ),
        ({"inside": False, "margin": -0.02}, "no, margin −0.02 widths of the region (fast edge)"),
        ({"inside": False, "admissible": False}, "no, it is not about this command"),
    ],
)
def test_a_set_is_one_line_of_the_page(changes, words):
    assert words in membership_lines((SEEN._replace(**changes),))


def test_the_status_has_the_line_and_none_without_a_proof(unproved):
    panel: Any = SimpleNamespace(_player=SimpleNamespace(speed=1.0), _answer="", _answer_left=0)
    for memberships, count in (((SEEN,), 2), ((), 1)):
        shown: Any = SimpleNamespace(
            steps=0,
            speed=0.0,
            time=0.0,
            walked=0.0,
            fall=None,
            upright=False,
            memberships=memberships,
            speeds=None,
            lean=None,
            off_proof="",
        )
        status = Panel.status(panel, Picture(shown, None, False, 1.0, None, None))
        assert status.count("<div") == count
    sure = how_sure(open_run(unproved))
    assert sure.monitor is None and "Inside the proved" not in sure.words


def test_a_changed_floor_or_robot_is_said_and_no_answer_is_green(shipped, gait):
    """The proof is about the floor and the robot of the file: a slider moves the robot off both."""
    sure = how_sure(shipped)
    assert sure.proved_of == "the robot of its file, on a level floor"
    gait.watch_with(gait._monitor, None, sure.proved_of)
    gait.tick()
    panel: Any = SimpleNamespace(_player=SimpleNamespace(speed=1.0), _answer="", _answer_left=0)

    def status():
        shown = gait.shown()
        text = Panel.status(panel, Picture(shown, None, False, 1.0, None, None))
        return shown.off_proof, text.partition("Inside the proved walking set")[0]

    before = gait.settings
    off, head = status()
    assert off == "" and head.rstrip('">').endswith(GOOD.css)
    gait.disturb("slope_deg", 4.0)
    gait.disturb("torque_limit", 20.0)
    off, head = status()
    assert off == (
        "Changed: slope 4 deg; torque limit 20 N\u00a0m. "
        "The proof is about the robot of its file, on a level floor."
    )
    assert TIGHT.css in head and off in head and head.rstrip('">').endswith(QUIET.css)
    gait.disturb("slope_deg", 0.0)
    gait.disturb("torque_limit", before["torque_limit"].first)
    assert status()[0] == ""
    # What was never proved has nothing to differ from.
    gait.disturb("mass_scale", 1.5)
    assert gait.shown().off_proof.startswith("Changed: mass × 1.5. ")
    gait.watch_with(None)
    assert gait.shown().off_proof == ""


@pytest.mark.parametrize(
    ("level", "parameters", "commands", "words"),
    [
        (3, {}, ("speed",), "the robot of its file, on a level floor"),
        (3, {}, ("speed", "slope"), "the robot of its file, on the floor of its commands"),
        (1, {}, ("lean",), "a robot that leans as it believes, on a level floor"),
        (3, {"mass": 0.02}, (), "robots within mass=2% of the file's, on a level floor"),
        (
            3,
            {"floor": 0.002},
            (),
            "the robot of its file, on floors with footholds up to 2 mm higher or lower than meant",
        ),
        (0, {}, (), ""),
    ],
)
def test_robot_and_floor_of_a_proof_are_named(level, parameters, commands, words):
    holds = ConditionVerdict("proved" if level else "undecided", 1.0, 1, 0.1, None, 0)
    answer = CertificateRecord(
        verdict=holds.verdict,
        level=3,
        conditions={"knee": holds},
        levels=tuple(Conclusion(n, "proved", None) for n in range(2, level + 1)),
        boxes=1,
        wall_s=1.0,
        parameters=parameters,
    )
    assert answer.proved_level == level
    run: Any = SimpleNamespace(
        trained=SimpleNamespace(commands=[Command(name, 0.0, 0.1) for name in commands])
    )
    assert sureness._proved_of(run, answer, None) == words


def test_a_floor_as_commanded_is_no_change():
    slope = Slider("slope [deg]", -6.0, 6.0, 0.0)
    plant = PlantChanges(slope_deg=2.0)
    assert changed_settings({"slope_deg": slope}, plant, math.radians(2.0)) == ()
    said = changed_settings({"slope_deg": slope}, plant, math.radians(1.5))
    assert said == ("slope 2 deg, commanded 1.50 deg",)
    assert changed_settings({"slope_deg": slope}, plant) == ("slope 2 deg",)


@pytest.fixture
def unproved(shipped, tmp_path):
    """The shipped run without its certificate."""
    ignored = shutil.ignore_patterns("certificate", "__pycache__")
    return shutil.copytree(shipped.path, tmp_path / "run", ignore=ignored)
