"""Bars of margins: right lengths, right colours, and nothing that a browser would run."""

import re

import numpy as np
import pytest

from neuralgaits.viewer import bars
from neuralgaits.viewer.page_style import BAD, GOOD, QUIET, SAID, TIGHT
from neuralgaits.viewer.walker import Margins
from support.contrast import channels, contrast


def test_bars_have_the_length_of_their_margins():
    margins = Margins(np.array([0.5, 2.0, -0.25, np.nan, 0.01]), np.array([True] * 4 + [False]))
    page = bars.render(["half", "full", "broken", "none", "tight"], margins)
    widths = [int(width) for width in re.findall(r"width:(\d+)%", page)]
    assert widths == [50, 100, 25, 0, 1]
    assert [">0.50<" in page, ">−0.25<" in page, ">–<" in page] == [True] * 3
    assert page.count(f"background:{BAD.light}") == page.count(BAD.dark) == 1
    assert page.count("opacity:.45") == 1
    # Beyond the end of a bar only the number tells 1 from 2, so the axis comes first.
    assert page.index("Bar: 0 to 1 scale of the condition") < page.index(">half<")


def test_a_page_without_numbers_says_why():
    margins = Margins(np.full(2, np.nan), np.zeros(2, dtype=bool), "they are still being computed")
    page = bars.render(["one", "two"], margins)
    assert "No margins at present: they are still being computed." in page
    assert "–" not in page and "height:9px" not in page


def test_names_of_a_users_conditions_are_text():
    margins = Margins(np.array([1.0]), np.array([True]))
    page = bars.render(["<script>alert(1)</script>"], margins)
    assert "<script" not in page
    assert "&lt;script&gt;" in page


def test_a_bar_says_what_its_condition_states_and_its_name():
    """Both without a hint, which a touch screen does not show."""
    margins = Margins(np.array([1.0, 1.0]), np.array([True, False]))
    page = bars.render(["one", "two"], margins, {"one": 'torso < "upright"; slowly'})
    assert 'title="one; torso &lt; &quot;upright&quot;; slowly; z is in its region"' in page
    (found,) = re.findall(r">(torso[^<]*)</span> <code[^>]*>([^<]*)</code></span>", page)
    assert found == ("torso &lt; &quot;upright&quot;", "one")
    assert 'title="two; z is outside of its region: read near it"' in page
    # Where there are no words the name is the label, once.
    assert ">two</span>" in page and page.count("two") == 2


def test_bars_of_another_robot_than_the_files_say_so_and_have_no_colour():
    margins = Margins(np.array([0.5, -0.25]), np.array([True, True]))
    own, changed = (bars.render(["one", "two"], margins, changed=one) for one in (False, True))
    about = "About the robot and the floor of the file, not about what was changed."
    assert about not in own and about in changed
    assert GOOD.light in own and BAD.light in own
    assert GOOD.light not in changed and BAD.light not in changed


@pytest.mark.parametrize("ink", [GOOD, BAD, TIGHT, QUIET, SAID])
def test_words_stand_out_from_their_ground(ink):
    """The panel's own grounds. Source of the ratio: WCAG 2.2, 1.4.3, normal text."""
    for colour, ground in ((ink.light, "#ffffff"), (ink.dark, "#242424")):
        assert contrast(channels(colour), channels(ground)) >= 4.5


def test_no_words_are_pale():
    margins = Margins(np.array([0.5]), np.array([False]))
    page = bars.render(["one"], margins)
    assert re.findall(r"<[^>]*opacity[^>]*>([^<]*)", page) == [""]
