"""The biped's live page in a real browser: it walks, is pushed by a button and by a key."""

import time

import pytest

import neuralgaits as ng
from neuralgaits.cli.main import main
from neuralgaits.systems.walker3d.spatial_page import SpatialPage

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def live(spatial_run):
    with ng.view(spatial_run) as page:
        assert isinstance(page, SpatialPage)
        assert page.ready(600.0)
        yield page


def until(condition, seconds=300.0):
    end = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < end, "it did not happen"
        time.sleep(0.02)


def test_page(live, browser):
    opened = browser.new_page(viewport={"width": 390, "height": 600})
    opened.set_default_timeout(300_000)
    errors, asked, pushes = [], [], []
    opened.on("pageerror", lambda error: errors.append(str(error)))
    opened.on("console", lambda said: errors.append(said.text) if said.type == "error" else None)
    opened.on("request", lambda request: asked.append(request.url))
    push = live.robot.push
    live.robot.push = lambda impulse: (pushes.append(tuple(impulse)), push(impulse))
    opened.goto(live.url)
    for words in ("Walks ·", "Inside the tube now:", "nothing of this gait."):
        opened.get_by_text(words).first.wait_for(timeout=120_000)
    # The tube's slices and the footprints are drawn, and the page is no wider than its window.
    until(lambda: opened.locator("svg polygon").count() == 3)
    until(lambda: opened.locator('svg[aria-label^="footprints"] circle').count() > 1)
    assert opened.evaluate("document.documentElement.scrollWidth") <= 390
    opened.get_by_role("button", name="◄ left").dispatch_event("click")
    until(lambda: pushes == [(0.0, 4.0)])
    opened.keyboard.press("k")
    until(lambda: pushes[1:] == [(-4.0, 0.0)])
    opened.get_by_role("button", name="Pause").dispatch_event("click")
    until(lambda: live.player.paused)
    opened.close()
    assert live.player.failure is None
    assert errors == []
    assert [url for url in asked if not url.startswith((live.url, "data:", "blob:"))] == []


def test_terrain_is_no_option_of_it(spatial_run, capsys):
    assert main(["view", str(spatial_run), "--terrain", "stones", "--no-browser"]) == 2
    assert "options of a walker in three dimensions" in capsys.readouterr().err
