"""The chart in the panel: its legend, its moving layer, and the states that a visitor asks for."""

import re
import xml.etree.ElementTree as ET
from dataclasses import replace
from types import SimpleNamespace
from typing import cast

import numpy as np
import pytest
import viser

from neuralgaits.analysis.box_map import BoxAnswer, BoxMap
from neuralgaits.viewer import phase_chart
from neuralgaits.viewer import portrait_drawing as drawing
from neuralgaits.viewer.phase_chart import PhaseChart, moving_layer, typed_state
from neuralgaits.viewer.portrait import Portrait

INSIDE, BELOW = np.array([0.5, 1.5]), np.array([0.5, 0.3])


def small_portrait(answer=BoxAnswer.PROVED, margin=0.5):
    corners = np.array([[[0.0, 1.0], [1.0, 1.0], [1.0, 2.0], [0.0, 2.0]]])
    return Portrait(
        z1=np.linspace(-0.2, 1.2, 5),
        z2=np.linspace(0.8, 2.2, 4),
        dz=np.ones((4, 5, 2)),
        fence_z1=np.array([0.0, 1.0]),
        fence_z2=np.array([[1.0, 1.0], [2.0, 2.0]]),
        orbit=np.zeros((0, 2)),
        boxes=BoxMap(corners, np.array([answer]), np.array([margin])),
        title="small",
    )


def test_a_state_off_the_chart_has_no_ball_and_breaks_the_trail():
    steps = np.array([[0.1, 1.5], [0.2, 1.5], BELOW, BELOW, [0.3, 1.5], [0.4, 1.5]])
    inside = moving_layer(small_portrait(), INSIDE, steps)
    assert "<circle" in inside and "<text" not in inside
    # Two lines of five: those between states that are both on the chart.
    assert (inside.count("M"), inside.count("L")) == (2, 2)
    below = moving_layer(small_portrait(), BELOW, steps)
    assert "<circle" not in below and "▼ below the chart" in below


def test_the_ball_is_where_its_state_is():
    layer = moving_layer(small_portrait(), INSIDE, np.zeros((0, 2)))
    x, y = (float(re.findall(rf'{name}="([\d.]+)"', layer)[0]) for name in ("cx", "cy"))
    width = drawing.WIDTH_PX - drawing.LEFT_PX - drawing.RIGHT_PX
    height = drawing.HEIGHT_PX - drawing.TOP_PX - drawing.BOTTOM_PX
    assert x == pytest.approx(drawing.LEFT_PX + 0.5 * width, abs=0.1)
    assert y == pytest.approx(drawing.TOP_PX + 0.5 * height, abs=0.1)


def test_the_legend_names_the_ball_and_says_what_pale_and_dark_mean(server):
    chart = PhaseChart(server.gui)
    chart.fill(small_portrait(), lambda client, z: None)
    words = chart._legend.content
    assert "ball: the robot now" in words and "linear-gradient" in words
    assert "least margin of all conditions" in words and "0.50 or more" in words
    assert "undecided" not in words and "violated" not in words
    assert "Click to put the robot there, or type z1, z2 below" in chart._plane.content
    broken = PhaseChart(server.gui)
    broken.fill(small_portrait(BoxAnswer.REFUTED, -0.5), lambda client, z: None)
    assert "violated" in broken._legend.content
    assert "linear-gradient" not in broken._legend.content


def test_words_of_the_drawing_can_be_read_on_a_phone():
    svg = ET.fromstring(drawing.svg(small_portrait()).replace("xlink:href", "href"))
    texts = [one for one in svg.iter() if one.tag.endswith("text")]
    assert len(texts) > 8
    for one in texts:
        size = re.search(r"([\d.]+)px", one.attrib["style"])
        assert size is not None and float(size.group(1)) >= 11.0
        # The colour of the page's own text, light or dark.
        assert "currentColor" in one.attrib["style"]


def test_the_drawing_has_no_rule_for_the_rest_of_the_page():
    rules = re.search(r"<style[^>]*>(.*?)</style>", drawing.svg(small_portrait()))
    assert rules is not None and rules.group(1).startswith(".phase-portrait *{")


def test_most_of_the_boxes_have_greens_that_can_be_told_apart():
    margins = np.append(np.linspace(0.05, 0.25, 20), 9.0)
    corners = np.tile(small_portrait().boxes.corners, (21, 1, 1))
    boxes = BoxMap(corners, np.full(21, BoxAnswer.PROVED), margins)
    # One that is far wider does not leave all others pale.
    assert replace(small_portrait(), boxes=boxes).darkest_margin < 0.26


@pytest.mark.parametrize(
    ("text", "state"),
    [
        ("0.0512, 14.203", [0.0512, 14.203]),
        (" -1e-2;7 ", [-0.01, 7.0]),
        (".5 2.", [0.5, 2.0]),
        ("", None),
        ("1", None),
        ("1, 2, 3", None),
        ("nan, 1", None),
        ("1,2<b>", None),
    ],
)
def test_a_state_is_two_numbers(text, state):
    found = typed_state(text)
    assert (None if found is None else found.tolist()) == state


def test_a_submitted_state_reaches_the_robot_and_other_words_do_not(server):
    asked, said = [], []
    chart = PhaseChart(server.gui)
    assert not chart._form.visible
    chart.show(INSIDE, np.zeros((0, 2)))
    assert chart._moving.content == ""
    chart.fill(small_portrait(), lambda client, z: asked.append(z))
    assert chart._form.visible
    client = SimpleNamespace(add_notification=lambda *words, **_: said.append(words))
    event = cast(viser.GuiEvent, SimpleNamespace(client=client))
    (submit,) = chart._form._submit_cb
    chart._field.value = "0.5, 1.5"
    submit(event)
    np.testing.assert_array_equal(asked, [[0.5, 1.5]])
    chart._field.value = "middle"
    submit(event)
    assert len(asked) == 1 and "two numbers" in said[0][1]


def test_the_chart_is_sent_at_half_the_rate_of_the_scene(server, monkeypatch):
    drawn = []
    monkeypatch.setattr(phase_chart, "moving_layer", lambda *_: drawn.append(0) or "")
    chart = PhaseChart(server.gui)
    chart.fill(small_portrait(), lambda client, z: None)
    for _ in range(6):
        chart.show(INSIDE, np.zeros((0, 2)))
    assert len(drawn) == 3
