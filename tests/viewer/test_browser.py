"""The page in a real browser: load, push, jump, fall, reset. Skipped only without Chromium."""

import re
import time

import numpy as np
import pytest

from neuralgaits.viewer import page_style
from neuralgaits.workflows.demo import demo

WIDTH, HEIGHT = 1100, 640


@pytest.fixture(scope="module")
def live():
    with demo() as page:
        assert page.ready(60.0)
        yield page


@pytest.fixture(scope="module")
def page(live, browser):
    """The page, loaded; what went wrong in it, and what it asked of the world."""
    opened = browser.new_page(viewport={"width": WIDTH, "height": HEIGHT})
    errors, asked = [], []
    opened.on("pageerror", lambda error: errors.append(str(error)))
    opened.on("console", lambda said: errors.append(said.text) if said.type == "error" else None)
    opened.on("request", lambda request: asked.append(request.url))
    opened.goto(live.url)
    opened.get_by_text("Walks ·").wait_for(timeout=300_000)
    yield opened
    elsewhere = [url for url in asked if not url.startswith((live.url, "data:", "blob:"))]
    opened.close()
    assert errors == []
    assert elsewhere == []


def test_on_a_phone_the_controls_leave_the_upper_half_to_the_robot(live, browser):
    opened = browser.new_page(viewport={"width": 390, "height": 844})
    opened.goto(live.url)
    opened.get_by_text("Walks ·").wait_for(timeout=300_000)
    sheet = opened.locator(".mantine-Paper-root").filter(has_text="Pause").bounding_box()
    opened.close()
    assert (sheet["x"], sheet["width"]) == (0.0, 390.0)
    assert sheet["y"] >= page_style.SCENE_SHARE * 844 - 1.0


def test_the_tab_names_the_robot(page):
    assert page.title() == "Neural Gaits: amber3m"


def test_the_answer_and_its_limits_are_in_view_without_a_click(page):
    page.get_by_text("The proof file states level 3 of 5.").wait_for(timeout=300_000)
    page.get_by_text("Inside the proved walking set of level 2: yes, margin 0.").wait_for(
        timeout=300_000
    )
    for words in ("Proved, to level 3 of 5", "What is not covered."):
        page.get_by_text(words).first.wait_for(state="visible", timeout=300_000)
    # A long path breaks before the edge of the panel.
    right = page.get_by_text("neuralgaits check-proof").evaluate(
        "(one) => Math.max(...[...one.getClientRects()].map((box) => box.right))"
    )
    assert right <= WIDTH


def test_the_status_stays_in_view_and_nothing_below_it_moves(live, browser):
    """A push and its outcome are on one screen of a phone; the chart stays under the pointer."""
    opened = browser.new_page(viewport={"width": 390, "height": 844})
    opened.goto(live.url)
    opened.get_by_text("Walks ·").wait_for(timeout=300_000)
    opened.locator(".phase-portrait").wait_for(timeout=300_000)
    opened.get_by_role("button", name="forward").evaluate("one => one.scrollIntoView()")
    places = []
    for words in ("one line", "one line, and as many words as make it three lines " * 3):
        live._panel.say(words)
        opened.locator(".walk-status", has_text=words.strip()).wait_for(timeout=300_000)
        # At one moment: both are drawn anew.
        boxes = opened.evaluate(
            "() => ['.phase-portrait', '.walk-status']"
            ".map((one) => document.querySelector(one).getBoundingClientRect().toJSON())"
        )
        places.append([(box["top"], box["bottom"]) for box in boxes])
    opened.close()
    assert places[0] == places[1]
    top, bottom = places[0][1]
    assert page_style.SCENE_SHARE * 844 - 1.0 <= top and bottom < 844


def until(condition, seconds=300.0):
    end = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < end, "it did not happen"
        time.sleep(0.01)


def test_the_page_shows_the_walk_and_every_condition(live, page):
    for word in ("Pause", "Reset", "slope [deg]", "friction", "rate of every joint ≤ 4 rad/s"):
        page.get_by_text(word, exact=True).first.wait_for(timeout=300_000)


def test_a_push_is_given(live, page):
    given = live.gait.live.impulse_given.copy()
    page.get_by_role("button", name="forward").click(timeout=300_000)
    until(lambda: live.gait.live.impulse_given[0] > given[0] + 7.99)
    assert live.gait.live.impulse_given[1] == given[1]


def test_pause_holds_and_goes_on(live, page):
    page.get_by_role("button", name="Pause").click(timeout=300_000)
    until(lambda: live.player.paused)
    frames = live.player.frames
    until(lambda: live.player.frames > frames + 2)
    held = live.gait.live.time
    time.sleep(0.3)
    assert live.gait.live.time == held
    page.get_by_role("button", name="Go on").click(timeout=300_000)
    until(lambda: live.gait.live.time > held)


def test_a_number_beyond_the_slider_reaches_nothing_and_does_not_stay(live, page):
    box = page.locator("input[inputmode]").nth(2)
    limits = live.gait.settings["slope_deg"]
    box.fill("999999")
    box.press("Enter")
    until(lambda: float(box.input_value()) == limits.high)
    assert limits.low <= live.gait.live.plant.disturbance.slope_deg <= limits.high
    page.get_by_role("button", name="Restore robot and floor").click(timeout=300_000)
    until(lambda: live.gait.live.plant.disturbance.slope_deg == 0.0)


def test_a_click_on_the_chart_puts_the_robot_there(live, page):
    area = page.locator(".phase-portrait rect[onclick]")
    area.wait_for(timeout=300_000)
    said = []
    tell = live._panel.say
    live._panel.say = lambda answer: (said.append(answer), tell(answer))
    state = live.gait.chart.z(np.array([0.45]), np.array([0.5]))[0]
    click_at(live, page, area, state)
    until(lambda: said)
    assert said[0].startswith("Put to z = ")
    put = [float(one) for one in re.findall(r"-?\d+\.\d+", said[0])]
    # A pixel is 1.5 mm and 0.1 kg m²/s.
    np.testing.assert_allclose(put, state, atol=0.1)
    assert abs(put[0] - state[0]) < 3e-3
    said.clear()
    below = live.gait.chart.z(np.array([0.5]), np.array([0.0]))[0] - [0.0, 1.2]
    click_at(live, page, area, below)
    until(lambda: said)
    assert "outside of the region" in said[0]


def test_a_typed_state_is_taken_too(live, page):
    said = []
    tell = live._panel.say
    live._panel.say = lambda answer: (said.append(answer), tell(answer))
    z1, z2 = live.gait.chart.z(np.array([0.4]), np.array([0.6]))[0]
    field = page.locator("form input")
    field.fill(f"{z1:.3f}, {z2:.2f}")
    # The page sends what is typed at most every 50 ms.
    page.wait_for_timeout(200)
    field.press("Enter")
    until(lambda: said)
    assert said[0] == f"Put to z = ({z1:.3f} m, {z2:.2f} kg m²/s)."


def test_the_chart_is_as_wide_as_the_panel_and_the_ball_is_on_it(page):
    # At one moment: the ball is drawn anew twenty times a second.
    chart, ball = page.evaluate(
        "() => ['.phase-portrait', 'circle[stroke]']"
        ".map((one) => document.querySelector(one).getBoundingClientRect().toJSON())"
    )
    # Its letters are 11 pixels high at 350.
    assert chart["width"] >= 310.0
    assert chart["x"] < ball["x"] < chart["x"] + chart["width"]
    assert chart["y"] < ball["y"] < chart["y"] + chart["height"]


def test_a_fall_is_explained_and_reset(live, page):
    live.player.ask(lambda walker: walker.push(np.array([-80.0, 0.0])))
    until(lambda: live.gait.live.ending.fell or live.player.failure)
    assert live.player.failure is None
    page.get_by_text("Fell: ").wait_for(timeout=300_000)
    assert live.gait.shown().fall is not None
    # The one beside the words presses the panel's own.
    page.locator(".walk-status").get_by_role("button", name="Reset").click(timeout=300_000)
    until(lambda: live.gait.shown().fall is None)
    page.get_by_text("Walks ·").wait_for(timeout=300_000)


def click_at(live, page, area, z):
    """Click a state on the chart, which is made anew after each submission."""
    page.wait_for_timeout(500)
    area.evaluate("(one) => one.scrollIntoView({block: 'center'})")
    page.wait_for_timeout(500)
    box = area.bounding_box()
    across, up = live._panel.chart._portrait.place(np.asarray(z))
    page.mouse.click(box["x"] + across * box["width"], box["y"] + (1.0 - up) * box["height"])
