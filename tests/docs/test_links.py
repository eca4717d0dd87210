"""Links lead somewhere, from a code host's view of the pages as from the built ones."""

import re

import pages
import pytest

import neuralgaits


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
