"""The report of the shipped run, written once, and read in a real browser."""

import html
import json
import re
import shutil
from pathlib import Path

import pytest

from neuralgaits.errors import InputError, RunError
from neuralgaits.report.drawing import style
from neuralgaits.report.page.document import MOST_BYTES
from neuralgaits.report.shown_walk import FILE
from neuralgaits.workflows.report import write_report
from support.contrast import channels, contrast, luminance
from support.shipped_run import SHIPPED

pytestmark = pytest.mark.slow

WIDTHS = (390, 1440)
"""Pixels: a telephone, and a desk."""


@pytest.fixture(scope="module")
def written(tmp_path_factory):
    folder = Path(shutil.copytree(SHIPPED, tmp_path_factory.mktemp("report") / "a run"))
    begun = []
    done = write_report(folder, begun=lambda: begun.append(1))
    assert begun == [1]
    return done


@pytest.fixture
def opened(browser, written):
    """Open the page; what it asked for and complained of is kept with it."""
    pages = []

    def at(width: int, **options):
        page = browser.new_page(viewport={"width": width, "height": 900}, **options)
        pages.append(page)
        page.said, page.asked = [], []
        page.on("console", lambda message: page.said.append(message.text))
        page.on("pageerror", lambda error: page.said.append(str(error)))
        page.on("request", lambda request: page.asked.append(request.url))
        page.goto(written.path.as_uri())
        _until(page, "document.getElementById('reading').textContent !== ''")
        return page

    yield at
    for page in pages:
        page.close()


def _at_rest(page, *parts) -> list[bytes]:
    """What is drawn, once two looks are the same; a robot that goes on moving never gets there."""
    seen = None
    while True:
        found = [part.screenshot() for part in parts]
        if found == seen:
            return found
        seen = found
        page.wait_for_timeout(100)


def _until(page, condition: str) -> None:
    """Wait for a script's answer from outside: the page's policy forbids polling inside."""
    for _ in range(200):
        if page.evaluate(condition):
            return
        page.wait_for_timeout(50)
    pytest.fail(f"never came true: {condition}")


def test_the_page_is_one_small_file_with_figures(written):
    summary = written.summary
    assert written.path.name == "report.html" and written.path.stat().st_size <= MOST_BYTES
    assert summary["report"] == str(written.path) and summary["bytes"] == len(
        written.path.read_bytes()
    )
    assert "certificate-map" in summary["figures"] and len(summary["figures"]) > 5
    page = written.path.read_text()
    assert page.count("<figure>") == len(summary["figures"])
    assert "Proved, to level 3 of 5" in page


def test_the_walk_is_kept_and_is_one_of_whole_steps(written):
    folder = written.path.parent
    walk = json.loads((folder / FILE).read_text())
    assert not walk["fell"] and walk["steps_walked"] == 12
    touchdowns = sum(a != b for a, b in zip(walk["leg"], walk["leg"][1:], strict=False))
    assert touchdowns in (11, 12)
    # Over whole steps the ground carries the weight: the hip is as high at the end as before.
    up = [force[1] for force in walk["force_n"]]
    assert sum(up) / len(up) == pytest.approx(walk["weight_n"], rel=0.02)
    assert walk["poses"][-1][0] - walk["poses"][0][0] > 3.0


def test_a_second_report_repeats_the_first_without_a_simulation(written, monkeypatch):
    before = written.path.read_bytes()
    monkeypatch.setattr("neuralgaits.report.shown_walk.TrainedWalks", None)
    monkeypatch.setattr("neuralgaits.workflows.report.draw", lambda *_: written.figures)
    assert write_report(written.path.parent).path.read_bytes() == before


@pytest.mark.parametrize("width", WIDTHS)
def test_no_request_no_complaint_no_overflow(opened, width):
    page = opened(width)
    page.wait_for_timeout(300)
    assert page.said == []
    assert [url for url in page.asked if not url.startswith("data:")] == [page.url]
    assert page.evaluate("document.documentElement.scrollWidth") <= width
    images = "Array.from(document.images).every((i) => i.complete && i.naturalWidth > 100)"
    assert page.evaluate(images)


def test_the_robot_moves_and_stops(opened):
    page = opened(800)
    robot, portrait, slider = (page.locator(name) for name in ("#robot", "#portrait", "#time"))
    slider.focus()
    # Moving the slider stops the clock.
    page.keyboard.press("End")
    page.keyboard.press("Home")
    assert page.locator("#play").text_content() == "Play"
    first = _at_rest(page, robot, portrait)
    page.locator("#play").click()
    _until(page, "Number(document.getElementById('time').value) > 0.3")
    page.locator("#play").click()
    second, time = _at_rest(page, robot, portrait), slider.input_value()
    assert first[0] != second[0] and first[1] != second[1]
    page.wait_for_timeout(300)
    assert slider.input_value() == time and robot.screenshot() == second[0]
    slider.focus()
    page.keyboard.press("End")
    last = _at_rest(page, robot, portrait)
    assert float(slider.input_value()) > float(time)
    assert last[0] not in (first[0], second[0])


def test_drag_wheel_and_keys_turn_the_view(opened):
    page = opened(800)
    page.get_by_role("button", name="Pause").click()
    robot = page.locator("#robot")
    box = robot.bounding_box()
    middle = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2

    def drag():
        page.mouse.move(*middle)
        page.mouse.down()
        page.mouse.move(middle[0] + 90, middle[1] + 20)
        page.mouse.up()

    def wheel():
        page.mouse.move(*middle)
        page.mouse.wheel(0, -200)

    def key():
        robot.focus()
        page.keyboard.press("ArrowLeft")

    page.wait_for_timeout(100)
    seen = [robot.screenshot()]
    for move in (drag, wheel, key):
        move()
        page.wait_for_timeout(100)
        picture = robot.screenshot()
        assert picture not in seen
        seen.append(picture)


def test_every_control_is_reached_by_tab(opened):
    page = opened(390)
    reached = []
    for _ in range(40):
        page.keyboard.press("Tab")
        reached.append(page.evaluate("document.activeElement.id"))
    positions = [reached.index(name) for name in ("robot", "play", "time", "speed", "reset")]
    assert positions == sorted(positions)


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_text_stands_out_from_its_ground(opened, scheme):
    page = opened(1440, color_scheme=scheme)
    script = """(names) => names.map((name) =>
      getComputedStyle(document.documentElement).getPropertyValue(name).trim())"""
    names = ["--page", "--card", "--ink", "--quiet", "--link", "--good", "--bad", "--open"]
    page_colour, card, *inks = (channels(value) for value in page.evaluate(script, names))
    for ground in (page_colour, card):
        # Contrast of normal text. Source: WCAG 2.2, 1.4.3.
        assert min(contrast(ground, ink) for ink in inks) >= 4.5
    assert (luminance(page_colour) < 0.1) == (scheme == "dark")


def test_paper_has_no_buttons(opened):
    page = opened(1440)
    assert page.locator("#play").is_visible()
    page.emulate_media(media="print")
    assert not page.locator("#play").is_visible() and page.locator("#robot").is_visible()


def test_without_webgl_the_page_says_so_and_goes_on(browser, written):
    page = browser.new_page()
    said = []
    page.on("pageerror", lambda error: said.append(str(error)))
    page.add_init_script(
        "const plain = HTMLCanvasElement.prototype.getContext;"
        "HTMLCanvasElement.prototype.getContext = function (kind, ...more) {"
        "  return kind === 'webgl2' ? null : plain.call(this, kind, ...more); };"
    )
    page.goto(written.path.as_uri())
    _until(page, "document.getElementById('reading').textContent !== ''")
    assert "no WebGL 2" in page.locator("#no-picture").text_content()
    assert said == []
    page.close()


def test_a_place_that_cannot_be_written_is_refused_before_work(shipped, tmp_path):
    with pytest.raises(InputError, match=r"found a folder at .*: name a regular file"):
        write_report(shipped, out=tmp_path)
    with pytest.raises(InputError, match=r"a file \*\.html, found .*page\.pdf"):
        write_report(shipped, out=tmp_path / "page.pdf")
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError, match=r"expected a file that can be written"):
        write_report(shipped, out=tmp_path / "file" / "page.html")
    assert not (shipped / FILE).exists()


def test_no_run_is_one_line(tmp_path):
    with pytest.raises(RunError, match=r"expected a run folder at .*found nothing"):
        write_report(tmp_path / "none")


def test_an_unfinished_run_has_a_report(shipped, tmp_path):
    (shipped / "summary.json").unlink()
    done = write_report(shipped, out=tmp_path / "page.html")
    assert done.figures == [] and done.path.is_file()
    command = f"neuralgaits train --resume {shipped}"
    assert done.summary["missing"] == [{"what": "the end of the training", "command": command}]


@pytest.mark.parametrize("width", WIDTHS)
def test_the_robot_is_in_the_first_screen(opened, width):
    page = opened(width)
    box = page.locator("#robot").bounding_box()
    assert box["y"] + box["height"] < 900
    answer = page.locator("#answer").bounding_box()
    assert box["y"] < answer["y"]


def test_text_and_tables_have_one_width(opened):
    page = opened(1440)
    edges = page.evaluate(
        """[...document.querySelectorAll('main section > p, main table, main pre, #answer, h2')]
          .filter((one) => one.offsetParent && !one.closest('.wide, .missing, details'))
          .map((one) => one.getBoundingClientRect())
          .map((box) => [Math.round(box.left), Math.round(box.right)].join())"""
    )
    assert len(edges) > 20 and len(set(edges)) == 1


def test_charts_stand_beside_each_other_on_a_desk_and_fit_a_telephone(opened):
    def places(page, shown):
        return page.evaluate(
            f"""[...document.querySelectorAll('.figures {shown}')].map((one) => {{
              const box = one.getBoundingClientRect();
              return [Math.round(box.left), Math.round(box.right)]; }})"""
        )

    wide, narrow = places(opened(1440), "img"), places(opened(390), "img")
    assert len({left for left, _ in wide}) == 2
    assert min(right - left for left, right in wide) > 600
    assert len({left for left, _ in narrow}) == 1
    # As wide as the text, which leaves the same margin on either side.
    assert {(left, 390 - right) for left, right in narrow} == {(18, 18)}


def test_columns_of_charts_end_at_one_height(opened):
    page = opened(1440)
    _until(page, "document.readyState === 'complete'")
    figures = page.evaluate(
        """[...document.querySelectorAll('.figures figure')].map((one) => {
          const box = one.getBoundingClientRect();
          return [Math.round(box.left), box.bottom, one.querySelector('.scroll').ariaLabel]; })"""
    )
    left = min(place for place, *_ in figures)
    first, second = (
        max(bottom for place, bottom, _ in figures if (place == left) is is_left)
        for is_left in (True, False)
    )
    assert abs(first - second) < 100.0
    # The first of them stays the first.
    assert figures[0][2] == opened(390).locator(".figures .scroll").first.get_attribute(
        "aria-label"
    )


def test_letters_of_charts_can_be_read_on_a_telephone(opened):
    """Panels stand below one another there; nothing is moved sideways to be seen."""
    page = opened(390)
    shown = page.evaluate(
        """[...document.querySelectorAll('figure img')].map((one) => {
          const inside = parseFloat(getComputedStyle(one).paddingLeft) * 2 + 2;
          return [one.currentSrc.startsWith('data:image/svg'), one.naturalWidth,
            one.clientWidth - inside, one.closest('.scroll').scrollWidth]; })"""
    )
    assert len(shown) > 5
    for is_svg, natural, width, scrolled in shown:
        smallest_px = style.SMALL_PT * 96.0 / 72.0
        assert is_svg and smallest_px * width / natural > 10.0
        assert scrolled <= 390
    page.emulate_media(media="print")
    wide = "document.querySelector('figure img').naturalWidth"
    _until(page, f"{wide} > {style.WIDTH_IN * 90.0}")


def test_a_chart_is_enlarged_on_a_telephone_and_made_smaller_again(opened):
    page = opened(390)
    box, button = page.locator("figure .scroll").first, page.locator("figure .enlarge").first
    cut = """(() => { const box = document.querySelector("figure .scroll");
      return [box.scrollWidth > box.clientWidth + 1, !box.previousElementSibling.hidden]; })()"""

    def cut_and_said(wanted: bool) -> None:
        """Wait until the chart is cut and says so, or neither; the image may still be decoded."""
        _until(page, f"{cut}.every((one) => one === {str(wanted).lower()})")

    cut_and_said(False)
    assert button.text_content() == "Enlarge"
    button.click()
    cut_and_said(True)
    assert button.text_content() == "Smaller"
    assert button.get_attribute("aria-label") == f"Smaller: {box.get_attribute('aria-label')}"
    button.click()
    cut_and_said(False)


@pytest.mark.parametrize("width", WIDTHS)
def test_a_chart_of_another_size_stays_in_view(opened, width):
    page = opened(width)
    buttons = page.locator("figure .enlarge")
    assert buttons.count() > 5
    for button in buttons.all():
        # Larger and smaller again, or the other way round.
        for _ in range(2):
            button.click()
            assert 0.0 <= button.bounding_box()["y"] < 880.0


@pytest.mark.parametrize(("scheme", "turned"), [("light", False), ("dark", True)])
def test_charts_are_no_white_slabs_in_the_dark(opened, scheme, turned):
    page = opened(1440, color_scheme=scheme)
    look = "getComputedStyle(document.querySelector('figure img')).filter"
    assert ("invert" in page.evaluate(look)) == turned
    page.emulate_media(media="print", color_scheme=scheme)
    assert page.evaluate(look) == "none"


def test_captions_are_true_in_both_schemes(written):
    """Lightness is turned round in the dark, so no caption may rest on it."""
    captions = re.findall("<figcaption>(.*?)</figcaption>", written.path.read_text(), re.DOTALL)
    assert len(captions) > 5
    for caption in captions:
        assert not re.search(r"\b(dark|light|black|white|pale)", caption), caption


def test_a_command_breaks_between_its_words_only(opened, written):
    page = opened(390)
    shown = page.locator("pre code").all_text_contents()
    told = re.findall("<pre.*?><code>(.*?)</code></pre>", written.path.read_text(), re.DOTALL)
    assert shown == [html.unescape(text) for text in told]
    heights = page.evaluate(
        """[...document.querySelectorAll('code .word')]
          .filter((word) => word.textContent.startsWith('--'))
          .map((word) => word.getClientRects().length + word.offsetHeight / 40)"""
    )
    assert heights and max(heights) < 2


@pytest.mark.parametrize("width", WIDTHS)
def test_what_is_cut_says_that_it_can_be_moved(opened, width):
    page = opened(width)
    page.evaluate("document.querySelectorAll('details').forEach((one) => { one.open = true; })")
    page.wait_for_timeout(200)
    boxes = page.evaluate(
        """[...document.querySelectorAll('.scroll')].map((box) => [
          box.scrollWidth > box.clientWidth + 1, !box.previousElementSibling.hidden])"""
    )
    assert all(cut == told for cut, told in boxes)
    # Conditions are cards on a telephone: none of their words is cut.
    cut = "[...document.querySelectorAll('.cards')].some((t) => t.scrollWidth > t.clientWidth + 1)"
    assert not page.evaluate(cut)
