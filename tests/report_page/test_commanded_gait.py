"""What a page says of a gait that takes commands: what it is told, and of which what is proved."""

import shutil
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import pytest

from neuralgaits.certificate.chart import Axis, Chart
from neuralgaits.certificate.run_certificate.verified_summary import CertificateReading, ProvedPart
from neuralgaits.gait.commands import Command
from neuralgaits.records.certified import CertificateRecord, Conclusion, ConditionVerdict
from neuralgaits.records.training_config import Range
from neuralgaits.report.certificate import part_of
from neuralgaits.report.drawing.command_words import FAMILY
from neuralgaits.report.drawing.figure_files import FigureFiles, MissingFigure
from neuralgaits.report.page.answer import answer
from neuralgaits.report.page.closing import figures, missing_parts, reproduction
from neuralgaits.report.page.command_family import family
from neuralgaits.report.page.document import document
from neuralgaits.report.page.markup import Html
from neuralgaits.report.page.proof import certificate
from neuralgaits.report.page.saved import ProvedOfSome
from neuralgaits.workflows import demo

CONDITIONS = ("ahead", "torso", "knee")
SLOPE = Range(-0.08726646259971647, 0.08726646259971647, 0.020943951023931952)
PICTURE = Html('<img src="data:,">')


@pytest.fixture
def commanded(contents, tmp_path):
    """Contents of a page of the gait that is told its speed; fields of what is saved changed."""
    without = shutil.ignore_patterns("certificate")
    folder = shutil.copytree(demo.TOLD, tmp_path / "told", ignore=without)

    def make(drawn=(), commands=None, **changed):
        page = contents(folder, figures=list(drawn))
        asked = page.saved.config
        if commands is not None:
            asked = replace(asked, commands=commands)
        return replace(page, saved=replace(page.saved, config=asked, **changed))

    return make


def certified(*proved, levels=()):
    """A certificate with these conditions proved, and these levels above 1."""
    rows = {
        name: ConditionVerdict("proved" if name in proved else "undecided", 1.0, 1, 0.1, None, 0)
        for name in CONDITIONS
    }
    above = tuple(
        Conclusion(level, "proved" if level in levels else "undecided", None) for level in (2, 3)
    )
    whole = len(proved) == len(CONDITIONS) and len(levels) == 2
    return CertificateRecord(
        verdict="proved" if whole else "undecided",
        level=3,
        conditions=rows,
        levels=above,
        boxes=1,
        wall_s=1.0,
    )


def said(page, pictures=None):
    (part,) = family(page, pictures or {})
    return part


def test_a_gait_that_is_told_nothing_has_no_such_part(contents):
    page = contents()
    assert list(family(page, {})) == []
    whole = document(page)
    assert "Its commands" not in whole and 'id="told"' not in whole


def test_what_is_told_stands_there_with_its_range_and_its_change(commanded):
    page = said(commanded())
    assert "the mean speed to walk at" in page
    for text in ("0.55 m/s", "0.9 m/s", "0.042 m/s", "spread over several steps"):
        assert text in page
    whole = document(commanded())
    assert whole.count('<h2 id="told">') == 1 and 'href="#told"' in whole


def test_slopes_are_in_degrees_and_where_any_may_follow_any_it_says_so(commanded):
    page = said(commanded(commands={"slope": SLOPE}))
    assert "−5°" in page and "1.2°" in page and "0.087" not in page
    page = said(commanded(commands={"step_length": Range(0.3, 0.4)}))
    assert ">any<" in page and "spread over" not in page


def test_a_command_of_a_specs_own_is_text(commanded):
    page = said(commanded(commands={"<img src=x>": Range(0.0, 1.0)}))
    assert "<img" not in page and "&lt;img src=x&gt;" in page


def test_without_a_proof_nothing_is_called_proved(commanded):
    page = said(commanded())
    assert "Nothing is proved for any of these commands." in page
    assert "Proved" not in page and "level" not in page


@pytest.mark.parametrize("level", [1, 2, 3])
def test_a_whole_proof_is_said_to_its_level_and_no_further(commanded, level):
    found = certified(*CONDITIONS, levels=range(2, level + 1))
    page = said(commanded(certificate=found))
    assert f"Proved for all of these commands, to level {level}:" in page
    assert "every condition holds at every state of its region" in page
    assert ("walk for ever" in page) is (level >= 2)
    assert ("come together" in page) is (level >= 3)
    assert "only" not in page


def test_no_part_of_the_page_speaks_of_one_orbit_of_a_gait_with_many(commanded):
    """Level 3 is about two walks that are told the same: none of them need repeat itself."""
    page = commanded(certificate=certified(*CONDITIONS, levels=(2, 3)))
    for part in (answer(page), certificate(page), said(page)):
        assert "one motion that repeats" not in part and "one periodic orbit" not in part
        assert "under the same commands" in part
    assert "from its commands and two numbers" in answer(page)
    open_ = commanded(certificate=replace(certified(*CONDITIONS, levels=(2,)), level=2))
    (third,) = [what for what, _ in missing_parts(open_) if what.startswith("level 3")]
    assert "under the same commands" in third


def test_conditions_of_which_some_are_open_are_counted(commanded):
    page = said(commanded(certificate=certified("ahead", "torso")))
    assert "2 of 3 conditions are proved for all of these commands." in page
    assert "Proved for" not in page and "for ever" not in page


def test_a_part_that_is_proved_is_named_and_the_rest_is_not(commanded):
    some = {"speed": Range(0.7000001, 0.7399999, 0.0420001)}
    none = certified()
    page = said(commanded(certificate=none, of_some=ProvedOfSome(some, 3, 2)))
    assert (
        "Proved for some of these commands only: mean speed from 0.7001 m/s to 0.7399 m/s" in page
    )
    assert "changing by at most 0.042 m/s a step" in page
    assert "walk for ever" in page and "come together" not in page
    assert "Of all other commands nothing is proved." in page and "all of these" not in page
    page = said(commanded(certificate=none, of_some=ProvedOfSome(some, 2, 0)))
    assert "There, with joints exactly on target, 2 of 3 conditions hold" in page
    assert "every condition" not in page
    page = said(commanded(certificate=none, of_some=ProvedOfSome({}, 3, 1)))
    there = "There, with joints exactly on target, every condition"
    assert f"of which the proof file has the pairs. </b>{there}" in page
    page = said(commanded(certificate=none, of_some=ProvedOfSome(some, 0, 0)))
    assert "Nothing is proved for any" in page and "0.7" not in page.split("</table>")[1]


def test_a_proof_of_some_commands_is_repeated_of_them_and_to_its_level(commanded):
    """Whatever ranges and level the summary has."""
    some = {"speed": Range(0.7, 0.74, 0.042)}
    forged = replace(certified(), level=5, within={"speed": (0.0, 9.0)})
    block = reproduction(commanded(certificate=forged, of_some=ProvedOfSome(some, 3, 2)))
    assert "-again --level 2 --within speed=0.7:0.74\n" in block and "9.0" not in block


def reading(chart, conditions, levels, told=("speed",)):
    proof: Any = SimpleNamespace(chart=chart)
    above = tuple(Conclusion(level, "proved", None) for level in levels)
    return CertificateReading(certified(), None, proof, False, ProvedPart(told, conditions, above))


def test_a_part_has_the_ranges_of_its_own_proof():
    chart = Chart.of([Command("speed", 0.70, 0.74, 0.03), Command("slope", -0.01, 0.02)])
    found = part_of(reading(chart, CONDITIONS, (2, 3), ("speed", "slope")))
    assert found is not None and (found.conditions, found.level) == (3, 3)
    ranges = {name: (one.low, one.high, one.largest_change) for name, one in found.ranges.items()}
    assert ranges == {"speed": (0.70, 0.74, 0.03), "slope": (-0.01, 0.02, None)}


def test_a_level_of_a_part_rests_on_those_below_it():
    chart = Chart((Axis("speed before", 0.7, 0.8), Axis("speed after", 0.6, 0.8)))
    for conditions, levels, level in (
        (CONDITIONS, (), 1),
        (CONDITIONS, (2,), 2),
        (CONDITIONS, (3,), 1),
        (CONDITIONS[:2], (), 0),
    ):
        found = part_of(reading(chart, conditions, levels, told=()))
        assert found is not None and (found.level, dict(found.ranges)) == (level, {})
    assert part_of(CertificateReading()) is None
    assert part_of(reading(chart, (), ())._replace(part=None)) is None


def test_the_figure_stands_there_and_nowhere_else(commanded, tmp_path):
    files = tmp_path / "a.png", tmp_path / "a.svg", tmp_path / "a-narrow.svg"
    for file in files:
        file.write_bytes(b"a picture")
    drawn = [
        FigureFiles(name, f"title of {name}", "to be seen.", *files) for name in (FAMILY, "loss")
    ]
    page = commanded(drawn)
    pictures = {figure.name: PICTURE for figure in drawn}
    assert f"title of {FAMILY}" in said(page, pictures) and PICTURE in said(page, pictures)
    rest = figures(page, pictures)
    assert "title of loss" in rest and FAMILY not in rest
    assert document(page).count("<figure>") == 2


def test_where_there_is_no_orbit_a_line_says_why(commanded):
    lost = MissingFigure(
        FAMILY, "A family of gaits", "no orbit was found", "neuralgaits train amber3m"
    )
    page = commanded([lost])
    assert "not drawn: no orbit was found." in said(page) and 'href="#missing"' in said(page)
    assert "A family" not in figures(page, {})
    assert "<code>neuralgaits train amber3m</code>" in document(page)


@pytest.mark.parametrize("kinds", [("floor",), ("mass",), ("floor", "mass")])
def test_level_3_of_a_box_is_not_about_one_orbit_for_all(contents, kinds):
    """On an uneven floor walks converge to each other; robots have an orbit each."""
    page, box = contents(), {"floor": 0.005, "mass": 0.01}
    found = replace(
        certified(*CONDITIONS, levels=(2, 3)), parameters={kind: box[kind] for kind in kinds}
    )
    page = replace(page, saved=replace(page.saved, certificate=found))
    for part in (answer(page), certificate(page)):
        assert ("footholds lie equally high" in part) is ("floor" in kinds)
        assert ("its own" in part) is ("mass" in kinds)
    assert "one periodic orbit attracts the whole walking set<" not in certificate(page)
