"""Formulas between dollars are such as a code host and the built pages read alike."""

import re
import runpy

import pytest

from support import pages

MATHML = runpy.run_path(str(pages.ROOT / "docs" / "offline_math.py"))["mathml"]
_CODE = re.compile(r"^```.*?^```$|`[^`\n]*`", re.DOTALL | re.MULTILINE)
_DISPLAYED = re.compile(r"^\$\$\n(.*?)\n\$\$$", re.DOTALL | re.MULTILINE)
_INLINE = re.compile(r"\$([^$]*)\$")


def prose(page) -> str:
    """The page without its code."""
    return _CODE.sub("", pages.read(page))


def formulas(page) -> list[tuple[str, str]]:
    """Each formula, and how it is set."""
    text = prose(page)
    inline = _INLINE.findall(_DISPLAYED.sub("", text))
    displayed = _DISPLAYED.findall(text)
    return [(tex, "block") for tex in displayed] + [(tex, "inline") for tex in inline]


WITH_FORMULAS = [page for page in pages.PAGES if formulas(page)]


def test_there_are_some():
    assert WITH_FORMULAS


@pytest.mark.parametrize("page", WITH_FORMULAS, ids=pages.name)
def test_a_formula_stands_on_one_line(page):
    """A dollar without its partner would swallow prose."""
    for line in _DISPLAYED.sub("", prose(page)).splitlines():
        assert line.count("$") % 2 == 0, line


@pytest.mark.parametrize("page", WITH_FORMULAS, ids=pages.name)
def test_a_code_host_leaves_formulas_alone(page):
    """It eats a backslash before punctuation, ends a cell at a bar, and trims no space."""
    for tex, _ in formulas(page):
        assert not re.search(r"\\[^A-Za-z]", tex), tex
        assert "|" not in tex, tex
        assert tex == tex.strip(), tex


@pytest.mark.parametrize("page", WITH_FORMULAS, ids=pages.name)
def test_a_formula_becomes_mathml(page):
    for tex, display in formulas(page):
        assert MATHML(tex, display).startswith("<math")


@pytest.mark.parametrize("tex", [r"\nothing x", "|x|", r"\lvert x"])
def test_a_formula_that_is_not_understood_is_refused(tex):
    with pytest.raises(ValueError):
        MATHML(tex, "inline")
