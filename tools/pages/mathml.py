"""Sphinx extension: formulas as MathML, which browsers draw without a script or a font of ours."""

from __future__ import annotations

import re
from html import escape
from typing import TYPE_CHECKING

from docutils import nodes
from docutils.utils.math import MathError
from docutils.utils.math.latex2mathml import tex2mathml
from sphinx.util import logging

if TYPE_CHECKING:
    from sphinx.application import Sphinx
    from sphinx.writers.html5 import HTML5Translator

_ACCENT = re.compile(
    r"<munderover>\s*(<mi>\w</mi>)\s*((?:(?!<munderover>).)*?)\s*"
    r"(<mo stretchy=\"false\">[\N{DIAERESIS}\N{DOT ABOVE}]</mo>)\s*</munderover>",
    re.DOTALL,
)
_BESIDE = r'<msub><mover accent="true">\1\3</mover>\2</msub>'
_FUNCTION = re.compile(r"<mi>(sin|cos|tan)</mi>")
_TAG = re.compile(r"\\tag\{(\w+)\}")


def setup(app: Sphinx) -> dict[str, bool]:
    """Register the renderer `mathml`.

    Parameters
    ----------
    app : Sphinx
        The application.

    Returns
    -------
    dict
        Metadata of the extension for Sphinx.
    """
    app.add_html_math_renderer("mathml", (_visit_inline, None), (_visit_block, None))
    return {"parallel_read_safe": True, "parallel_write_safe": True}


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
        # docutils sets the index of an accented letter below it, and functions without a space
        formula = _ACCENT.sub(_BESIDE, tex2mathml(text, as_block=as_block))
        return _FUNCTION.sub(r'<mi class="function">\1</mi>', formula)
    except MathError as error:
        logging.getLogger(__name__).warning("%s: %s", error, text, location=node)
        return ""
