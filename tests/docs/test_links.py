"""Links lead somewhere as a code host follows them, and lists of what there is are whole."""

import re

import pytest

import neuralgaits
from neuralgaits.cli.main import main
from neuralgaits.report.makers import MAKERS, OF_FAMILIES
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
    page = pages.read(pages.ROOT / "docs" / "api.md")
    described = set(re.findall(r"^\.\. auto\w+:: (?:neuralgaits\.)?(\w+)", page, re.MULTILINE))
    assert set(neuralgaits.__all__) - {"__version__"} <= described


def test_the_report_page_has_every_figure():
    page = pages.read(pages.ROOT / "docs" / "report.md")
    rows = re.findall(r"^\| (`.*?`) \|", page, re.MULTILINE)
    assert {name for row in rows for name in re.findall(r"`([^`]+)`", row)} == {
        name for name, *_ in (*MAKERS, *OF_FAMILIES)
    }


def test_the_readme_has_every_verb(capsys):
    assert main([]) == 0
    known = re.search(r"\{(.*)\}", capsys.readouterr().out)
    assert known
    rows = re.findall(r"^\| `([\w-]+)", pages.read(pages.ROOT / "README.md"), re.MULTILINE)
    assert set(known[1].split(",")) <= set(rows)
