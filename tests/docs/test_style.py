"""What the style sheet of the pages does, in a browser, on a page of its own."""

from pathlib import Path

import pytest

STYLE = Path(__file__).parents[2] / "docs" / "assets" / "pages.css"
ADDRESS = "http://localhost/"
BODY = """
<article>
<p id="chart"><img src="_images/3-zero-dynamics.png"></p>
<p id="map"><img src="_images/8-proof.png"></p>
<p id="scene"><img src="_images/gait.png"></p>
<p id="film"><img src="_images/walk.webp"></p>
<table><tr><th><img src="a.webp"></th><th><img src="b.webp"></th></tr>
<tr><td>short</td><td>a caption that is much longer than the other one, by far</td></tr></table>
<div class="highlight-sh"><pre>neuralgaits simulate latest --push 32 --video push.mp4</pre></div>
</article>
"""


@pytest.fixture
def opened(browser):
    """Open a page of a width in a scheme; the test answers, nothing is served."""
    pages = []

    def at(width: int, scheme: str = "light"):
        page = browser.new_page(viewport={"width": width, "height": 900}, color_scheme=scheme)
        pages.append(page)
        text = f"<style>{STYLE.read_text()}</style><body>{BODY}</body>"
        page.route("**/*", lambda route: route.fulfill(body=text, content_type="text/html"))
        page.goto(ADDRESS)
        return page

    yield at
    for page in pages:
        page.close()


def look(page, place: str, name: str, part: str = "") -> str:
    """Computed style of an element, or of a part that the style sheet makes."""
    return page.locator(place).first.evaluate(
        "(one, [name, part]) => getComputedStyle(one, part || null)[name]", [name, part]
    )


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_charts_are_turned_round_in_the_dark_and_scenes_and_the_map_are_not(opened, scheme):
    page = opened(1440, scheme)
    assert ("invert" in look(page, "#chart img", "filter")) == (scheme == "dark")
    for place in ("#scene img", "#map img", "#film img", "th img"):
        assert look(page, place, "filter") == "none"


@pytest.mark.parametrize("width", [390, 1440])
def test_films_in_a_table_are_equally_wide(opened, width):
    one, other = opened(width).locator("th").all()
    assert one.bounding_box()["width"] == pytest.approx(other.bounding_box()["width"], abs=1.0)


def test_on_a_phone_a_wide_picture_says_so_and_a_film_fits(opened):
    page = opened(390)
    assert "sideways" in look(page, "#chart", "content", "::before")
    assert look(page, "#film", "content", "::before") == "none"
    assert look(opened(1440), "#chart", "content", "::before") == "none"


def test_on_a_phone_a_command_is_read_whole(opened):
    cut = "(one) => one.scrollWidth > one.clientWidth"
    page = opened(390)
    assert not page.locator("pre").evaluate(cut)
