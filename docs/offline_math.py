"""A Sphinx extension: formulas of the pages as MathML, which browsers draw without any script.

So the built pages fetch nothing. A command that the converter does not know is a warning, and a
warning fails the build.
"""

import re

from docutils import nodes
from latex2mathml.converter import convert
from sphinx.application import Sphinx
from sphinx.util import logging
from sphinx.writers.html5 import HTML5Translator

_LOGGER = logging.getLogger(__name__)
_UNKNOWN = re.compile(r"\\[A-Za-z]+")


def mathml(tex: str, display: str) -> str:
    """The formula as one `math` element; `display` is inline or block.

    Raises: ValueError for a command that the converter left as text.
    """
    element = convert(tex, display=display)
    unknown = _UNKNOWN.findall(element)
    if unknown:
        raise ValueError(f"commands without MathML: {' '.join(unknown)}, in {tex!r}")
    # As accents, dots and bars sit close to their letter.
    return element.replace("<mover>", '<mover accent="true">')


def _written(node: nodes.Element, display: str) -> str:
    try:
        return mathml(node.astext(), display)
    except Exception as error:
        _LOGGER.warning("formula not converted: %s", error, location=node)
        return ""


def _inline(translator: HTML5Translator, node: nodes.math) -> None:
    translator.body.append(_written(node, "inline"))
    raise nodes.SkipNode


def _block(translator: HTML5Translator, node: nodes.math_block) -> None:
    translator.body.append(f'<div class="math-block">{_written(node, "block")}</div>')
    raise nodes.SkipNode


def setup(app: Sphinx) -> dict[str, bool]:
    """Register with Sphinx."""
    app.add_html_math_renderer("mathml", (_inline, None), (_block, None))
    return {"parallel_read_safe": True, "parallel_write_safe": True}
