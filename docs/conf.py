"""Settings of Sphinx; tools/docs calls it."""

import sys
from pathlib import Path

from pygments.lexers.fortran import FortranLexer
from sphinx.application import Sphinx

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tools"))

import rwmf

project = "rwmf"
author = "the rwmf authors"
project_copyright = author
version = release = rwmf.__version__
extensions = ["myst_parser", "numpydoc", "sphinx.ext.autodoc", "pages.mathml", "pages.search"]
exclude_patterns = ["**/figures/**"]
myst_enable_extensions = ["dollarmath"]
myst_heading_anchors = 3
html_math_renderer = "mathml"
html_theme = "furo"
html_title = f"rwmf {version}"
html_static_path = ["site.css", "search/search.js"]
templates_path = ["search"]
html_css_files = ["site.css"]
html_show_sphinx = False
html_copy_source = False
html_favicon = None
# numpydoc's sections name the types in words; the signatures show the names alone
autodoc_typehints = "none"
autodoc_member_order = "bysource"
numpydoc_class_members_toctree = False
numpydoc_show_class_members = False
# public names only; attributes of data classes are their arguments
numpydoc_validation_checks = {"all", "ES01", "EX01", "GL01", "GL02", "GL08", "PR04", "SA01", "SS03"}
numpydoc_validation_exclude = {r"\.[A-Z]\w*$"}


def setup(app: Sphinx) -> None:
    """Let namelists be coloured as Fortran."""
    app.add_lexer("nml", FortranLexer)
