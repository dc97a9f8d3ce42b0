"""One self-contained page: figures, claims, validation and the versions that made it."""

from __future__ import annotations

import base64
import html
import platform
from collections.abc import Sequence
from pathlib import Path

import rwmf
from rwmf.reproduce.contents import Contents
from rwmf.reproduce.gallery import GALLERY
from rwmf.reproduce.pages import BENEFIT_NOTE, CLAIMS_NOTE, CONTACT_NOTE, VALIDATION_NOTE
from rwmf.reproduce.tables import Table

__all__ = ["compose"]

# one column, wide tables become cards on a phone, dark on request of the reader's system
_STYLE = """
:root { color-scheme: light dark; }
body { font: 16px/1.5 system-ui, sans-serif; max-width: 68rem; margin: 0 auto; padding: 1rem;
       color: #1b1b1b; background: #fff; overflow-wrap: break-word; }
h1 { font-size: 1.6rem; line-height: 1.2; } h2 { margin-top: 2.5rem; }
nav a { margin-right: 1rem; }
figure { margin: 2rem 0; } figcaption { margin-top: .3rem; }
img { max-width: 100%; height: auto; display: block; margin: auto; background: #fff; }
table { border-collapse: collapse; width: 100%; font-size: .85rem; }
th, td { text-align: left; vertical-align: top; padding: .35rem .5rem;
         border-bottom: 1px solid #ccc; }
td.yes { color: #00603f; font-weight: 600; } td.no { color: #a33a00; font-weight: 600; }
td.maybe { color: #4b3d8f; font-weight: 600; }
@media (max-width: 52rem) {
  thead { display: none; }
  table, tbody, tr, td { display: block; width: auto; }
  tr { border: 1px solid #ccc; border-radius: .4rem; margin: 0 0 .8rem; padding: .3rem .6rem; }
  td { border: 0; padding: .15rem 0; }
  td::before { content: attr(data-head) ": "; font-weight: 600; color: #555; }
}
@media (prefers-color-scheme: dark) {
  body { color: #e6e6e6; background: #161616; } a { color: #8ab8ff; }
  td.yes { color: #5fd3a4; } td.no { color: #ff9e66; } td.maybe { color: #b9a9ff; }
  td::before { color: #aaa; } th, td, tr { border-color: #444; }
}
"""
_CLASSES = {"reproduced": "yes", "yes": "yes", "not reproduced": "no", "no": "no"}


def compose(contents: Contents) -> str:
    """Write the page.

    Parameters
    ----------
    contents : Contents
        From `collect`.

    Returns
    -------
    str
        HTML without references to other files.
    """
    versions = _table(_versions()) + "<br>" + _table(contents.engines)
    sections = (
        _section("figures", "Figures", _figures(contents.figures)),
        _section(
            "claims",
            "The paper's claims, judged",
            _text(CLAIMS_NOTE) + _table(contents.verdicts) + "<br>" + _table(contents.claims),
        ),
        _section(
            "benefit",
            "Does the wall help?",
            _text(BENEFIT_NOTE) + _table(contents.benefit),
        ),
        _section(
            "validation",
            "Validation against engines",
            _text(VALIDATION_NOTE)
            + "<br>".join(
                map(_table, (contents.tolerances, contents.differences, contents.restitution))
            )
            + _text(CONTACT_NOTE)
            + _table(contents.contact),
        ),
        _section("versions", "What made this page", versions),
    )
    links = "".join(
        f'<a href="#{key}">{key}</a>'
        for key in ("figures", "claims", "benefit", "validation", "versions")
    )
    return (
        '<!DOCTYPE html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
        '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
        f"<title>Rocking wall-moment frames, reproduced</title>\n<style>{_STYLE}</style>\n</head>\n"
        "<body>\n<h1>Dynamic response of post-tensioned rocking wall-moment frames: the figures "
        f"again, the claims judged</h1>\n<nav>{links}</nav>\n{''.join(sections)}</body>\n</html>\n"
    )


def _section(key: str, title: str, body: str) -> str:
    return f'<section id="{key}">\n<h2>{html.escape(title)}</h2>\n{body}\n</section>\n'


def _text(text: str) -> str:
    return f"<p>{html.escape(text)}</p>\n"


def _figures(figures: dict[str, Path]) -> str:
    parts = []
    for name, path in figures.items():
        data = base64.b64encode(path.read_bytes()).decode("ascii")
        caption = html.escape(GALLERY[name].caption)
        parts.append(
            f'<figure id="figure-{name}"><img src="data:image/png;base64,{data}" alt="{caption}">'
            f"<figcaption>{caption}.</figcaption></figure>\n"
        )
    return "".join(parts)


def _table(table: Table) -> str:
    heads = "".join(f"<th>{html.escape(head)}</th>" for head in table.heads)
    rows = "".join(f"<tr>{_cells(table.heads, row)}</tr>\n" for row in table.rows)
    return f"<table><thead><tr>{heads}</tr></thead>\n<tbody>{rows}</tbody></table>\n"


def _cells(heads: Sequence[str], row: Sequence[str]) -> str:
    cells = []
    for head, text in zip(heads, row, strict=True):
        kind = "maybe" if text.startswith("depends on") else _CLASSES.get(text, "")
        mark = f' class="{kind}"' if kind else ""
        cells.append(f'<td{mark} data-head="{html.escape(head)}">{html.escape(text)}</td>')
    return "".join(cells)


def _versions() -> Table:
    import matplotlib
    import numpy as np
    import xarray as xr

    rows = [
        ("rwmf", rwmf.__version__),
        ("Python", platform.python_version()),
        ("numpy", np.__version__),
        ("xarray", xr.__version__),
        ("matplotlib", matplotlib.__version__),
        ("machine", f"{platform.system()} {platform.machine()}"),
    ]
    return Table(("what", "version"), rows)
