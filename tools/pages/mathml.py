"""Sphinx extension: formulas as MathML, which browsers draw without a script.

The font is TeX Gyre Pagella Math of Debian's package fonts-texgyre-math, unchanged, with its
licence beside it. Without a font for mathematics browsers set accents, fences and fractions badly.
"""

from __future__ import annotations

import re
from html import escape
from itertools import count
from pathlib import Path
from typing import TYPE_CHECKING

from docutils import nodes
from docutils.utils.math import MathError
from docutils.utils.math.latex2mathml import tex2mathml
from sphinx.util import logging

if TYPE_CHECKING:
    from sphinx.application import Sphinx
    from sphinx.config import Config
    from sphinx.writers.html5 import HTML5Translator

_ACCENT = re.compile(
    r"<munderover>\s*(<mi>\w</mi>)\s*((?:(?!<munderover>).)*?)\s*"
    r"(<mo stretchy=\"false\">[\N{DIAERESIS}\N{DOT ABOVE}]</mo>)\s*</munderover>",
    re.DOTALL,
)
_BESIDE = r'<msub><mover accent="true">\1\3</mover>\2</msub>'
_FUNCTION = re.compile(
    r"<mi>(sin|cos|tan|arcsin|arcosh|exp|ln|sign|diag)</mi>"
    r"(?P<argument>(?:\s*<mo>&ApplyFunction;</mo>)?\s*(?:<mrow>\s*)?<mo[^>]*>\()?"
)
_PRIME = re.compile(r"(<mi>\w</mi>)\s*<mo>'</mo>")
_OPENED = re.compile(r'(<mo[^>]*>[(\[=+\N{MINUS SIGN},]</mo>\s*<mi class="function(?:-of)?)"')
_SLASH = re.compile(r"<mo[^>]*>/</mo>")
_BAR = re.compile(r"<mo[^>]*>\|</mo>")
_TABLE = '<mtable class="ams-align">'
_TAG = re.compile(r"\\tag\{(\w+)\}")
_FONT = (
    Path("/usr/share/texmf/fonts/opentype/public/tex-gyre-math/texgyrepagella-math.otf"),
    Path("/usr/share/doc/fonts-texgyre-math/copyright"),
)


def setup(app: Sphinx) -> dict[str, bool]:
    """Register the renderer `mathml`."""
    app.add_html_math_renderer("mathml", (_visit_inline, None), (_visit_block, None))
    app.connect("config-inited", _add_font)
    return {"parallel_read_safe": True, "parallel_write_safe": True}


def _add_font(_: Sphinx, config: Config) -> None:
    """Let the site have a copy of the font."""
    for path in _FONT:
        if not path.is_file():
            logging.getLogger(__name__).warning(
                "no %s: install the package fonts-texgyre-math", path
            )
    config.html_static_path += [str(path) for path in _FONT if path.is_file()]


def _visit_inline(translator: HTML5Translator, node: nodes.math) -> None:
    translator.body.append(_mathml(node, node.astext(), as_block=False))
    raise nodes.SkipNode


def _visit_block(translator: HTML5Translator, node: nodes.math_block) -> None:
    """Draw a displayed formula, with a linked tag at the right."""
    text = node.astext()
    tags = _TAG.findall(text)
    formula = _mathml(node, _TAG.sub("", text).strip(), as_block=True)
    labels = "".join(f'<span id="{escape(tag)}">({escape(tag)})</span>' for tag in tags)
    translator.body.append(f'<div class="formula">{formula}{labels}</div>\n')
    raise nodes.SkipNode


def _mathml(node: nodes.Node, text: str, *, as_block: bool) -> str:
    try:
        formula = tex2mathml(text, as_block=as_block)
    except MathError as error:
        logging.getLogger(__name__).warning("%s: %s", error, text, location=node)
        return ""
    return _mended(formula)


def _mended(formula: str) -> str:
    """Mend the MathML of docutils: indices of accented letters, primes, spaces, bars, tables."""

    def mend_function(found: re.Match[str]) -> str:
        kind = "function-of" if found["argument"] else "function"
        return f'<mi class="{kind}">{found[1]}</mi>{found["argument"] or ""}'

    number = count()

    def mend_bar(_: re.Match[str]) -> str:
        form = "postfix" if next(number) % 2 else "prefix"
        return f'<mo form="{form}" stretchy="false">|</mo>'

    formula = _ACCENT.sub(_BESIDE, formula)
    formula = _PRIME.sub('<mrow>\\1<mo lspace="0" rspace="0">\N{PRIME}</mo></mrow>', formula)
    formula = _SLASH.sub('<mo stretchy="false" lspace="0.06em" rspace="0.06em">/</mo>', formula)
    formula = _BAR.sub(mend_bar, formula)
    formula = formula.replace(_TABLE, _TABLE[:-1] + ' displaystyle="true">')
    return _OPENED.sub(r'\1 opened"', _FUNCTION.sub(mend_function, formula))
