"""A Sphinx extension: docstrings and signatures of this project as readers want them.

Docstrings here say `Returns: [2] rate (m/s, N m).` on one line, and put absolute values between
bars; both mean something else to Sphinx. Types of jaxtyping come out with the module of JAX's
array class and once more for NumPy's.
"""

import re
from typing import Any

from docutils import nodes
from sphinx import addnodes
from sphinx.application import Sphinx

_SECTION = re.compile(r"^(Returns|Raises|Source): (?=\S)")
_ATTRIBUTE = re.compile(r"^    ([\w, ]+): ")
_BEFORE_NAPOLEON = 400
"""Priority; napoleon has 500."""
_QUALIFIED = re.compile(r"~?(?:jaxtyping|numpy|jaxlib\._jax)\.")
_TYPES = (
    # Whatever a function takes as a JAX array it takes as a NumPy array.
    (re.compile(r"(\w+)\[Array, ('[^']*')\] \| \1\[ndarray, \2\]"), r"\1[Array, \2]"),
    (re.compile(r"Key\[Array, ''\]( \| UInt32\[Array, '\d'\])+"), "Key"),
    # No axes: one number.
    (re.compile(r"\[(Array|ndarray), ''\]"), r"[\1, 'scalar']"),
)


def readable(annotation: str) -> str:
    """A type or signature without the inner names of libraries."""
    annotation = _QUALIFIED.sub("", annotation)
    for pattern, words in _TYPES:
        annotation = pattern.sub(words, annotation)
    return annotation


def fields(lines: list[str]) -> list[str]:
    """Docstring lines with one-line sections and lists of attributes as fields.

    A section goes on until an empty line. Attributes may share a line, as in `lower, upper: ...`.
    """
    out: list[str] = []
    inside = ""
    for line in lines:
        # A pattern of file names is no emphasis.
        line = line.replace("|", r"\|").replace("/*.", r"/\*.")
        section = _SECTION.match(line)
        if line == "Attributes:":
            inside, line = "attributes", ":Attributes:"
        elif section:
            if out and not inside:
                out.append("")
            inside, line = "section", _SECTION.sub(r":\1: ", line)
        elif not line:
            inside = ""
        elif inside == "attributes":
            named = _ATTRIBUTE.match(line)
            entry = _ATTRIBUTE.sub(r"    * **\1** -- ", line)
            line = entry if named else f"      {line.strip()}"
        elif inside == "section":
            line = f"    {line.strip()}"
        out.append(line)
    return out


def _docstring(app: Sphinx, what: str, name: str, obj: Any, options: Any, lines: list[str]) -> None:
    lines[:] = fields(lines)


def _signature(
    app: Sphinx, what: str, name: str, obj: Any, options: Any, signature: str, returns: str
) -> tuple[str | None, str | None]:
    return signature and readable(signature), returns and readable(returns)


def _attributes(app: Sphinx, doctree: nodes.document) -> None:
    """Types of attributes, which no event of autodoc passes on."""
    for node in doctree.findall(addnodes.desc_annotation):
        # A name that may become a link is there twice, in full and in short.
        for either in list(node.findall(addnodes.pending_xref_condition)):
            if either.get("condition") == "resolved":
                either.parent.remove(either)
        words = node.astext()
        if "[" in words:
            node.children = [nodes.Text(readable(words))]


def setup(app: Sphinx) -> dict[str, bool]:
    """Register with Sphinx."""
    app.connect("autodoc-process-docstring", _docstring, priority=_BEFORE_NAPOLEON)
    app.connect("autodoc-process-signature", _signature)
    app.connect("doctree-read", _attributes)
    return {"parallel_read_safe": True}
