"""Links lead somewhere as a code host follows them, and lists of what there is are whole."""

import re
from dataclasses import fields

import pytest

import neuralgaits
from neuralgaits import errors
from neuralgaits.cli.main import main
from neuralgaits.report.run_figures import MAKERS
from neuralgaits.simulation.setup.disturbance import PlantChanges
from support import pages


@pytest.mark.parametrize("page", pages.PAGES, ids=pages.name)
def test_links_of_a_page(page):
    for link in pages.links(page):
        path, _, anchor = link.partition("#")
        target = (page.parent / path).resolve() if path else page
        assert target.exists(), link
        assert target.is_relative_to(pages.ROOT), link
        if anchor:
            assert anchor in pages.anchors(target), link


def test_the_interface_page_has_every_public_name():
    described = set[str]()
    for name in ("api.md", "api_parts.md"):
        page = pages.read(pages.ROOT / "docs" / name)
        described |= set(re.findall(r"^\.\. auto\w+:: (?:neuralgaits\.)?(\w+)", page, re.MULTILINE))
    assert set(neuralgaits.__all__) - {"__version__"} <= described


def test_the_interface_page_has_every_error():
    page = pages.read(pages.ROOT / "docs" / "api.md")
    listed = re.search(r"automodule:: neuralgaits.errors\n   :members: (.*)", page)
    assert listed
    own = [one for one in vars(errors).values() if isinstance(one, type)]
    assert sorted(listed[1].split(", ")) == sorted(
        one.__name__ for one in own if one.__module__ == errors.__name__
    )


def test_the_report_page_has_every_figure():
    page = pages.read(pages.ROOT / "docs" / "report.md")
    rows = re.findall(r"^\| (`.*?`) \|", page, re.MULTILINE)
    assert {name for row in rows for name in re.findall(r"`([^`]+)`", row)} == {
        name for name, *_ in MAKERS
    }


def test_the_command_line_page_has_every_verb(capsys):
    assert main([]) == 0
    known = re.search(r"\{(.*)\}", capsys.readouterr().out)
    assert known
    page = pages.read(pages.ROOT / "docs" / "command_line.md")
    rows = re.findall(r"^\| `([\w-]+)", page, re.MULTILINE)
    assert set(known[1].split(",")) <= set(rows)


def test_the_page_on_control_has_every_disturbance():
    page = pages.read(pages.ROOT / "docs" / "control.md")
    rows = re.findall(r"^\| `(\w+)` \| (.*?)(?:[,:] .*)? \| (\S+) to (\S+) \|$", page, re.MULTILINE)
    known = [(one.name, one.metadata) for one in fields(PlantChanges)]
    assert [name for name, *_ in rows] == [name for name, _ in known]
    for (_, meaning, low, high), (_, about) in zip(rows, known, strict=True):
        assert about["meaning"].startswith(meaning.partition(",")[0])
        assert (float(low), float(high)) == (about["lowest"], about["highest"])


def test_a_page_that_the_program_names_is_there_under_that_title():
    """A wheel has no folder of pages: they are named as their readers see them."""
    titles = {pages.read(page).partition("\n")[0].removeprefix("# ") for page in pages.PAGES}
    named = set()
    for file in (pages.ROOT / "src").rglob("*.py"):
        named |= set(re.findall(r"the page '([^']+)'", file.read_text(encoding="utf-8")))
    assert named and named <= titles
