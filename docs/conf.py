"""How the pages are built: `make docs`, then open build/docs/index.html."""

import os
import re
import sys
from pathlib import Path

from sphinx.application import Sphinx

# Signatures are read from the imported package.
os.environ["JAX_ENABLE_X64"] = "1"
os.environ["JAX_PLATFORMS"] = "cpu"
sys.path.insert(0, str(Path(__file__).parents[1] / "src"))
sys.path.insert(0, str(Path(__file__).parent))

from neuralgaits import __version__

project = "Neural Gaits"
version = release = __version__
author = "The Neural Gaits developers"
copyright = author

extensions = [
    "myst_parser",
    "sphinx.ext.autodoc",
    "sphinx.ext.napoleon",
    "house_docstrings",
    "offline_math",
]
exclude_patterns = ["images", "assets"]

# Anchors are those of code hosts, so that a link works in both places.
myst_heading_anchors = 4
# $...$ and $$...$$, as code hosts read them.
myst_enable_extensions = ["dollarmath"]
html_math_renderer = "mathml"

autodoc_member_order = "bysource"
autodoc_typehints = "signature"
autodoc_preserve_defaults = True
autodoc_class_signature = "separated"
napoleon_numpy_docstring = False
napoleon_google_docstring = True
default_role = "py:obj"
# Quotes and dots, and no dashes: two hyphens begin an option.
smartquotes_action = "qe"
python_use_unqualified_type_names = True
python_maximum_signature_line_length = 80
add_module_names = False
# Names in the right column are short enough for one line.
toc_object_entries_show_parents = "hide"

html_theme = "furo"
html_title = f"{project} {release}"
html_favicon = "assets/favicon.svg"
html_static_path = ["assets"]
html_css_files = ["pages.css"]
html_js_files = ["menu.js"]
html_copy_source = False
html_show_sphinx = False
html_show_copyright = False


def _outside(app: Sphinx, docname: str, source: list[str]) -> None:
    """Links to pages outside this folder become files to download: they are no pages here."""
    source[0] = re.sub(r"\]\((\.\./[^)#\s]+\.(?:md|ipynb))(#[^)\s]*)?\)", r"](path:\1)", source[0])


def setup(app: Sphinx) -> None:
    """Register with Sphinx."""
    app.connect("source-read", _outside)
