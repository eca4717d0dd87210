"""What the sliders show is what counts."""

import re
import time
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from neuralgaits._commands import ADAPTABLE
from neuralgaits.gait.commands import Command
from neuralgaits.simulation.live_tick import StepSpeeds
from neuralgaits.viewer import limited_sliders, panel
from neuralgaits.viewer.believed_lean import lean_of
from neuralgaits.viewer.panel import PUSH, Panel
from neuralgaits.viewer.plant_sliders import plant_sliders
from neuralgaits.viewer.player import SPEED, Picture
from neuralgaits.viewer.slider import Slider
from neuralgaits.viewer.walk_status import slow_line

FRICTION = Slider("friction", 0.05, 1.5, 0.6)


@pytest.fixture
def make_panel(server):
    """Make panels on one server. Returns: the panel, handles by label, wishes to the walker."""

    def make(**options):
        wishes: list[Any] = []
        player: Any = SimpleNamespace(paused=False, speed=1.0, ask=wishes.append)
        needed: Any = {"title": "x", "settings": {}, "conditions": (), "restarted": lambda: None}
        made = Panel(server, player, **(needed | options))
        handles = server.gui._gui_input_handle_from_uuid.values()
        return made, {handle.label: handle for handle in handles}, wishes

    return make


@pytest.fixture
def built(make_panel):
    """A panel with a slider, and the sliders by label."""
    made, handles, _ = make_panel(settings={"friction": FRICTION})
    return made, {label: handle for label, handle in handles.items() if hasattr(handle, "step")}


def typed(slider, value):
    """As the page does it: the number as it stands, key by key."""
    slider._impl.value, slider._impl.update_timestamp = value, time.time()


def frame(made, laps=(), speeds=None, lean=None, off_proof=""):
    shown: Any = SimpleNamespace(
        steps=0, speed=0.0, time=0.0, walked=0.0, fall=None, laps=laps, memberships=()
    )
    shown.changed = False
    shown.speeds, shown.lean, shown.off_proof = speeds, lean, off_proof
    made.show(Picture(shown, None, False, 1.0, None, None))


@pytest.mark.parametrize(
    ("label", "limits"),
    [(slider.label, slider) for slider in (FRICTION, PUSH, SPEED)],
)
@pytest.mark.parametrize(("value", "end"), [(999999.0, "high"), (-3.0, "low")])
def test_a_number_beyond_the_limits_becomes_the_limit(
    built, monkeypatch, label, limits, value, end
):
    """Once it is typed: 0 may be the beginning of 0.5."""
    made, sliders = built
    typed(sliders[label], value)
    frame(made)
    assert sliders[label].value == value
    monkeypatch.setattr(limited_sliders, "TYPED_S", -1.0)
    frame(made)
    assert sliders[label].value == getattr(limits, end)


def test_a_number_within_the_limits_stays(built, monkeypatch):
    made, sliders = built
    monkeypatch.setattr(limited_sliders, "TYPED_S", -1.0)
    typed(sliders["friction"], 0.25)
    frame(made)
    assert sliders["friction"].value == 0.25


def test_the_end_of_the_ground_is_said_once_each_time(built):
    """The robot is put back to the beginning: a visitor sees why its steps count from 0."""
    made, _ = built
    words = "End of the ground after {} steps: the robot is back at its beginning."
    frame(made)
    assert "End of the ground" not in made._status.content
    frame(made, laps=(600,))
    assert words.format(600) in made._status.content
    made.say("")
    for _ in range(2 * panel._STATUS_EVERY):
        frame(made, laps=(600,))
    assert "End of the ground" not in made._status.content
    frame(made, laps=(600, 412))
    assert words.format(412) in made._status.content


def test_the_switch_adapts_and_the_speeds_of_the_last_step_are_said(make_panel):
    heard = []
    walker: Any = SimpleNamespace(adapt=heard.append)
    _, plain, _ = make_panel()
    assert not any("adapt" in label for label in plain)
    made, handles, wishes = make_panel(adaptable=ADAPTABLE)
    for value in (True, False):
        handles["adapt speed, lean, slope"].value = value
    for wish in wishes:
        wish(walker)
    assert heard == [True, False]
    told = "told 0.700, commanded 0.612, walked 0.701 m/s"
    for speeds, said in ((None, False), (StepSpeeds(0.7, 0.612, 0.7008), True)):
        for _ in range(2 * panel._STATUS_EVERY):
            frame(made, speeds=speeds)
        assert (told in made._status.content) == said


@pytest.mark.parametrize("adapts", [True, False])
def test_sliders_of_what_is_learned_rest_while_it_is(make_panel, adapts):
    """They would be moved for nothing. What counts is in the units of the gait."""
    heard = []
    walker: Any = SimpleNamespace(
        adapt=lambda active: None,
        tell=lambda name, value: heard.append((name, value)),
        disturb=lambda name, value: heard.append((name, value)),
    )
    _, by_label, wishes = make_panel(
        settings={"torso_shift_m": Slider("torso [mm]", -50.0, 50.0, 0.0, 1.0, unit=1e-3)},
        commands={
            "speed": Slider("speed [m/s]", 0.5, 0.9, 0.7),
            "lean": Slider("lean [mm]", -30.0, 30.0, 0.0, unit=1e-3),
        },
        adaptable=("speed", "lean"),
        adapts=adapts,
    )
    switch = by_label["adapt speed, lean"]
    for active in (adapts, not adapts, adapts):
        switch.value = active
        assert by_label["lean [mm]"].disabled == active
        assert not by_label["speed [m/s]"].disabled
    by_label["lean [mm]"].value = 20.0
    by_label["torso [mm]"].value = -30.0
    for wish in wishes:
        wish(walker)
    assert heard == [("lean", 0.02), ("torso_shift_m", -0.03)]


@pytest.mark.parametrize(
    ("true", "proved", "words", "covered"),
    [
        (0.0125, None, "2.5 mm off; no proof is about what it believes", None),
        (0.0125, 0.003, "within the 3 mm that the proof file is about", True),
        (0.0069, 0.003, "beyond the 3 mm that the proof file is about", False),
    ],
)
def test_the_belief_stands_beside_the_truth(built, true, proved, words, covered):
    made, _ = built
    told = Command("speed", 0.6, 0.8), Command("lean", -0.01, 0.01)
    lean = lean_of(told, np.array([0.7, 0.01]), true, proved)
    assert lean is not None and lean.covered is covered
    for _ in range(2 * panel._STATUS_EVERY):
        frame(made, lean=lean)
    content = made._status.content
    assert words in content and f"believed +10.0 mm, true {1e3 * true:+.1f} mm" in content
    # Marks stay on the line where the truth is beyond the gait's range.
    places = [float(x) for x in re.findall(r"left:([-\d.]+)%", content)]
    assert all(0.0 <= x <= 100.0 for x in places[-2:]) and len(places) >= 3


def test_a_lean_that_cannot_be_is_said(built):
    made, _ = built
    told = (Command("lean", -0.01, 0.01),)
    for doubted in (False, True):
        lean = lean_of(told, np.array([0.01]), 0.01, 0.003, doubted=doubted)
        for _ in range(2 * panel._STATUS_EVERY):
            frame(made, lean=lean)
        assert ("one that cannot be; the belief stays" in made._status.content) == doubted


def test_a_gait_that_takes_no_lean_has_no_marks(built):
    made, _ = built
    assert lean_of((Command("speed", 0.6, 0.8),), np.array([0.7]), 0.01, 0.003) is None
    for _ in range(2 * panel._STATUS_EVERY):
        frame(made)
    assert "Torso" not in made._status.content


def test_sliders_and_keys_tell_the_robot_and_lay_stones(make_panel, server):
    """Two keys a slider, up and down by a tenth of its range, cut to it."""
    heard = []
    walker: Any = SimpleNamespace(
        tell=lambda name, value: heard.append(("tell", name, value)),
        resize=lambda name, value: heard.append(("resize", name, value)),
    )
    _, _, wishes = make_panel(
        commands={"speed": Slider("speed [m/s]", 0.5, 0.9, 0.7)},
        sizes={"rise": Slider("rise [m]", -0.05, 0.05, 0.05)},
    )
    keys = {handle.hotkey: handle for handle in server.gui._command_handle_from_uuid.values()}
    assert set(keys) == {"U", "J", "I", "K"}
    for key in ("U", "J", "I", "K"):
        for callback in keys[key]._impl.trigger_cb:
            callback(None)
    for wish in wishes:
        wish(walker)
    said = [(verb, name, round(value, 9)) for verb, name, value in dict.fromkeys(heard)]
    assert said == [
        ("tell", "speed", 0.74),
        ("tell", "speed", 0.7),
        ("resize", "rise", 0.05),
        ("resize", "rise", 0.04),
    ]


@pytest.mark.parametrize(
    ("upright", "left", "words"),
    [
        (True, None, "Stopped: too slow, after 4 steps. Press Reset; push it forward where"),
        (True, 2.0, "Stopped: too slow, after 4 steps. Reset in 2 s; push it forward where"),
        (False, None, "Fell: too slow, after 4 steps. Press Reset."),
        (False, 5.0, "Fell: too slow, after 4 steps. Reset in 5 s."),
    ],
)
def test_the_end_of_a_walk_says_what_to_do_next(built, upright, left, words):
    made, _ = built
    shown: Any = SimpleNamespace(
        fall="too slow", upright=upright, steps=4, speed=0.0, time=0.0, walked=0.0, memberships=()
    )
    shown.speeds, shown.lean, shown.off_proof = None, None, ""
    picture: Any = SimpleNamespace(shown=shown, reset_in=left, paused=False, pace=1.0)
    assert words in made.status(picture)


@pytest.mark.parametrize(
    ("pace", "words"),
    [(0.004, "manages less than ×0.01"), (0.31, "asked ×1, this machine manages ×0.31")],
)
def test_a_slow_machine_says_what_was_asked_and_what_it_manages(pace, words):
    assert words in slow_line(pace, 1.0)


def test_the_torque_slider_is_of_a_limit():
    assert plant_sliders(0.6, 41.0)["torque_limit"].label == "torque limit [N\u00a0m]"


@pytest.mark.parametrize(
    ("low", "high"), [(0.55, 0.90), (0.4712345678901, 0.8765432109), (-0.02, 0.02), (-0.087, 0.1)]
)
def test_a_number_beside_a_slider_has_room(make_panel, low, high):
    """Its box holds five characters, and as many decimals as limits, first value and step need."""
    speed = Slider("speed [m/s]", low, high, 0.5 * (low + high))
    _, handles, _ = make_panel(commands={"speed": speed}, sizes={})
    slider = handles["speed [m/s]"]
    assert slider.precision <= 4 - (low > 0.1)
    assert low - 0.01 <= slider.min < slider.value < slider.max <= high + 0.01
    assert slider.step <= (slider.max - slider.min) / 50
