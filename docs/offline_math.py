"""A Sphinx extension: formulas of the pages as MathML, which browsers draw without any script.

So the built pages fetch nothing. A command that the converter does not know is a warning, and a
warning fails the build. Spacing is corrected to that of LaTeX, which the converter leaves to the
browser.
"""

import re
from itertools import pairwise
from xml.etree import ElementTree

from docutils import nodes
from latex2mathml.converter import convert
from sphinx.application import Sphinx
from sphinx.util import logging
from sphinx.writers.html5 import HTML5Translator

_LOGGER = logging.getLogger(__name__)
_MATHML = "http://www.w3.org/1998/Math/MathML"
_COMMAND = re.compile(r"\\[A-Za-z]+")
_BAR = re.compile(r"\\[lr]vert\b")
_CLOSING = {")", "]"}
_FUNCTIONS = {"exp", "log", "max", "sup"}
_THIN = "0.17em"
_LONG = 32
"""Characters of a formula in a line that is wider than a phone."""

ElementTree.register_namespace("", _MATHML)


def mathml(tex: str, display: str) -> str:
    """The formula as one `math` element; `display` is inline or block.

    Raises: ValueError for a command that the converter left as text, or for a bar without a side.
    """
    root = ElementTree.fromstring(convert(tex, display=display))
    unknown = _COMMAND.findall("".join(root.itertext()))
    if unknown:
        raise ValueError(f"commands without MathML: {' '.join(unknown)}, in {tex!r}")
    _close_bars(root, _BAR.findall(tex))
    for element in root.iter():
        _signs(list(element))
        if element.tag == f"{{{_MATHML}}}mrow":
            _functions(list(element))
        _prime(element)
    for accented in root.iter(f"{{{_MATHML}}}mover"):
        # As accents, dots and bars sit close to their letter.
        accented.set("accent", "true")
        accented[1].set("stretchy", "false")
    return ElementTree.tostring(root, encoding="unicode")


def _close_bars(root: ElementTree.Element, sides: list[str]) -> None:
    """Bars open and close as in the LaTeX, where they stand in the same order."""
    bars = [element for element in root.iter() if element.text == "|"]
    if len(bars) != len(sides) or 2 * sides.count(r"\lvert") != len(sides):
        raise ValueError("write absolute values with \\lvert and \\rvert")
    for bar, side in zip(bars, sides, strict=True):
        bar.set("form", "prefix" if side == r"\lvert" else "postfix")
        bar.set("stretchy", "false")


def _signs(row: list[ElementTree.Element]) -> None:
    """A minus after an operator is a sign; a slash has no space around it."""
    for before, element in pairwise([None, *row]):
        assert element is not None
        if element.text == "/":
            element.set("lspace", "0")
            element.set("rspace", "0")
        elif element.text == "−" and (before is None or _opens(before)):
            element.set("form", "prefix")


def _functions(row: list[ElementTree.Element]) -> None:
    """A function has a thin space before it, and after it unless a bracket follows."""
    for before, element, after in zip([None, *row], row, [*row[1:], None], strict=False):
        if element.text in _FUNCTIONS:
            element.tag = f"{{{_MATHML}}}mo"
            element.set("lspace", "0" if before is None or _opens(before) else _THIN)
            element.set("rspace", "0" if after is not None and after.text == "(" else _THIN)


def _prime(element: ElementTree.Element) -> None:
    """A prime is raised and small already: as an index it can hardly be seen."""
    if element.tag == f"{{{_MATHML}}}msup" and element[1].text == "′":
        element.tag = f"{{{_MATHML}}}mrow"
        element[1].tag = f"{{{_MATHML}}}mo"
        element[1].set("lspace", "0")
        element[1].set("rspace", "0")


def _opens(element: ElementTree.Element) -> bool:
    """Whether an operand follows this one, and no operator."""
    is_operator = element.tag == f"{{{_MATHML}}}mo" and element.get("form") != "postfix"
    return is_operator and element.text not in _CLOSING


def _written(node: nodes.Element, display: str) -> str:
    try:
        return mathml(node.astext(), display)
    except Exception as error:
        _LOGGER.warning("formula not converted: %s", error, location=node)
        return ""


def _inline(translator: HTML5Translator, node: nodes.math) -> None:
    written = _written(node, "inline")
    if len(re.sub(r"<[^>]*>", "", written)) > _LONG:
        written = f'<span class="math-long">{written}</span>'
    translator.body.append(written)
    raise nodes.SkipNode


def _block(translator: HTML5Translator, node: nodes.math_block) -> None:
    translator.body.append(f'<div class="math-block">{_written(node, "block")}</div>')
    raise nodes.SkipNode


def setup(app: Sphinx) -> dict[str, bool]:
    """Register with Sphinx."""
    app.add_html_math_renderer("mathml", (_inline, None), (_block, None))
    return {"parallel_read_safe": True, "parallel_write_safe": True}
