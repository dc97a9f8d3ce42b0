"""Sphinx extension: a search with excerpts that works in a site opened as a folder.

Browsers refuse to fetch pages of a site without a server. The text of every section is therefore
one script, `_static/sections.js`, which the search page loads; `docs/search/search.js` ranks the
sections and shows excerpts. A line of a text is a paragraph or a row of a table, whose cells a tab
separates; words that occur together count more. Code comes after the prose of its section.
"""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import TYPE_CHECKING, TypeAlias

from docutils import nodes
from sphinx import addnodes

if TYPE_CHECKING:
    from collections.abc import Iterator

    from sphinx.application import Sphinx

# page, heading, address, text
Section: TypeAlias = tuple[str, str, str, str]
_PARTS = (nodes.section, addnodes.desc)
_NO_TEXT = (
    *_PARTS,
    nodes.title,
    nodes.thead,
    nodes.comment,
    nodes.math_block,
    nodes.raw,
    addnodes.toctree,
)
_BLOCKS = (nodes.paragraph, nodes.term, nodes.literal_block, nodes.row, nodes.caption)


def setup(app: Sphinx) -> dict[str, bool]:
    """Register the extension."""
    app.connect("build-finished", _write_sections)
    return {"parallel_read_safe": True, "parallel_write_safe": True}


def _write_sections(app: Sphinx, failure: Exception | None) -> None:
    if failure is not None or app.builder.format != "html":
        return
    found = [
        section
        for name in sorted(app.env.found_docs)
        for section in _sections_of(app.env.get_doctree(name), app.builder.get_target_uri(name))
    ]
    text = json.dumps(found, ensure_ascii=False, separators=(",", ":"))
    path = Path(app.outdir) / "_static" / "sections.js"
    path.write_text(f"const SECTIONS = {text};\n", encoding="utf-8")


def _sections_of(tree: nodes.document, address: str) -> Iterator[Section]:
    """List the sections of a page; the first one has its title as heading."""
    page = ""
    for part in tree.findall(lambda node: isinstance(node, _PARTS)):
        heading, label = _heading(part)
        place = f"{address}#{label}" if page and label else address
        page = page or heading
        texts = sorted(_texts(part), key=lambda text: text[0])
        text = "\n".join(words for _, words in texts)
        if heading and (text or heading != page):
            yield page, heading, place, text


def _heading(part: nodes.Element) -> tuple[str, str]:
    """Find the heading of a section and the name of its place."""
    if isinstance(part, addnodes.desc):
        signature = part[0]
        assert isinstance(signature, nodes.Element)
        ids = signature.get("ids", [])
        return signature.get("fullname", signature.astext()), ids[0] if ids else ""
    return part[0].astext(), part["ids"][0]


def _texts(node: nodes.Element) -> Iterator[tuple[bool, str]]:
    """List the texts of a section without those of its subsections, and whether each is code."""
    for child in node.children:
        if isinstance(child, _NO_TEXT):
            continue
        if isinstance(child, _BLOCKS):
            cells = child.children if isinstance(child, nodes.row) else [child]
            yield isinstance(child, nodes.literal_block), "\t".join(map(_words, cells))
        elif isinstance(child, nodes.Element):
            yield from _texts(child)


def _words(node: nodes.Node) -> str:
    """Join the words of a node in one line, without the raw links of made pages."""
    return " ".join(re.sub(r"</?a\b[^<>]*>", " ", node.astext()).split())
